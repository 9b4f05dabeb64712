"""What is left of an integer that was computed with floats, when it is made an integer again."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from rosetta_jit.language.affine_steps import LostError
from rosetta_jit.language.conversions import bounds
from rosetta_jit.model.types import Int

if TYPE_CHECKING:
    from rosetta_jit.language.affine_steps import Value

WHOLE = {
    "round": "it is rounded to a whole number",
    "truncate": "what is behind the point is dropped",
    "saturate": "it is rounded to a whole number that fits",
}
"""What becomes of a float that is made an integer."""


FRACTION = 1e-6
"""A factor farther from a whole number than that was meant to be none."""


def as_whole(value: Value, rule: str) -> Value:
    """A float as an integer."""
    if not isinstance(value.source, Int):
        if rule == "exact":
            return value
        raise LostError(WHOLE[rule])
    if not value.errors:
        return value
    if rule == "truncate":
        raise LostError(WHOLE[rule])
    largest = float(1 << value.source.bits)
    off = sum(error.unit * (largest + error.floor) for error in value.errors) * value.size
    near = near_whole(value)
    if not value.turns and abs(value.slope - round(value.slope)) > FRACTION and rule == "round":
        raise LostError(WHOLE[rule])
    if near is None or off + near[1] >= 0.25 or largest > value.limit:
        raise LostError("large integers are rounded to a float")
    if rule == "exact":
        raise LostError("it is refused where rounding leaves a fraction")
    return near[0]


def near_whole(value: Value) -> tuple[Value, float] | None:
    """A value with whole numbers in place of a slope and an offset that are nearly so, and how far off that is; None for radians."""
    if value.turns or any(turns for turns, _ in value.offsets) or not isinstance(value.source, Int):
        return None
    slope, offset = value.slope, sum((offset for _, offset in value.offsets), Fraction(0))
    off = abs(slope - round(slope)) * (1 << value.source.bits) + abs(offset - round(offset))
    offsets = ((0, Fraction(round(offset))),) if round(offset) else ()
    return replace(value, slope=Fraction(round(slope)), offsets=offsets, errors=()), float(off)


def squeezed(before: Value, after: Value, rule: str) -> Value:
    """An integer made to fit: nothing is lost where it fits anyway."""
    if isinstance(before.source, Int) and isinstance(after.type, Int) and before.slope == 1 and not before.offsets:
        low, high = bounds(before.source)
        least, most = bounds(after.type)
        if least <= low and high <= most:
            return after
    raise LostError("values that do not fit are saturated" if rule == "saturate" else "values that do not fit are wrapped")
