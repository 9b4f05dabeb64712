"""A value that a chain of steps computes from a field: a slope and an offset, and what was rounded on the way.

A step that gives s·x + o and rounds it by at most u·|s·x + o| is off by u·(|x| + |o/s|) in terms of x, if the rest of the chain undoes it.
Of an integer, floats may hold what a step gives: then nothing is rounded.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING
from typing import Literal as OneOf

from rosetta_jit.language.typed import Expr
from rosetta_jit.model.types import Bool, Enum, Float, Int, Type
from rosetta_jit.startup.dataclass import dataclass, field, replace

if TYPE_CHECKING:
    from fractions import Fraction


PRECISION = {32: 24, 64: 53}
LARGEST = {32: 2.0**128 * (1 - 2.0**-24), 64: math.ldexp(1 - 2.0**-53, 1024)}
SMALLEST = {32: 2.0**-126, 64: 2.0**-1022}
"""IEEE 754: bits of precision, the largest finite number, the smallest normal one."""

FAR = 2.0**20
"""How far from what underflows a value is to be, for that not to count."""


UNSHOWN = "it cannot be shown that its value comes back"


class LostError(Exception):
    """A step that loses something; says what."""


@dataclass(frozen=True, slots=True)
class Error:
    """A rounding: at most ``unit`` · (|x| + ``floor``), where a floor that ``is_tiny`` is that of what underflows, times `FAR`."""

    unit: float
    floor: float
    is_tiny: bool

    def times(self) -> float:
        """How often the unit counts for values of at least the floor."""
        return self.unit * (1 + 1 / FAR if self.is_tiny else 2)


@dataclass(frozen=True, slots=True)
class Value:
    """slope · x + Σ offsets[k] · (pi/180)^k, and what was rounded on the way."""

    type: Type
    source: Type
    slope: Fraction | int = 1
    turns: int = 0
    offsets: tuple[tuple[int, Fraction | int], ...] = ()
    errors: tuple[Error, ...] = ()
    bits: OneOf[32, 64] = 64
    limit: float = math.inf
    opened: tuple[tuple[Expr, Value], ...] = field(default=(), repr=False)

    @property
    def size(self) -> float:
        return abs(float(self.slope)) * (math.pi / 180) ** self.turns

    @property
    def offset(self) -> float:
        return abs(sum(float(value) * (math.pi / 180) ** turns for turns, value in self.offsets))

    @property
    def is_itself(self) -> bool:
        return self.slope == 1 and not self.turns and not self.offsets and not self.errors


def fraction(number: object) -> Fraction:
    """A constant, exactly."""
    from fractions import Fraction  # takes a while to import, and only laws need it

    if isinstance(number, bool) or not isinstance(number, int | float) or not math.isfinite(number):
        raise LostError(UNSHOWN)
    return Fraction(number)


def scaled(value: Value, factor: Fraction | int) -> Value:
    """A value times a constant."""
    if not factor:
        raise LostError("it is multiplied by 0")
    return replace(value, slope=value.slope * factor, offsets=tuple((turns, offset * factor) for turns, offset in value.offsets))


def turned(value: Value, turns: int) -> Value:
    """A value times a power of pi/180."""
    return replace(value, turns=value.turns + turns, offsets=tuple((each + turns, offset) for each, offset in value.offsets))


def shifted(value: Value, by: Fraction | int) -> Value:
    """A value plus a constant."""
    offsets = dict(value.offsets)
    offsets[0] = offsets.get(0, 0) + by
    return replace(value, offsets=tuple((turns, offset) for turns, offset in sorted(offsets.items()) if offset))


def rounded(value: Value, times: int) -> Value:
    """After an operation of floats, which rounds so many times; integers are exact, or refused."""
    if not isinstance(value.type, Float) or is_exact(value, value.type.bits):
        return value
    bits = value.type.bits
    floor = (value.offset or SMALLEST[bits] * FAR) / value.size
    error = Error(times * 2.0 ** -PRECISION[bits], floor, is_tiny=not value.offsets)
    limit = min(value.limit, (LARGEST[bits] / 2 - value.offset) / value.size)
    return replace(value, errors=(*value.errors, error), bits=32 if bits == 32 else value.bits, limit=limit)


def is_exact(value: Value, bits: int) -> bool:
    """Whether floats of so many bits hold what is computed of an integer: a multiple of a power of 2 that is no further from 0."""
    numbers = (value.slope, *(offset for _, offset in value.offsets))
    if value.errors or value.turns or any(turns for turns, _ in value.offsets) or not isinstance(value.source, Int):
        return False
    unit = max(number.denominator for number in numbers)
    return not unit & (unit - 1) and unit * largest(value) <= 1 << PRECISION[bits]


def largest(value: Value) -> Fraction | int:
    """How far what is computed of an integer may be from 0."""
    assert isinstance(value.source, Int)
    return abs(value.slope) * (1 << value.source.bits - value.source.signed) + sum(abs(offset) for _, offset in value.offsets)


def is_whole(value: Value) -> bool:
    """Whether integers stay integers."""
    numbers = (value.slope, *(offset for _, offset in value.offsets))
    return isinstance(value.source, Int | Bool | Enum) and not value.turns and all(number.denominator == 1 for number in numbers)


def divided_by(value: Value, divisor: object, function: str, type_: Type) -> Value:
    """A value divided by a constant; the quotient of integers has no fraction."""
    quotient = scaled(value, 1 / fraction(divisor))
    if isinstance(type_, Int) and not is_whole(quotient):
        raise LostError(f"`{function}` drops remainders")
    return rounded(quotient, 1)
