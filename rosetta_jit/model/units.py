"""Units as IDLs write them, onto fields: one for all values, or one for each element, separated by commas."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rosetta_jit.model.types import Field

MAX_PARTS = 1000
"""Parts of one field that have units of their own."""


def with_unit(field: Field, text: str | None) -> Field:
    """The field with its units: ``"rad/s"``, or ``"rad, rad, m"`` for the elements of an array."""
    units = [unit.strip() for unit in (text or "").split(",")][:MAX_PARTS]
    if len(units) == 1:
        return replace(field, unit=units[0] or None)
    return replace(field, part_units=tuple(((number,), unit) for number, unit in enumerate(units) if unit))
