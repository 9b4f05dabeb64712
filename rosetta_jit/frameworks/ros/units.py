"""Units of ROS 2: what stands in brackets in a field's comment, ``# start of the scan [rad]``, if nothing else does.

That is how rosidl_adapter (``parser.py``, ``process_comments``) finds the ``@unit`` of the `.idl` file that it makes. ROS 1 has no such
rule.
"""

from __future__ import annotations

import re

from rosetta_jit.frameworks.ros.limits import MAX_UNIT

IN_BRACKETS = re.compile(r"\[([^,\]]+)\]")
"""A comma makes it a range."""


def unit_in(comment: str) -> str | None:
    """The unit that a field's comment gives, or None."""
    found = IN_BRACKETS.findall(comment)
    unit = found[0].strip() if len(found) == 1 else ""
    return unit if 0 < len(unit) <= MAX_UNIT and unit.isprintable() else None
