"""Whole arrays made of others: differences and running sums, runs of equal elements, bits of bytes."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from functools import partial, reduce
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import layouts as words
from rosetta_jit.functions.forms import constants_of, if_same_constants, undone_by
from rosetta_jit.kernel.nodes import Binary, Bits, Compare, Const, Convert, Expr, For, If, Local, Scalar, Select
from rosetta_jit.kernel.terms import add, index, mul, type_of
from rosetta_jit.language import typed
from rosetta_jit.language.function import SEVERAL, Function, Row
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import BOOL, INT64
from rosetta_jit.lowering.arithmetic import binary, inside
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.made_arrays import UINT8, ArrayArgument, MadeArray, Put, array_argument
from rosetta_jit.lowering.writer import Writer, block
from rosetta_jit.model import expr as model
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Type
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    Fill = Callable[[ArrayArgument, Expr, Evaluation, Put], None]
    Takes = tuple[str, Callable[[Type | None], bool]]
    """What an argument must be, and whether an array of such elements is that."""

NUMBERS, BYTES, FLAGS = "an array of integers", "bytes", "an array of bools"
SCALARS = "an array of numbers, bools or enums"
FLOATS: dict[str, Scalar] = {"f32": "u32", "f64": "u64"}
"""Floats, and what their bits are as."""


# --- types ---------------------------------------------------------------------------------------------------------------


def _element(value: typed.Expr, scope: Scope) -> Type | None:
    """The type of an element of an array that is read as a whole; None of what is none."""
    if not isinstance(value, typed.Access):
        return None
    message = scope.messages[value.place.side]
    found = message.value_type(value.type)
    if isinstance(found, Bytes):
        return UINT8
    return message.value_type(found.element) if isinstance(found, Array) else None


def _is_integer(type_: Type | None) -> bool:
    return isinstance(type_, Int) and (type_.signed or type_.bits < INT64.bits)


def _is_octet(type_: Type | None) -> bool:
    return type_ == UINT8


def _is_flag(type_: Type | None) -> bool:
    return isinstance(type_, Bool)


def _is_scalar(type_: Type | None) -> bool:
    return isinstance(type_, Bool | Enum | Float | Int)


def _typed(takes: tuple[Takes, ...], gives: Type | None, call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    """The typed call of a function of so many arrays; without ``gives`` its elements are of the type that the first one has."""
    order = arguments[1:] if takes[0][0] in (BYTES, FLAGS) else []
    is_order = len(order) <= 1 and all(isinstance(each, typed.Const) and isinstance(each.value, bool) for each in order)
    elements = [_element(each, scope) for each in arguments[: len(takes)]]
    is_good = all(each(element) for (_, each), element in zip(takes, elements, strict=False))
    if len(arguments) - len(order) != len(takes) or not is_order or not is_good:
        scope.problems.append(words.whole_arrays(call.span, call.function, [what for what, _ in takes]))
        return None
    element = gives or elements[0]
    return None if element is None else typed.Call(call.function, tuple(arguments), Array(element), call.span)


# --- kernels: sums and differences ---------------------------------------------------------------------------------------


def _lower_deltas(call: typed.Call, values: Evaluation) -> MadeArray:
    array = array_argument(call.arguments[0], values)
    return MadeArray(array.count, partial(_fill_deltas, array, values))


def _fill_deltas(array: ArrayArgument, values: Evaluation, put: Put) -> None:
    writer = values.writer
    last = writer.var("last", _zero(array))
    with array.each() as number:
        value = writer.let("value", array.at(number))
        put(number, binary(writer, "-", _integer(value), _integer(last), values.where, values.line))
        writer.assign(last, value)


def _lower_sums(call: typed.Call, values: Evaluation) -> MadeArray:
    array = array_argument(call.arguments[0], values)
    return MadeArray(array.count, partial(_fill_sums, array, values))


def _fill_sums(array: ArrayArgument, values: Evaluation, put: Put) -> None:
    writer = values.writer
    total = writer.var("total", index(0))  # and not the element that is put, which would be narrowed and widened in each round
    with array.each() as number:
        sum_ = writer.let("sum", binary(writer, "+", total, _integer(array.at(number)), values.where, values.line))
        put(number, sum_)
        writer.assign(total, sum_)


def _integer(value: Expr) -> Expr:
    return value if type_of(value) == "i64" else Convert("i64", value)


# --- kernels: runs -------------------------------------------------------------------------------------------------------


def _lower_repeated(call: typed.Call, values: Evaluation) -> MadeArray:
    array, counts = (array_argument(each, values) for each in call.arguments)
    writer, runs = values.writer, array.count
    values.reject(words.OTHER_COUNT, when=Compare("ne", runs, counts.count))
    total = writer.var("total", index(0))
    with counts.each() as number:
        size = writer.let("size", _integer(counts.at(number)))
        writer.expect(Compare("ge", size, index(0)), "count", values.where, "a run must not be negative", line=values.line)
        writer.assign(total, binary(writer, "+", total, size, values.where, values.line))
    return MadeArray(writer.let("total", total), partial(_fill_repeated, array, counts, writer.let("total", total), values))


def _fill_repeated(array: ArrayArgument, counts: ArrayArgument, total: Expr, values: Evaluation, put: Put) -> None:
    writer = values.writer
    at = writer.var("at", index(0))
    with counts.each() as number:
        size, value = writer.let("size", _integer(counts.at(number))), writer.let("value", array.at(number))
        rest = Binary("sub", total, at)
        fits = Binary("and", Compare("ge", size, index(0)), Compare("le", size, rest))
        writer.expect(fits, "count", values.where, "the runs are others than before", line=values.line)
        each = Local("i64", writer.fresh("each"))
        with writer.nested() as body:
            put(Binary("add", at, each), value)
        writer.emit(For(each.name, size, block(body)))
        writer.assign(at, Binary("add", at, size))
    writer.expect(Compare("eq", at, total), "count", values.where, "the runs are others than before", line=values.line)


@contextmanager
def _each_run(array: ArrayArgument, values: Evaluation) -> Generator[tuple[Local, Expr, Expr]]:
    """Around what is done with each element: its number, its value, and whether a run begins with it. Floats are the same to the bit."""
    writer = values.writer
    last = writer.var("last", _zero(array))
    with array.each() as number:
        value = writer.let("value", array.at(number))
        word = FLOATS.get(type_of(value))
        differs = Compare("ne", value, last) if word is None else Compare("ne", Bits(word, value), Bits(word, last))
        yield number, value, writer.let("begins", Binary("or", Compare("eq", number, index(0)), differs))
        writer.assign(last, value)


def _zero(array: ArrayArgument) -> Const:
    assert isinstance(array.element, Bool | Enum | Float | Int)
    scalar = scalar_name(scalar_of(array.element))
    return Const(scalar, value=False if scalar == "bool" else 0.0 if scalar in FLOATS else 0)


def _lower_runs(fill: Fill, call: typed.Call, values: Evaluation) -> MadeArray:
    """Runs of elements that are the same."""
    array = array_argument(call.arguments[0], values)
    runs = values.together(replace(call, function="run_values", type=INT64), partial(_counted, array, values))["runs"]
    return MadeArray(runs, partial(fill, array, runs, values))


def _counted(array: ArrayArgument, values: Evaluation) -> dict[str, Expr]:
    """How many runs there are."""
    writer = values.writer
    found = writer.var("runs", index(0))
    with _each_run(array, values) as (_, _, begins):
        writer.assign(found, Binary("add", found, Convert("i64", begins)))
    return {"runs": writer.let("runs", found)}


def _fill_values(array: ArrayArgument, runs: Expr, values: Evaluation, put: Put) -> None:
    """The element of each run, which each of its elements sets."""
    writer = values.writer
    row = writer.var("run", index(-1))
    with _each_run(array, values) as (_, value, begins):
        writer.assign(row, Binary("add", row, Convert("i64", begins)))
        _put_inside(row, runs, value, (writer, put))
    _all_were_put(row, runs, values)


def _fill_lengths(array: ArrayArgument, runs: Expr, values: Evaluation, put: Put) -> None:
    """How many each run has: what its elements set counts up to that."""
    writer = values.writer
    row, first = writer.var("run", index(-1)), writer.var("first", index(0))
    with _each_run(array, values) as (number, _, begins):
        writer.assign(row, Binary("add", row, Convert("i64", begins)))
        writer.assign(first, Select(begins, number, first))
        size = add(Binary("sub", number, first), index(1))
        _put_inside(row, runs, size, (writer, put))
    _all_were_put(row, runs, values)


def _put_inside(row: Local, runs: Expr, value: Expr, out: tuple[Writer, Put]) -> None:
    """An element, if there is room for it."""
    writer, put = out
    with writer.nested() as then:
        put(row, value)
    writer.emit(If(inside(row, runs), block(then)))


def _all_were_put(row: Expr, runs: Expr, values: Evaluation) -> None:
    is_last = Compare("eq", row, add(runs, index(-1)))
    values.writer.expect(is_last, "count", values.where, "the runs are others than before", line=values.line)


# --- kernels: bits -------------------------------------------------------------------------------------------------------


def _lower_bits(call: typed.Call, values: Evaluation) -> MadeArray:
    array = array_argument(call.arguments[0], values)
    count = values.writer.checked("mul", array.count, index(8), values.where, line=values.line)
    return MadeArray(count, partial(_fill_bits, array, _places(call), values))


def _places(call: typed.Call) -> list[int]:
    """The place of each bit within its byte, from the lowest; in the order in which they come."""
    is_big = constants_of(call) == [True]
    return [*range(8)][:: -1 if is_big else 1]


def _fill_bits(array: ArrayArgument, places: list[int], values: Evaluation, put: Put) -> None:
    writer = values.writer
    with array.each() as number:
        byte = writer.let("byte", array.at(number))
        for each, place in enumerate(places):
            bit = Binary("and", byte, Const("u8", 1 << place))
            put(add(mul(number, index(8)), index(each)), Compare("ne", bit, Const("u8", 0)))


def _lower_bytes(call: typed.Call, values: Evaluation) -> MadeArray:
    array, writer = array_argument(call.arguments[0], values), values.writer
    is_even = Compare("eq", Binary("and", array.count, index(7)), index(0))
    writer.expect(is_even, "range", values.where, "these bits are no whole bytes", line=values.line)
    count = writer.let("bytes", Binary("div", array.count, index(8)))
    return MadeArray(count, partial(_fill_bytes, array, count, _places(call)))


def _fill_bytes(array: ArrayArgument, count: Expr, places: list[int], put: Put) -> None:
    with array.each(count) as number:
        bits = [array.at(add(mul(number, index(8)), index(each))) for each in range(8)]
        parts = [Binary("shl", Convert("u8", bit), Const("u8", place)) for bit, place in zip(bits, places, strict=True)]
        put(number, reduce(partial(Binary, "or"), parts))


# --- the other direction -------------------------------------------------------------------------------------------------


def _undone(other: str) -> Callable[[model.Call, model.Expr], tuple[model.Expr, model.Expr]]:
    """The array of a call is what another function makes of its value, with the same order of bits."""

    def solved(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr]:
        array, *order = call.arguments
        return array, model.Call(other, (value, *order), call.span)

    return solved


def _split_runs(call: model.Call, value: model.Expr) -> tuple[tuple[model.Expr, model.Expr], tuple[model.Expr, model.Expr]]:
    array, counts = call.arguments
    return (array, model.Call("run_values", (value,), call.span)), (counts, model.Call("run_lengths", (value,), call.span))


# --- records -------------------------------------------------------------------------------------------------------------


def row(forms: str, gives: str, kind: str = "") -> tuple[Row]:
    """A row of the table of arrays: what a call gives, and the kind of error where it cannot."""
    return (Row("arrays", forms, (gives, kind)),)


def _runs_again(call: typed.Call) -> typed.Expr | None:
    """The array of which there are all runs."""
    match call.arguments:
        case typed.Call("run_values", (array,)), typed.Call("run_lengths", (other,)) if array == other:
            return array
        case _:
            return None


INTEGERS, OCTETS, BITS, ANY = (NUMBERS, _is_integer), (BYTES, _is_octet), (FLAGS, _is_flag), (SCALARS, _is_scalar)
AS_ONE = "runs of the same value come back as one, and empty ones not at all"
of_arrays = partial(Function, operation="array reorder")
FUNCTIONS = (
    of_arrays(
        "deltas",
        partial(_typed, (INTEGERS,), INT64),
        _lower_deltas,
        _undone("running_sums"),
        undone_by(running_sums=if_same_constants),
        row("`deltas(a)`", "the first integer, and how much larger each is than the one before", "`range`"),
    ),
    of_arrays(
        "running_sums",
        partial(_typed, (INTEGERS,), INT64),
        _lower_sums,
        _undone("deltas"),
        undone_by(deltas=if_same_constants),
        row("`running_sums(a)`", "for each integer, the sum up to it", "`range`"),
    ),
    of_arrays(
        "repeated",
        partial(_typed, (ANY, INTEGERS), None),
        _lower_repeated,
        SEVERAL,
        replace(undone_by(), of_several=AS_ONE),
        row("`repeated(a, counts)`", "each element so many times, end to end; the arrays are of one length", "`count`"),
        undoes=_runs_again,
        split=_split_runs,
    ),
    of_arrays(
        "run_values",
        partial(_typed, (ANY,), None),
        partial(_lower_runs, _fill_values),
        SEVERAL,
        undone_by(),
        row("`run_values(a)`, `run_lengths(a)`", "of the runs of equal elements, each as long as can be: the element; how many there are"),
    ),
    of_arrays(
        "run_lengths",
        partial(_typed, (ANY,), INT64),
        partial(_lower_runs, _fill_lengths),
        SEVERAL,
        undone_by(),
        row("`run_values(a)`, `run_lengths(a)`", "of the runs of equal elements, each as long as can be: the element; how many there are"),
    ),
    of_arrays(
        "bits",
        partial(_typed, (OCTETS,), BOOL),
        _lower_bits,
        _undone("bit_bytes"),
        undone_by(bit_bytes=if_same_constants),
        row("`bits(b)`, `bits(b, true)`", "the bits of bytes as bools: of each byte the lowest first, or the highest"),
    ),
    of_arrays(
        "bit_bytes",
        partial(_typed, (BITS,), UINT8),
        _lower_bytes,
        _undone("bits"),
        undone_by(bits=if_same_constants),
        row("`bit_bytes(a)`, `bit_bytes(a, true)`", "bools as the bits of bytes, eight in each", "`range`"),
    ),
)
