"""The limits of what is explained of a mapping. docs/security.md prints them."""

from __future__ import annotations

MAX_FIELDS = 200
"""fields of a type that are shown"""

MAX_FIELD_DEPTH = 8
"""structs within each other whose fields are shown"""

MAX_RULES = 2_000
"""rules that are shown"""

MAX_LINKS = 1_000
"""lines that a page draws between the fields of both sides"""

MAX_TEXT = 400
"""characters of one text of a mapping or schema"""

MAX_LOOPS = 20
"""loops of a kernel whose rounds are told"""

MAX_COUNT_DEPTH = 12
"""definitions that are followed to say how often a loop runs"""

MAX_COUNT_TEXT = 120
"""characters of such a count"""
