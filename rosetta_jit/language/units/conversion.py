"""Units of values: what a value is measured in, and its conversion to what its place is measured in.

Where a value and its place have units, the conversion between them is inserted, also into each element of a whole array
(`language.units.wholes`). Functions of angles take and give theirs, what is added or compared must agree, and a value that was
multiplied or divided is taken to have been converted by hand.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import resolve
from rosetta_jit.catalogue import units as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.conversions import FLOAT64, describe
from rosetta_jit.language.function import Function
from rosetta_jit.language.installed import functions
from rosetta_jit.language.places import field_names
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import Access, Binary, Call, Choice, Convert, Expr, IndexStep, Nearest, Place, Reduce, Unary
from rosetta_jit.language.units.dimensions import conversion
from rosetta_jit.language.units.unit_at import Mixed, Unit, pairs_in_step, unit_at
from rosetta_jit.model.types import Enum, Float, Int, Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language.units import numbers
else:
    numbers = Late("rosetta_jit.language.units.numbers")


def in_unit(value: Expr, place: Place, scope: Scope, *, packs: bool = False) -> Expr | None:
    """The value in the unit of its place; None, and reported, where that cannot be.

    ``packs`` is whether a rule for both directions, turned round, sets the place.
    """
    if not isinstance(place.type, Int | Float | Enum) or not isinstance(value.type, Int | Float | Enum):
        return value
    known, wanted = unit_of(value), unit_at(place)
    if _is_plain(value) and (known is None) != (wanted is None):
        scope.problems.append(words.one_sided(value.span, shown(known or wanted), is_source=wanted is None))
    if known is None or wanted is None or (known == wanted and isinstance(known, str)) or _in_step(value, place):
        return value
    if isinstance(known, Mixed) or isinstance(wanted, Mixed):
        scope.problems.append(words.mixed(value.span, shown(known), shown(wanted)))
        return None
    factors = factors_between(known, wanted, value.span, scope.problems)
    if factors is None or factors == (1.0, 0.0):
        return None if factors is None else value
    if factors[1] and _is_computed(value):
        scope.problems.append(words.offset(value.span, known, wanted))
        return None
    if packs and _is_shifted(value):
        shifted = _with_fields_converted(value, factors)
        scope.problems.extend([words.shifted(value.span, known, wanted)] if shifted is None else [])
        return shifted
    converted = _converted(value, place.type, (known, wanted), factors, packs=packs)
    if converted is None:
        scope.problems.append(_not_converted(value, place.type, known, wanted))
    return converted


def _converted(value: Expr, target: Type, units: tuple[str, str], factors: numbers.Factors, *, packs: bool) -> Expr | None:
    """A number in another unit; None where that takes a word."""
    if not isinstance(target, Int):
        return numbers.scaled(value, target, factors)
    if isinstance(value.type, Int):
        return numbers.scaled_before_rounding(value, factors) or numbers.exactly(value, target, factors, packs=packs)
    back = conversion(units[1], units[0])
    if packs and isinstance(value, Access) and isinstance(back, tuple):
        return numbers.nearest(value, target, factors, back)
    return numbers.scaled(value, FLOAT64, factors)  # which needs a word, as every float does


def _is_shifted(value: Expr) -> bool:
    """Whether something without a unit was added to a value with one: a constant is in the unit of the field that the relation reads."""
    match value:
        case Binary("+" | "-" | "%", left, right):
            return (unit_of(left) is None) != (unit_of(right) is None) or _is_shifted(left) or _is_shifted(right)
        case Unary(_, operand) | Convert(operand) | Nearest(operand):
            return _is_shifted(operand)
        case _:
            return False


def _with_fields_converted(value: Expr, factors: numbers.Factors) -> Expr | None:
    """A sum with its fields in another unit before anything is added to them; None where it is no sum of floats."""
    match value:
        case Access():
            return numbers.scaled(value, value.type, factors)
        case Unary("-", operand) | Convert(operand, _, "widen"):
            inner = _with_fields_converted(operand, factors)
            return None if inner is None else replace(value, operand=inner)
        case Binary("+" | "-" | "%", left, right):
            one, other = _with_fields_converted(left, factors), _with_fields_converted(right, factors)
            return None if one is None or other is None else replace(value, left=one, right=other)
        case _:
            return value if unit_of(value) is None else None


def _not_converted(value: Expr, target: Type, known: str, wanted: str) -> Diagnostic:
    """Why a number is not converted."""
    if isinstance(target, Float):
        return words.wide_integer(value.span, describe(value.type), _element_of(value))
    return words.fraction_of_unit(value.span, known, wanted, describe(target), _element_of(value))


def _element_of(value: Expr) -> str:
    """How an element is written of an array that a rule names as a whole; empty of all other values."""
    if not (isinstance(value, Access) and isinstance(value.place.steps[-1], IndexStep)):
        return ""
    written = resolve.written_at(value.span)
    name = written if written.startswith(".") else "." + ".".join(field_names(value.place))
    return "" if name.endswith("]") else f"{name}[]"


def factors_between(known: str, wanted: str, span: Span | None, problems: list[Diagnostic]) -> numbers.Factors | None:
    """How a value gets from one unit into another; None, and reported, where it cannot. A unit that nobody knows is left alone."""
    factors = conversion(known, wanted)
    if isinstance(factors, str):
        problems.append(words.unknown_unit(span, factors))
        return 1.0, 0.0
    if factors is None:
        problems.append(words.incompatible(span, known, wanted))
    return factors


def unit_of(value: Expr) -> Unit:
    """What a value is measured in, if that is known."""
    match value:
        case Access(place):
            return unit_at(place)
        case Unary(_, operand) | Convert(operand) | Nearest(operand):
            return unit_of(operand)
        case Binary("+" | "-" | "%", left, right):
            return unit_of(left) or unit_of(right)
        case Call(function, arguments):
            units = functions()[function].units
            return next((unit for argument in arguments if (unit := unit_of(argument))), None) if units.keeps else units.gives
        case Reduce(function, value=value):
            return unit_of(value) if functions()[function].units.keeps else None
        case Choice(cases, otherwise):
            return next((unit for case in (*(value for _, value in cases), otherwise) if case and (unit := unit_of(case))), None)
        case _:
            return None


def check_arguments(function: Function, arguments: Sequence[Expr], span: Span | None, scope: Scope) -> bool:
    """Whether arguments are measured in what a function takes."""
    units = function.units
    if units.joins:
        return check_agree(f"`{function.name}`", arguments, span, scope)
    known = unit_of(arguments[0]) if units.takes is not None else None
    if units.takes is None or not isinstance(known, str) or conversion(known, units.takes) == (1.0, 0.0):
        return True
    scope.problems.append(words.wrong_way(span, function.name, known, units.takes))
    return False


def check_agree(what: str, values: Sequence[Expr], span: Span | None, scope: Scope) -> bool:
    """Whether values that are added, compared or chosen from are in one unit, as far as that is known."""
    units = [unit for value in values if (unit := unit_of(value)) is not None]
    for one, other in pairwise(units):
        if one == other and isinstance(one, str):
            continue
        factors = conversion(other, one) if isinstance(one, str) and isinstance(other, str) else None
        if factors != (1.0, 0.0):
            scope.problems.append(words.disagree(span, what, shown(one), shown(other), factors if isinstance(factors, tuple) else None))
            return False
    return True


def shown(unit: Unit) -> str:
    """A unit as a report names it."""
    return " or ".join(each or "nothing" for each in unit.units[:4]) if isinstance(unit, Mixed) else unit or "nothing"


def _in_step(value: Expr, place: Place) -> bool:
    """Whether a value and its place change their units together, element by element, so that nothing is to be converted."""
    if not (isinstance(value, Access) and isinstance(unit_at(place), Mixed)):
        return False
    return all(one == other or (one and other and conversion(one, other) == (1.0, 0.0)) for one, other in pairs_in_step(value.place, place))


def _is_computed(value: Expr) -> bool:
    """Whether values with units were added or subtracted: a sum has another offset, and a difference none."""
    match value:
        case Binary(_, left, right):
            return unit_of(left) is not None and unit_of(right) is not None
        case Reduce("sum", value=each):
            return unit_of(each) is not None
        case Unary(_, operand) | Convert(operand):
            return _is_computed(operand)
        case _:
            return False


def _is_plain(value: Expr) -> bool:
    """Whether a value is a field as it came, with nothing done to it that could be a conversion by hand."""
    match value:
        case Access():
            return True
        case Convert(operand) | Unary(_, operand):
            return _is_plain(operand)
        case _:
            return False
