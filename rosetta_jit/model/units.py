"""Units of fields, as IDLs write them: one for all values, or one for each of the first elements; and which of them counts where.

A field's unit is that of all numbers within it, unless something within says another. Of two that are said of one value, by the field
itself and by one around it, the outer one counts: it knows more.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import TypeGuard

from rosetta_jit.model.limits import MAX_UNIT_PARTS
from rosetta_jit.model.types import Array, Field, PartUnit
from rosetta_jit.startup.dataclass import dataclass, replace


def with_unit(field: Field, text: str | None) -> Field:
    """The field with its unit, or with several: ``"rad/s"``, ``"rad, rad, m"``."""
    return with_units(field, [unit.strip() for unit in text.split(",")]) if text else field


def with_units(field: Field, units: Sequence[str]) -> Field:
    """The field with one unit, or with those of its elements; empty ones are not known."""
    length = field.type.fixed if isinstance(field.type, Array) else None
    if len(units) == 1 or (len(units) == length and len(set(units)) == 1):
        return replace(field, unit=units[0] or None)
    return replace(field, part_units=tuple(((number,), unit) for number, unit in enumerate(units[:MAX_UNIT_PARTS]) if unit))


@dataclass(frozen=True, slots=True)
class Context:
    """What is known at a place: the unit of the numbers there, and those of parts of it."""

    unit: str | None = None
    parts: tuple[PartUnit, ...] = ()

    def member(self, field: Field) -> Context:
        """What is known at a member of a struct or union."""
        below = self._below(field.name)
        unit = next((unit for path, unit in below if not path), field.unit or self.unit)
        return Context(unit, (*(part for part in below if part[0]), *field.part_units))

    def element(self, index: int | None) -> Context:
        """What is known at an element; None for all that nothing is said of by number."""
        return self._element((() if index is None else self._below(index)) + self._below(None))

    @property
    def elements(self) -> dict[int | None, Context]:
        """The same for all elements, by number; those that nothing is said of last."""
        below: defaultdict[int | None, list[PartUnit]] = defaultdict(list)
        for path, unit in self.parts:
            for step in path[:1]:
                if not isinstance(step, str):
                    below[step].append((path[1:], unit))
        each = below.pop(None, [])
        numbered: dict[int | None, Context] = {
            number: self._element((*below[number], *each)) for number in sorted(filter(_is_number, below))
        }
        return numbered | {None: self._element(tuple(each))}

    def _element(self, below: tuple[PartUnit, ...]) -> Context:
        return Context(next((unit for path, unit in below if not path), self.unit), tuple(part for part in below if part[0]))

    def _below(self, step: str | int | None) -> tuple[PartUnit, ...]:
        return tuple((path[1:], unit) for path, unit in self.parts if path[:1] == (step,))


def _is_number(step: int | None) -> TypeGuard[int]:
    return step is not None
