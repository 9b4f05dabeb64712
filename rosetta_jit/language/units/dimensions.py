"""What units measure, and the numbers between them: pint, asked only while a mapping is compiled.

It takes half a second to load, so units that are equal, and the usual ones where only their existence matters, are not asked for.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from functools import cache
from typing import TYPE_CHECKING, Any, cast

from rosetta_jit.language.limits import MAX_UNIT

if TYPE_CHECKING:
    from fractions import Fraction

WORD = r"[A-Za-z_°µΩ]+((\^|\*\*)?-?[0-9]{1,2})?"
SCALE = r"([0-9]{1,9}(?:\.[0-9]{1,9})?(?:[eE][+-]?[0-9]{1,2})?) ?\*? ?(?=[A-Za-z_°µΩ])"
"""How many of a unit one is: `1e-7 degree`."""

UNIT = rf"(1 ?/ ?)?{WORD}( ?[*/·] ?{WORD}| {WORD})*"
"""What is given to the library that knows units: words with small powers, multiplied and divided."""

USUAL = frozenset(
    [
        "m",
        "mm",
        "cm",
        "km",
        "s",
        "ms",
        "us",
        "ns",
        "rad",
        "degree",
        "g",
        "kg",
        "N",
        "Pa",
        "K",
        "degC",
        "V",
        "A",
        "W",
        "J",
        "Hz",
        "T",
        "lux",
        "m^2",
        "m/s",
        "m/s^2",
        "rad/s",
        "rad/s^2",
        "N*m",
        "N*cm",
    ]
)
"""Units that pint is known to know."""

FAR = 2.0**80
"""Where a second value of a conversion with an offset is taken: so far off that the offset is below the last digit."""


def is_unit(unit: str) -> bool:
    """Whether a unit is known."""
    return unit in USUAL or conversion(unit, unit, same=False) == (1.0, 0.0)


@cache
def conversion(source: str, target: str, *, same: bool = True) -> tuple[float, float] | str | None:
    """Factor and offset from one unit to another; None where there are none; the name of a unit that is not known.

    There are none where the two measure different things, and between logarithms and what they are of. An angle is no number here:
    pint would make 1 rad/s of 1 Hz. Where ``same``, a unit that is not known is still itself.
    """
    if same and source == target:
        return 1.0, 0.0
    (many, one), (parts, other) = _scale(source), _scale(target)
    unknown = next((unit for unit in (source, target) if len(unit) > MAX_UNIT), None)
    unknown = unknown or next((unit for unit in (one, other) if not re.fullmatch(UNIT, unit)), None)
    if unknown is not None or not many or not parts:
        return unknown
    found = _conversion(one, other)
    if not isinstance(found, tuple) or many == parts == 1:
        return found
    from fractions import Fraction

    return float(many * Fraction(found[0]) / parts), float(Fraction(found[1]) / parts)


def _scale(unit: str) -> tuple[Fraction | int, str]:
    """How many of a unit are meant, and which one."""
    found = re.match(SCALE, unit)
    if found is None:
        return 1, unit
    from fractions import Fraction  # few mappings need it

    return Fraction(found[1]), unit[found.end() :]


def _conversion(source: str, target: str) -> tuple[float, float] | str | None:
    from pint import PintError, UndefinedUnitError

    registry, read = _registry(), source

    def converted(value: float) -> float:
        return float(registry.Quantity(value, source).to(target).magnitude)

    try:
        angles = _angles(registry, source)
        read = target
        if angles != _angles(registry, target):
            return None
        zero, one, two = (converted(value) for value in (0.0, 1.0, 2.0))
        if not math.isclose(two - zero, 2 * (one - zero), rel_tol=1e-9):
            return None
        return (one, 0.0) if zero == 0 else (converted(FAR) / FAR, zero)
    except UndefinedUnitError:
        return read
    except (PintError, ArithmeticError):  # pint raises the second for powers that no float holds
        return None


def _angles(registry: Any, unit: str) -> float:
    """The power of an angle in a unit."""
    return dict(registry.Quantity(1, unit).to_root_units().unit_items()).get("radian", 0)


def known_units() -> Iterable[str]:
    """Names of units, for those that are misspelt."""
    return sorted({*USUAL, *(str(name) for name in dir(_registry()) if str(name).isalpha())})


@cache
def _registry() -> Any:
    import pint

    return cast("Any", pint).UnitRegistry()  # its types are known in part only
