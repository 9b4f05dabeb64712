"""The names of the functions that give an array in another order or form. `layouts` has what each of them does."""

from __future__ import annotations

PADDED = "padded_rows"
NUMBERS, NUMBER_BYTES = "numbers", "number_bytes"
ARGUMENTS: dict[str, tuple[int, int]] = {
    "reversed": (1, 2),
    "permuted": (2, 2),
    "transposed": (3, 4),
    "planar": (2, 3),
    "interleaved": (2, 3),
    "rows": (4, 4),
    PADDED: (4, 4),
    NUMBERS: (2, 3),
    NUMBER_BYTES: (2, 3),
    "upper_triangle": (2, 2),
    "symmetric": (2, 2),
}
"""The functions of arrays, and how many arguments each takes, the array included."""

KEEP_LENGTH = frozenset(("reversed", "permuted", "transposed", "planar", "interleaved"))
"""Functions that give an array as long as theirs."""
