"""The limits of programs and of the messages that they read. docs/security.md prints them."""

from __future__ import annotations

# --- Programs -----------------------------------------------------------------------------------------------------------

MAX_STATEMENTS = 24_000
"""statements of one program: some thirteen a field of a bottle, twenty an array of CDR; `FileDescriptorSet` comes to 12,000"""

# --- Messages -----------------------------------------------------------------------------------------------------------

MAX_SIZE = 1 << 56
"""bytes of a message that is written: no memory holds more, and sums of sizes below this cannot wrap"""

MAX_RECURSION = 64
"""messages within each other of recursive structs: more is an error of kind `nesting`"""

MAX_LIST_NESTING = 256
"""lists within lists of a bottle that is copied whole: more is an error of kind `nesting`"""

MAX_GROUPS = 64
"""groups within groups among unknown fields of protobuf: more is an error of kind `nesting`"""

MAX_ABSENT = 1 << 16
"""elements of arrays of fixed length in a member of XCDR that did not come: more is an error of kind `missing`"""

MAX_ABSENT_EACH = 1 << 6
"""the same where the member is in an element of an array, of which a message has many"""

MAX_COLOUR_SIDE = 65_500
"""pixels of a row or a column that are made RGB: more is an error of kind `image`"""

MAX_EXPONENT = 10**12
"""the exponent of a number in a text: a larger one means the same, infinity or 0"""

MAX_VALUE_SHOWN = 100
"""bytes of a value in the text of a rejection"""
