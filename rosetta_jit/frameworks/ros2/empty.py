"""The field of a message that has none. It stands apart from the front end, which a process that only holds messages never needs."""

from __future__ import annotations

DUMMY = "structure_needs_at_least_one_member"
"""Its name, as rosidl gives it to an IDL struct, which cannot be empty."""
