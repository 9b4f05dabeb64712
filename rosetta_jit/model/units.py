"""Units as IDLs write them, onto fields: one for all values, or one for each of the first elements."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.model.types import Array

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rosetta_jit.model.types import Field

MAX_PARTS = 500
"""Parts of one field that have units of their own; of more, nothing is known."""


def with_unit(field: Field, text: str | None) -> Field:
    """The field with its unit, or with several: ``"rad/s"``, ``"rad, rad, m"``."""
    return with_units(field, [unit.strip() for unit in text.split(",")]) if text else field


def with_units(field: Field, units: Sequence[str]) -> Field:
    """The field with one unit, or with those of its elements; empty ones are not known."""
    length = field.type.fixed if isinstance(field.type, Array) else None
    if len(units) == 1 or (len(units) == length and len(set(units)) == 1):
        return replace(field, unit=units[0] or None)
    return replace(field, part_units=tuple(((number,), unit) for number, unit in enumerate(units[:MAX_PARTS]) if unit))
