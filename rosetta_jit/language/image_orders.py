"""Names of bytes of images in another order, in typed calls: `language.arrays.orders` makes them, `functions.reorders` lowers them."""

COUNT = "(bytes)"
"""The name of how many bytes there are."""

ORDERED = "permuted.bytes"
"""The typed call, which no mapping can write."""

COLOURS = ("rgb_of", "yuv_of")
"""The functions that make colours of others; they take and give bytes in any order, as those of compressed images do."""
