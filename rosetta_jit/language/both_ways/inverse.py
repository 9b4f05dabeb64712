"""Turn an expression round: what a field must be for the expression to have a value.

| expression        | its field                         |
|-------------------|-----------------------------------|
| `.a`              | the value                         |
| `-x`, `not x`     | -value, not value                 |
| `float32(x)` …    | the value, as the field holds it  |
| `table(x) {a = b}`| table(value) {b = a}              |

What undoes an operator or a function stands in its record (`language.operators`, `language.function`), beside what comes back when it is
undone. Arrays are in `language.arrays.put_back`, and expressions of several fields in `language.both_ways.inverse_parts`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from rosetta_jit.language.arrays.array_functions import ARGUMENTS
from rosetta_jit.language.arrays.put_back import put_back, rounded_bytes
from rosetta_jit.language.folding import folded, is_constant
from rosetta_jit.language.function import SEVERAL, Affine, ByType, Function
from rosetta_jit.language.groups import GroupFunction, arguments_of, component, function_of
from rosetta_jit.language.installed import written
from rosetta_jit.language.operators import form_of, rounds, why_lost
from rosetta_jit.model.expr import NEAREST, Binary, Call, Choice, Expr, Given, Item, Len, List, Literal, Name, Nearest, Path, Unary
from rosetta_jit.model.types import Enum, Float, Int, String, Type
from rosetta_jit.model.walk import Field, parts, rebuilt, side_of
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    TypeOf = Callable[[Expr], Type | None]
    """The type of an expression, that of each element where it has a `[]`; None where it has none, which is reported elsewhere."""

MEASURED = ("compress", "decompress")
"""Functions that ask the sizes of an image, as orders of arrays ask theirs."""

CONVERSIONS = ("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64", "float32", "float64", "bool")


@dataclass(frozen=True, slots=True)
class Solution:
    """``place = value``"""

    place: Path | Len
    value: Expr


class NoInverseError(Exception):
    """An expression that cannot be turned round; says which part and why."""

    def __init__(self, part: Expr, why: str) -> None:
        super().__init__(why)
        self.part, self.why = part, why


def solve(expr: Expr, value: Expr, type_of: TypeOf) -> Solution:
    """The field of an expression that has exactly one, so that the expression is ``value``; raises NoInverseError."""
    while not isinstance(expr, Path | Len):
        expr, value = step(expr, value, type_of)
    return Solution(expr, value)


def solved(expr: Expr, value: Expr, type_of: TypeOf) -> Solution:
    """The same; an integer field that was computed with floats is the nearest one, if the expression gives the value of it again.

    Raises
    ------
    NoInverseError
    """
    found = solve(expr, value, type_of)
    if any(function_of(part) is not None for part in parts(expr)):
        return nearest(found, type_of)
    if isinstance(found.place, Len) or not may_round(expr):
        return found
    type_ = type_of(found.place)
    if not isinstance(type_, Int):
        return Solution(found.place, rounded_bytes(found.value))
    if not isinstance(type_of(found.value), Float):
        return found
    return Solution(found.place, Nearest(found.value, named(expr, found.place), value, type_, expr.span))


def nearest(solution: Solution, type_of: TypeOf) -> Solution:
    """A field that a function of several values gives: an integer is the nearest one."""
    type_ = type_of(solution.place)
    if not isinstance(type_, Int):
        return solution
    value, span = solution.value, solution.value.span
    return Solution(solution.place, Call(f"{'' if type_.signed else 'u'}int{type_.bits}", (value, Name("round", span)), span))


def may_round(expr: Expr) -> bool:
    """Whether an expression of an integer may be computed in floats, so that what turns it round is off by their rounding."""
    if any(function_of(part) is not None for part in parts(expr)):
        return False  # nothing that several values are computed from is the nearest integer for each of them
    found = [part for part in parts(expr) if _is_rounding(part)]
    of_integers = all(isinstance(part, Binary) and part.operator != "/" and _has_whole(part) for part in found)
    is_float = any(isinstance(part, Call) and part.function in ("float32", "float64") for part in parts(expr))
    return bool(found) and (is_float or not of_integers)


def _is_rounding(part: Expr) -> bool:
    """Whether an operation rounds, if it is one of floats."""
    match part:
        case Binary(operator):
            return rounds(operator)
        case Call(function):
            found = written(function)
            return found is not None and isinstance(found.law, Affine) and found.law.rounds
        case _:
            return False


def _has_whole(part: Binary) -> bool:
    """Whether an operand is an integer, or a text, that is written down: then the other one is, too."""
    return any(isinstance(each, Literal) and isinstance(each.value, int | str) for each in (folded(part.left), folded(part.right)))


def named(expr: Expr, field: Expr) -> Expr:
    """An expression with the name of the integer that is sought in place of the field."""
    return Name(NEAREST, expr.span) if expr == field else rebuilt(expr, lambda part: named(part, field))


def fields_in(expr: Expr) -> list[Field]:
    """The fields of the wire that an expression reads; those within an index are not among them."""
    return list(dict.fromkeys(_fields(expr)))


def _fields(expr: Expr) -> Iterator[Field]:
    if isinstance(expr, Path | Len):
        if side_of(expr) == "wire":
            yield expr
        return
    if isinstance(expr, Call) and (expr.function in ARGUMENTS or expr.function in MEASURED):
        yield from _fields(expr.arguments[0]) if expr.arguments else ()  # the others are no fields to solve for
        return
    below: list[Expr] = []
    rebuilt(expr, lambda part: below.append(part) or part)
    for part in below:
        yield from _fields(part)


def step(expr: Expr, value: Expr, type_of: TypeOf) -> tuple[Expr, Expr]:
    """One operation taken from the expression, and its opposite done to the value; raises NoInverseError."""
    match expr:
        case Unary(operator, operand, span):
            return operand, Unary(operator, value, span)
        case Binary():
            return _operation(expr, value)
        case Call(function, (argument, *_), span) if function in CONVERSIONS or is_qualified(function):
            is_by_number = isinstance(type_of(argument), Enum) and isinstance(type_of(value), Enum)  # one enum as another
            return argument, Call(function, (value,), span) if is_by_number and not is_qualified(function) else value
        case Call(function, (array, *_)) if function in ARGUMENTS:
            return array, put_back(expr, value)
        case Call(function) if (known := written(function)) is not None:
            return _undone(expr, value, known, type_of)
        case Call() if (several := function_of(expr)) is not None:
            (found,) = undone_group(expr, value, several, alone=True)
            return found
        case List():
            return only_item(expr, value)
        case Item(items=Call(function), index=Literal(str(name))):
            raise NoInverseError(expr, f"`{name}` does not say what else `{function}` gives")
        case Call("has"):
            raise NoInverseError(expr, f"`has` {SEVERAL}")
        case Call(_, (argument,)) if isinstance(type_of(expr), Enum):
            return argument, value
        case Call(function):
            raise NoInverseError(expr, f"nothing says what the opposite of `{function}` is")
        case Choice():
            return _table(expr, value)
        case _:
            raise NoInverseError(expr, "it has no field")


def is_qualified(function: str) -> bool:
    """Whether a call is named as a type with a package is: a conversion to an enum."""
    return "." in function or "::" in function


def _undone(call: Call, value: Expr, function: Function, type_of: TypeOf) -> tuple[Expr, Expr]:
    """The argument of a call that has the field, and what that must be."""
    match function.inverse:
        case str() as why:
            raise NoInverseError(call, f"`{call.function}` {why}")
        case ByType(undo):
            found = undo(call, value, type_of(call.arguments[0]))
        case undo:
            found = undo(call, value)
    if found is None or any(fields_in(each) for each in call.arguments if each is not found[0]):
        raise NoInverseError(call, f"`{call.function}` {_UNMEASURED[found is None] if call.function in MEASURED else SEVERAL}")
    return found


_UNMEASURED = (
    "asks for measures that no relation says",
    'does not say how to pack it, as `decompress(b, "png", width, height, channels)` does',
)


def undone_group(call: Call, value: Expr, function: GroupFunction, *, alone: bool) -> list[tuple[Expr, Expr]]:
    """The arguments of a function of several values that have fields, and what each must be; one where it is to stand ``alone``.

    Raises
    ------
    NoInverseError
    """
    arguments = arguments_of(call, function)
    if arguments is None:
        raise NoInverseError(call, f"`{call.function}` takes {len(function.parameters)} values")
    unknown = [number for number, argument in enumerate(arguments) if fields_in(argument)]
    if len(unknown) > 1 and (alone or not function.separates):
        raise NoInverseError(call, f"fields stand in several arguments of `{call.function}`")
    found: list[tuple[Expr, Expr]] = []
    for number in unknown:
        inverse = function.inverses[number]
        if isinstance(inverse, str):
            raise NoInverseError(call, f"`{call.function}` {inverse}")
        found.append((arguments[number], inverse(arguments, value)))
    return found


def only_item(items: List, value: Expr) -> tuple[Expr, Expr]:
    """The item of a list with the field, and the number of a group that it must be."""
    found = [(item, number) for number, item in enumerate(items.items) if fields_in(item)]
    if len(found) != 1:
        raise NoInverseError(items, "its fields are several")
    ((item, number),) = found
    return item, component(value, number)


def _operation(expr: Binary, value: Expr) -> tuple[Expr, Expr]:
    if (found := _without(expr, value)) is not None:
        return found
    left = bool(fields_in(expr.left))
    inner, other = (expr.left, expr.right) if left else (expr.right, expr.left)
    if fields_in(other):
        raise NoInverseError(expr, "the field stands in it twice")
    form = form_of(expr.operator, is_left=left)
    if form is None:
        raise NoInverseError(expr, why_lost(expr.operator))
    return inner, form.undo(value, other, expr.span)


def _without(sum_: Binary, value: Expr) -> tuple[Expr, Expr] | None:
    """The field of a sum of texts of which one is written down."""
    match sum_:
        case Binary("+", Literal(str()) | Given(type=String()) as start, inner, span):
            return inner, Call("behind", (value, start), span)
        case Binary("+", inner, Literal(str()) | Given(type=String()) as end, span):
            return inner, Call("before", (value, end), span)
        case _:
            return None


def _table(expr: Choice, value: Expr) -> tuple[Expr, Expr]:
    """A table with its columns exchanged. Of several keys with one value the first is written; what has no key is refused."""
    subject = subject_of(expr)
    if subject is None:
        raise NoInverseError(expr, "only a table of constants can be turned round")
    cases = tuple((Binary("==", value, chosen, condition.span), folded(_key(condition))) for condition, chosen in expr.cases)
    return subject, Choice(cases, None, "the table has no key for it", expr.span)


def subject_of(expr: Choice) -> Expr | None:
    """What a table of constants looks up; None for other choices."""
    values = [value for _, value in expr.cases] + ([] if expr.otherwise is None else [expr.otherwise])
    subjects = {condition.left for condition, _ in expr.cases if isinstance(condition, Binary) and condition.operator == "=="}
    constant = all(map(is_constant, values)) and all(is_constant(_key(condition)) for condition, _ in expr.cases)
    return subjects.pop() if len(subjects) == 1 and constant and not is_conditional(expr) else None


def _key(condition: Expr) -> Expr:
    """The key of an entry of a table."""
    return condition.right if isinstance(condition, Binary) else condition


def is_conditional(expr: Choice) -> bool:
    """Whether a choice was written as `a if condition else b`: that one is never refused, and has no reason for it."""
    return expr.otherwise is not None and not expr.reason


def condition_in(expr: Expr) -> tuple[Expr, Expr, Expr] | None:
    """The condition of a conditional on the way to the field of an expression, and the expression where it holds and where not."""
    if isinstance(expr, Choice):
        if not is_conditional(expr) or expr.otherwise is None:
            return None
        (condition, then), *others = expr.cases
        return condition, then, replace(expr, cases=tuple(others)) if others else expr.otherwise
    below: list[Expr] = []
    rebuilt(expr, lambda part: below.append(part) or part)
    for part in below:
        found = condition_in(part)
        if found is not None:
            condition, then, other = found
            return condition, _with(expr, part, then), _with(expr, part, other)
    return None


def _with(expr: Expr, part: Expr, other: Expr) -> Expr:
    return rebuilt(expr, lambda each: other if each is part else each)
