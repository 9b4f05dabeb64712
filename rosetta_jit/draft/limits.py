"""The limits of drafts of mappings. docs/security.md prints them."""

from __future__ import annotations

MAX_LEAVES = 2_000
"""fields of a type that are compared with those of the other"""

MAX_DEPTH = 8
"""structs within each other that are looked into"""

MAX_FIELDS = 64
"""fields that become the elements of one array"""

MAX_ROUNDS = 8
"""drafts that are checked, each without the rules that were wrong in the one before"""
