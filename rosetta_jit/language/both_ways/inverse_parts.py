"""Turn round expressions of several fields that are parts of one value, and several expressions of which each is a part of one field.

| expression                     | its fields                                                               |
|--------------------------------|--------------------------------------------------------------------------|
| `x * c + y`, 0 ≤ y < c         | floor_divide(value, c) and modulo(value, c), for any number of such terms |
| `nanoseconds(x, y)`            | floor_divide(value, 10⁹) and modulo(value, 10⁹)                          |
| `iso8601(x, y)`, `timestamp(x, y)` | seconds(value) and fraction(value)                                   |

| expressions                         | their field                          |
|-------------------------------------|--------------------------------------|
| `floor_divide(x, c)`, `modulo(x, c)` | first · c + second, 0 ≤ second < c  |
| `seconds(x)`, `fraction(x)`         | `iso8601` or `timestamp` of the two  |

The terms of a sum are digits: what stands behind one must be less than its factor, which unpacking then checks.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import derive as words
from rosetta_jit.language.both_ways.inverse import CONVERSIONS, NoInverseError, Solution, fields_in, nearest, solve, undone_group
from rosetta_jit.language.folding import folded
from rosetta_jit.language.function import Function
from rosetta_jit.language.functions.texts import separates
from rosetta_jit.language.groups import component, function_of
from rosetta_jit.language.installed import functions, written
from rosetta_jit.model.expr import Binary, Call, Choice, Expr, Len, List, Literal, Path
from rosetta_jit.model.types import Float, Int
from rosetta_jit.model.walk import parts, rebuilt
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf


@dataclass(frozen=True, slots=True)
class Digit:
    """That a value is from 0 to below a number, as `x * below + digit` needs it."""

    value: Expr
    below: int


@dataclass(frozen=True, slots=True)
class Parted:
    """What each field must be, and what must hold of the fields for that to be the only solution."""

    settings: tuple[Solution, ...]
    digits: tuple[Digit, ...]


@dataclass(frozen=True, slots=True)
class _Term:
    """A part of a sum: fields times a factor above 0."""

    value: Expr
    factor: int


def part(expr: Expr, value: Expr, type_of: TypeOf) -> Parted:
    """The fields of an expression, so that it is ``value``; raises NoInverseError."""
    found = _part(expr, value, type_of)
    if any(function_of(each) is not None for each in parts(expr)):
        found = Parted(tuple(nearest(each, type_of) for each in found.settings), found.digits)
    if len({setting.place for setting in found.settings}) < len(found.settings):
        raise NoInverseError(expr, "a field stands in it twice")
    return found


def _part(expr: Expr, value: Expr, type_of: TypeOf) -> Parted:
    if len(fields_in(expr)) == 1:
        return Parted((solve(expr, value, type_of),), ())
    match expr:
        case Call(function, (_, _)) if (known := written(function)) is not None and known.split is not None:
            (first, its), (second, rest) = known.split(expr, value)
            return _both(_part(first, its, type_of), _part(second, rest, type_of))
        case Call() if (several := function_of(expr)) is not None:
            return _all(_part(argument, its, type_of) for argument, its in undone_group(expr, value, several, alone=False))
        case List(items):
            return _all(_part(item, component(value, number), type_of) for number, item in enumerate(items) if fields_in(item))
        case Call(function, (argument, *_)) if function in CONVERSIONS:
            whole = value if function != "uint64" else Call("int64", (value,), expr.span)  # parts are computed in int64
            return _part(argument, whole, type_of)
        case Binary("+") if (spelt := _spelt(expr, type_of)) is not None:
            return _numbers_of(spelt, value, type_of)
        case Binary("+" | "-"):
            return _digits(expr, value, type_of)
        case _:
            raise NoInverseError(expr, "it does not say which part of the value each of its fields is")


def _both(first: Parted, second: Parted) -> Parted:
    return _all((first, second))


def _all(found: Iterable[Parted]) -> Parted:
    several = list(found)
    return Parted(tuple(each for one in several for each in one.settings), tuple(each for one in several for each in one.digits))


@dataclass(frozen=True, slots=True)
class _Spelt:
    """Numbers as text, with a separator between each two."""

    numbers: tuple[Expr, ...]
    separator: Literal


def _spelt(expr: Expr, type_of: TypeOf) -> _Spelt | None:
    """A text that is put together of numbers; None where it is another sum."""
    pieces = list(_terms(expr))
    numbers, separators = tuple(pieces[::2]), pieces[1::2]
    first = separators[0]
    if not (isinstance(first, Literal) and isinstance(first.value, str) and separates(first.value) and len(pieces) % 2):
        return None
    is_spelt = all(isinstance(each, Call) and each.function == "text" and len(each.arguments) == 1 for each in numbers)
    types = [type_of(each.arguments[0]) for each in numbers if isinstance(each, Call)] if is_spelt else []
    known = bool(types) and all(isinstance(each, Int | Float) for each in types)
    return _Spelt(numbers, first) if known and all(each == first for each in separators) else None


def _terms(expr: Expr) -> Iterator[Expr]:
    """The terms of a sum, from the left."""
    if isinstance(expr, Binary) and expr.operator == "+":
        yield from _terms(expr.left)
        yield from _terms(expr.right)
    else:
        yield expr


def _numbers_of(spelt: _Spelt, value: Expr, type_of: TypeOf) -> Parted:
    """Each number as its part of a text; the first one is refused if the text has other parts."""
    span = spelt.separator.span
    found = [
        _part(each, Call("part", (value, spelt.separator, Literal(number, span)), span), type_of)
        for number, each in enumerate(spelt.numbers)
    ]
    first, *rest = _all(found).settings
    count = Binary("==", Call("parts", (value, spelt.separator), span), Literal(len(found), span), span)
    checked = replace(first, value=Choice(((count, first.value),), None, words.OTHER_PARTS, span))
    return Parted((checked, *rest), ())


def _digits(expr: Binary, value: Expr, type_of: TypeOf) -> Parted:
    """The terms of a sum as digits, that of the largest factor first."""
    terms: list[_Term] = []
    for each in _summands(expr):
        known = folded(each)
        if isinstance(known, Literal) and type(known.value) is int:
            value = Binary("-", value, known, expr.span)
        else:
            terms.append(_term(each))
    if terms[0].value is expr:
        raise NoInverseError(expr, "one field is subtracted from the other, and nothing says what each of them is")
    terms.sort(key=lambda term: -term.factor)
    settings: list[Solution] = []
    digits: list[Digit] = []
    for number, (term, smaller) in enumerate(pairwise(terms)):
        if term.factor == smaller.factor:
            raise NoInverseError(expr, "its fields are added, and nothing says which part of the sum each one is")
        found = _part(term.value, _quotient(value, term.factor, expr.span), type_of)
        settings += found.settings
        digits += [Digit(_sum(terms[number + 1 :], expr.span), term.factor), *found.digits]
        value = _rest(value, term.factor, expr.span)
    last = terms[-1]
    digit = value if last.factor == 1 else Call("divide", (value, Literal(last.factor, expr.span)), expr.span)
    found = _part(last.value, digit, type_of)
    return Parted((*settings, *found.settings), (*found.digits, *reversed(digits)))


def _summands(expr: Expr) -> Iterator[Expr]:
    match expr:
        case Binary("+", left, right):
            yield from _summands(left)
            yield from _summands(right)
        case Binary("-", left, right) if isinstance(known := folded(right), Literal) and type(known.value) is int:
            yield from _summands(left)
            yield replace(known, value=-known.value)
        case _:
            yield expr


def _term(expr: Expr) -> _Term:
    if not fields_in(expr):
        raise NoInverseError(expr, "what is added must be known when the mapping is compiled")
    match expr:
        case Binary("*", left, right):
            for inner, factor in ((left, folded(right)), (right, folded(left))):
                if isinstance(factor, Literal) and type(factor.value) is int and factor.value > 0:
                    return _Term(inner, factor.value)
            raise NoInverseError(expr, "it is no field times a whole number above 0")
        case _:
            return _Term(expr, 1)


def _sum(terms: list[_Term], span: Span | None) -> Expr:
    total: Expr | None = None
    for term in terms:
        each = term.value if term.factor == 1 else Binary("*", term.value, Literal(term.factor, span), span)
        total = each if total is None else Binary("+", total, each, span)
    assert total is not None
    return total


def _quotient(value: Expr, by: int, span: Span | None) -> Expr:
    return Call("floor_divide", (value, Literal(by, span)), span)


def _rest(value: Expr, by: int, span: Span | None) -> Expr:
    return Call("modulo", (value, Literal(by, span)), span)


# --- one field, of which each expression is a part ------------------------------------------------------------------------


def taken_part(expr: Expr) -> Call | None:
    """The call in an expression that gives a part of its field, with another function for the rest."""
    return next((each for each in parts(expr) if isinstance(each, Call) and below(each) is not None), None)


def rest_of(call: Call) -> Call | None:
    """The call that leaves what this one gives; None where there is none."""
    found = _whole_of(call)
    return None if found is None or found.name == call.function else replace(plain(call), function=found.name)


def plain(call: Call) -> Call:
    """A call with constants computed, so that it is equal to others that give the same."""
    return replace(call, arguments=tuple(map(folded, call.arguments)))


def put_together(first: Expr, its: Expr, second: Expr, rest: Expr, type_of: TypeOf) -> tuple[Solution, Digit | None]:
    """The field whose one part is in ``first`` and whose other is in ``second``, so that they have these values; raises NoInverseError."""
    call, other = taken_part(first), taken_part(second)
    assert call is not None
    assert other is not None
    high, low = until(first, its, call, type_of), until(second, rest, other, type_of)
    function, limit = _whole_of(call), below(call)
    assert function is not None
    assert function.whole is not None
    inner = call.arguments[0]
    whole = function.whole.joined(call, high, low, type_of(inner))
    return solve(inner, whole, type_of), Digit(low, limit) if limit else None


def until(expr: Expr, value: Expr, call: Call, type_of: TypeOf) -> Expr:
    """What a call within an expression must be, so that the expression is ``value``."""
    mark = Path("wire", ())
    return solve(_marked(expr, call, mark), value, lambda part: type_of(_marked(part, mark, call))).value


def _marked(expr: Expr, part: Expr, mark: Expr) -> Expr:
    """An expression with a mark in place of one of its parts."""
    if expr is part:
        return mark
    return expr if isinstance(expr, Path | Len) else rebuilt(expr, lambda each: _marked(each, part, mark))


def below(call: Call) -> int | None:
    """What the rest of a division is less than; 0 where that goes without saying, None where a call is no part of a value."""
    function = _whole_of(call)
    return None if function is None or function.whole is None else function.whole.below(call)


def _whole_of(call: Call) -> Function | None:
    """The record of two functions that together say a number, of which one is called."""
    known = written(call.function)
    if known is None or known.whole is not None:
        return known
    return next((each for each in functions().values() if each.whole is not None and each.whole.rest == known.name), None)
