"""Conversions of units that a rule writes out as a factor: one that goes the wrong way is found by its number.

`.angle = .yaw * 57.29578` is right where `.yaw` is in radians and the angle in degrees. The reciprocal of the right factor is a mistake,
for degrees and radians even where only the unit of the value is known.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from rosetta_jit.catalogue import units as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.typed import Access, Assign, Binary, Const, Convert, Expr, Place, Rule
from rosetta_jit.language.units.dimensions import conversion
from rosetta_jit.language.units.unit_at import unit_at
from rosetta_jit.model.walk import every_rule

TOLERANCE = 1e-3
"""How far a factor that somebody wrote, rounded, is from the right one."""

ANGLES = {"degree": "radian", "radian": "degree"}


def wrong_factors(rules: tuple[Rule, ...]) -> Iterator[Diagnostic]:
    """Reports of all factors that convert the wrong way."""
    for rule in every_rule(rules):
        if isinstance(rule, Assign):
            yield from _of_assignment(rule.place, rule.value)


def _of_assignment(place: Place, value: Expr) -> Iterator[Diagnostic]:
    origin, factor = _product(value)
    source = unit_at(origin) if origin is not None else None
    if not isinstance(source, str) or _is_one(factor):
        return
    target = unit_at(place) or ANGLES.get(source)
    right = conversion(source, target) if isinstance(target, str) else None
    if isinstance(right, tuple) and right[1] == 0 and right[0] > 0 and not _is_one(right[0]) and _is_one(factor * right[0]):
        yield words.wrong_factor(value.span, factor, source, str(target), right[0])


def _product(value: Expr) -> tuple[Place | None, float]:
    """A place and what its value is multiplied by; no place where the value is anything but that."""
    match value:
        case Access(place):
            return place, 1.0
        case Convert(operand):
            return _product(operand)
        case Binary("*", left, Const(int() | float() as number)) | Binary("*", Const(int() | float() as number), left):
            place, factor = _product(left)
            return place, factor * number
        case Binary("/", left, Const(int() | float() as number)) if number:
            place, factor = _product(left)
            return place, factor / number
        case _:
            return None, 1.0


def _is_one(number: float) -> bool:
    return math.isclose(abs(number), 1.0, rel_tol=TOLERANCE)
