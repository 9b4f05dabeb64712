"""Functions of arrays, turned round: the one that puts elements back where another has taken them from (`layouts` has a table of both)."""

from __future__ import annotations

from rosetta_jit.language.arrays.array_functions import ARGUMENTS, NUMBER_BYTES, NUMBERS, PADDED
from rosetta_jit.model.expr import Call, Expr, List, Literal, Name
from rosetta_jit.startup.dataclass import replace

OPPOSITE = {
    "planar": "interleaved",
    "interleaved": "planar",
    "rows": PADDED,
    PADDED: "rows",
    NUMBERS: NUMBER_BYTES,
    NUMBER_BYTES: NUMBERS,
    "upper_triangle": "symmetric",
    "symmetric": "upper_triangle",
}


def put_back(call: Call, value: Expr) -> Call:
    """The function that puts the elements back."""
    _, *arguments = call.arguments
    match call.function, arguments:
        case "transposed", [rows, columns, *size]:
            return Call(call.function, (value, columns, rows, *size), call.span)
        case "permuted", [order]:
            numbers = listed_numbers(order)
            found = (Literal(numbers.index(number), order.span) for number in range(len(numbers)) if number in numbers)
            return Call(call.function, (value, List(tuple(found), order.span)), call.span)
        case _:
            return Call(OPPOSITE.get(call.function, call.function), (value, *arguments), call.span)


def rounded_bytes(expr: Expr) -> Expr:
    """Bytes of integers that are computed in floats, each rounded to the nearest; any other expression as it is."""
    match expr:
        case Call(function, (value, Name(name), *_)) if function == NUMBER_BYTES and not name.startswith("float"):
            nearest = Call(name, (value, Name("round", value.span)), value.span)
            return replace(expr, arguments=(nearest, *expr.arguments[1:]))
        case Call(function, (array, *_)) if function in ARGUMENTS:
            return replace(expr, arguments=(rounded_bytes(array), *expr.arguments[1:]))
        case _:
            return expr


def listed_numbers(order: Expr) -> tuple[int, ...]:
    """The integers of a list that stands in the text; () if it holds anything else."""
    items = order.items if isinstance(order, List) else ()
    numbers = tuple(item.value for item in items if isinstance(item, Literal) and type(item.value) is int)
    return numbers if len(numbers) == len(items) else ()
