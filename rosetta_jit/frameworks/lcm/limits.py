"""The limits of LCM's language. docs/security.md prints them."""

from __future__ import annotations

MAX_FILES = 4096
"""files that one file leads to, and `.lcm` files that are searched for a fingerprint"""

MAX_DEPTH = 100
"""structs within structs"""

MAX_WAYS = 20_000
"""ways by which a struct is met in others: only structs that contain each other crosswise have more ways than there are structs"""

MAX_DIMENSIONS = 16
"""dimensions of an array: loops within loops take time to compile, and no type of people has half as many"""

MAX_DIGITS = 400
"""characters of a number"""

MAX_PROBLEMS = 100
"""reports of one text, after which the rest is not explained"""

MAX_SHOWN = 60
"""characters of a hostile word that a report repeats"""
