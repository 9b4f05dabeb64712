"""The limits of types. docs/security.md prints them."""

from __future__ import annotations

MAX_BYTES = 1 << 40
"""bytes of the arrays of a type whose lengths it fixes, and elements of an array that it bounds: no arithmetic overflows"""

MAX_NESTED = 32
"""structs within each other, recursion not counted"""

MAX_LINKS = 64
"""fields by which recursive structs refer to recursive structs: each is a lane"""

MAX_SLOTS = 20_000
"""fields that a type unfolds to: hostile types double at each level"""

MAX_ROW_BYTES = 1 << 20
"""bytes of one row: the fields of a message or element but for what they refer to"""

MAX_INITIAL_BYTES = 1 << 26
"""bytes of the arrays of fixed length of a new message: longer arrays begin empty"""

MAX_UNIT_PARTS = 500
"""parts of one field that have units of their own: of further parts no unit is known"""

MAX_LISTED = 12
"""values of an enum that a report lists"""

MAX_SERIAL_DEPTH = 100
"""types written inside each other in a file of the cache"""
