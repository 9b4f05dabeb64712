"""Kernel expressions as Python expressions: integers are ints, bools are bools, floats are floats, rounded where they have 32 bits.

header_seq              a field of the message's row            position_d[start + i]     one of another lane, through a view of its bytes
position_used           how many rows are in use                position_room             for how many there is room
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection
from itertools import groupby
from typing import TYPE_CHECKING, assert_never

import numpy as np

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.python.classes import NUMPY
from rosetta_jit.generate.python.conversions import bits_of, converted, wrapped
from rosetta_jit.generate.python.descents import Visit
from rosetta_jit.generate.python.direct import Direct
from rosetta_jit.generate.python.groups import zigzag_of
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.arithmetic import FLOATS
from rosetta_jit.kernel.terms import END, type_of
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.c.lanes import Lanes

CODES = {
    "bool": "B",
    "i8": "b",
    "u8": "B",
    "i16": "h",
    "u16": "H",
    "i32": "i",
    "u32": "I",
    "i64": "q",
    "u64": "Q",
    "f32": "f",
    "f64": "d",
}
"""Of the struct module, and of views."""
TRUTH = "T"
"""The struct module's "?" in names of its functions."""
OPERATORS = {"add": "+", "sub": "-", "mul": "*", "and": "&", "or": "|", "xor": "^", "shr": ">>"}
LOGICAL = {"and": "and", "or": "or", "xor": "!="}
COMPARISONS = {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">="}
ROUNDINGS = {"floor": "math.floor", "ceil": "math.ceil", "trunc": "math.trunc", "rint": "round"}


@dataclass(slots=True)
class Scope:
    """What the printers of a function share.

    ``flat``: the fields of the message's row are locals, ``rows``, some of known ``offsets``, of which ``floats`` are floats, ``bools``
    bools. ``views`` are the lanes that it reaches, with the code of the view, empty for the bytes themselves; ``paths`` are the fields
    that lanes belong to; ``counted`` and ``rooms`` are lanes, ``loads`` functions that it needs, ``from_call`` what each call brings:
    its time and number, registers, object. ``small`` are the locals of 64 bits, without a sign, that are known to be below 2**63,
    ``sums`` those that are sums.
    ``attributes`` are the fields of the message's row that are the object's at once, by offset, if it is made first.
    """

    locals: Namespace
    lanes: Lanes
    flat: bool
    loads: set[str]
    name: str
    paths: tuple[str, ...]
    views: set[tuple[int, str]] = field(default_factory=set[tuple[int, str]])
    rows: set[str] = field(default_factory=set[str])
    offsets: dict[str, int] = field(default_factory=dict[str, int])
    floats: set[str] = field(default_factory=set[str])
    bools: set[str] = field(default_factory=set[str])
    counted: set[int] = field(default_factory=set[int])
    rooms: set[int] = field(default_factory=set[int])
    from_call: set[str] = field(default_factory=set[str])
    direct: Direct = field(default_factory=Direct)
    attributes: dict[int, str] | None = None
    numpy: bool = False
    small: set[str] = field(default_factory=set[str])
    sums: dict[nodes.Expr, str] = field(default_factory=dict[nodes.Expr, str])

    def note(self, name: str, *, is_small: bool) -> None:
        """Know of a local whether it is below 2**63."""
        (self.small.add if is_small else self.small.discard)(name)

    def view(self, lane: int, code: str) -> str:
        """The view of a lane's rows as numbers of one type."""
        self.views.add((lane, code))
        return view_name(self.lanes, lane, code)

    def used(self, lane: int) -> str:
        self.counted.add(lane)
        return "1" if lane == 0 else f"{self.lanes.rows(lane)}_used"

    def room(self, lane: int) -> str:
        self.rooms.add(lane)
        return "1" if lane == 0 else f"{self.lanes.rows(lane)}_room"

    def struct(self, order: str, code: str, verb: str) -> str:
        """A function of the struct module: ``load_I`` with the low byte first, ``load_I_be`` with the high one."""
        code = "".join(f"{count}{each}" if (count := len([*same])) > 1 else each for each, same in groupby(code))
        name = f"_{verb}_{code.replace('?', TRUTH)}{'' if order == '<' else '_be'}"
        self.loads.add(name)
        return name

    def dtype(self, scalar: str, order: str = "<") -> str:
        """Numpy's type of a scalar in the message."""
        code = NUMPY[scalar][1]
        name = f"_dtype_{code}{'_be' if order == '>' and code[1:] != '1' else ''}"
        self.loads.add(name)
        return name

    def place(self, place: nodes.Place, scalar: str) -> str:
        """The same for a place of a kernel."""
        if place.lane in self.direct.elements:
            return self.element(place.lane, self.direct.elements[place.lane].index(place))
        return self.field(place.lane, expression(self, place.row), place.offset, scalar)

    def truth_of(self, place: nodes.Place) -> str | None:  # noqa: ARG002 - of objects
        """What stands for a bool of an object."""
        return None

    def element(self, lane: int, number: int) -> str:
        """The local for an element of an array that has few."""
        return self.locals.identifier(f"{self.lanes.rows(lane)}\0{number}")

    def own(self, lane: int, offset: int, scalar: str) -> str:
        """The local for a field of the row that a loop fills."""
        path = self.lanes.field(lane, "", offset, scalar)
        return self.locals.identifier(f"{self.lanes.rows(lane)}\0{offset}" if path is None else re.sub(r"\W+", "_", path).strip("_"))

    def text(self, lane: int, offset: int) -> str:
        """The local for a text that is decoded where it is checked, or the attribute."""
        if lane == 0 and self.attributes and offset in self.attributes:
            return self.attributes[offset]
        start = flat_name(self.lanes, offset, "i64") if lane == 0 else self.own(lane, offset, "i64")
        return self.locals.identifier(f"{start.removesuffix('_start')}\0text")

    def visited(self, visit: Visit) -> str:
        """The list of the messages, of a type that contains itself, that fill a span."""
        return self.locals.identifier(f"{self.lanes.rows(visit.lane)}\0list")

    def reader(self, lane: int) -> str:
        """The function that reads such a message of a lane."""
        return f"_read_{self.lanes.rows(lane)}"

    def piece(self, lane: int, offset: int) -> str:
        """The local for bytes that are taken where a statement says where they are, or the attribute."""
        if lane == 0 and self.attributes and offset in self.attributes:
            return self.attributes[offset]
        return self.locals.identifier(f"{self.text(lane, offset).removesuffix('_text')}\0bytes")

    def has_field(self, name: str) -> str:
        """The local that says whether the message has a late field."""
        return self.locals.identifier(f"has\0{name}")

    def field(self, lane: int, row: str, offset: int, scalar: str) -> str:
        """A scalar of a row."""
        if lane == 0 and self.attributes and offset in self.attributes:
            return self.attributes[offset]
        if lane == 0 and self.flat:
            name = flat_name(self.lanes, offset, scalar)
            self.rows.add(name)
            self.offsets[name] = offset
            if scalar in FLOATS or scalar == "bool":
                (self.bools if scalar == "bool" else self.floats).add(name)
            return name
        if lane in self.direct.appended or lane in self.direct.whole:
            return self.own(lane, offset, scalar)
        width, stride = nodes.WIDTH[scalar], self.lanes.stride(lane)
        return f"{self.view(lane, CODES[scalar])}[{_scaled(row, stride // width, offset // width)}]"


def view_name(lanes: Lanes, lane: int, code: str) -> str:
    """What views of lanes are called."""
    name = lanes.rows(lane)
    return f"{name}_{code}" if code else name


def flat_name(lanes: Lanes, offset: int, scalar: str) -> str:
    """The local for a field of the message's row."""
    path = lanes.field(0, "0", offset, scalar)
    return f"m_{offset}" if path is None else "m_" + re.sub(r"\W+", "_", path.partition("->")[2]).strip("_")


def _scaled(row: str, times: int, offset: int) -> str:
    text = row if times == 1 else "0" if row == "0" else f"{row} * {times}"
    if text == "0":
        return str(offset)
    return f"{text} + {offset}" if offset else text


def expression(scope: Scope, expr: nodes.Expr) -> str:
    """The text of an expression; one with an operator stands in parentheses."""
    match expr:
        case nodes.Const(type_, value):
            return _constant(type_, value)
        case nodes.Local(_, name):
            return "end" if name == END.name else scope.locals.identifier(name)
        case nodes.Load(type_, at, order):
            return _loaded(scope, type_, bare(expression(scope, at)), order)
        case nodes.Get(type_, place):
            text = scope.place(place, type_)
            return f"({text} != 0)" if type_ == "bool" and text not in scope.bools else text
        case nodes.Used() | nodes.Capacity() | nodes.HostValue() | nodes.Register():
            return _known(scope, expr)
        case nodes.Unary(function, operand):
            return _unary(function, type_of(operand), expression(scope, operand))
        case nodes.Binary(op, left, right):
            return _shorter(scope, expr) or _binary(op, type_of(left), expression(scope, left), expression(scope, right))
        case nodes.Compare(op, left, right):
            return f"({expression(scope, left)} {COMPARISONS[op]} {expression(scope, right)})"
        case nodes.Fits(op, left, right):
            return f"({-(2**63)} <= {expression(scope, left)} {OPERATORS[op]} {expression(scope, right)} <= {2**63 - 1})"
        case nodes.Convert():
            return _converted(scope, expr)
        case nodes.Bits(type_, operand):
            return bits_of(type_, type_of(operand), expression(scope, operand))
        case nodes.Select(condition, then, otherwise):
            return f"({expression(scope, then)} if {expression(scope, condition)} else {expression(scope, otherwise)})"
        case nodes.IsText(address, size):
            return _is_text(scope, address, expression(scope, size))
        case nodes.Nearest() | nodes.Digits() | nodes.Scale():
            return _decimal(scope, expr)
        case nodes.Lookup(_, values, index):
            return f"{values!r}[{bare(expression(scope, index))}]"
        case _:
            assert_never(expr)


def _shorter(scope: Scope, expr: nodes.Binary) -> str:
    """Whether a local is between two numbers, and a difference; nothing for other expressions."""
    match expr:
        case nodes.Binary("add", left, nodes.Const(type_, value)) if value < 0 and type_ not in FLOATS:
            return f"({expression(scope, left)} - {-int(value)})"
        case nodes.Binary("and", nodes.Compare("ge", nodes.Local() as value, nodes.Const() as least), nodes.Compare("le", same, most)):
            return f"({expression(scope, least)} <= {expression(scope, value)} <= {expression(scope, most)})" if value == same else ""
        case _:
            return ""


def _converted(scope: Scope, convert: nodes.Convert) -> str:
    if (zigzag := zigzag_of(convert)) is not None:
        text = expression(scope, zigzag)
        return f"({text} >> 1 ^ -({text} & 1))"
    if isinstance(convert.operand, nodes.Get) and (flag := scope.truth_of(convert.operand.place)) is not None:
        return f"(1 if {flag} else 0)"
    if convert.type == "i64" and is_small(convert.operand, scope.small):
        return expression(scope, convert.operand)
    return converted(convert.type, type_of(convert.operand), expression(scope, convert.operand))


def is_small(expr: nodes.Expr, small: Collection[str]) -> bool:
    """Whether an integer of 64 bits without a sign is seen to be below 2**63, as some locals are."""
    match expr:
        case nodes.Const("u64", value):
            return value < 1 << 63
        case nodes.Local("u64", name):
            return name in small
        case nodes.Convert("u64", operand):
            return type_of(operand) in ("bool", "u8", "u16", "u32")
        case nodes.Binary("and", left, right):
            return type_of(expr) == "u64" and (is_small(left, small) or is_small(right, small))
        case nodes.Binary("or" | "xor", left, right):
            return is_small(left, small) and is_small(right, small)
        case nodes.Binary("shr", left, nodes.Const(_, places)):
            return type_of(left) == "u64" and (places > 0 or is_small(left, small))
        case _:
            return False


def _decimal(scope: Scope, expr: nodes.Nearest | nodes.Digits | nodes.Scale) -> str:
    match expr:
        case nodes.Nearest(address, size, exponent):
            (memory, start), count = location(scope, address), expression(scope, size)
            return f"_nearest({memory}[{start} : {start} + {count}], {bare(expression(scope, exponent))})"
        case nodes.Digits(value, None):
            return f"_shortest({_and_width(scope, value)})[0]"
        case nodes.Digits(value, places):
            return f"_fixed_digits({bare(expression(scope, value))}, {places})"
        case nodes.Scale(value):
            return f"_shortest({_and_width(scope, value)})[1]"
        case _:
            assert_never(expr)


def _and_width(scope: Scope, value: nodes.Expr) -> str:
    """A float, and how many bits it has."""
    return f"{bare(expression(scope, value))}, {8 * nodes.WIDTH[type_of(value)]}"


def _known(scope: Scope, expr: nodes.Known) -> str:
    match expr:
        case nodes.Used(lane):
            return scope.used(lane)
        case nodes.Capacity(lane):
            return scope.room(lane)
        case nodes.HostValue(what):
            scope.from_call.add(what)
            return f"call_{what}"
        case nodes.Register(number):
            scope.from_call.add("registers")
            return f"call_registers[{number}]"


def _is_text(scope: Scope, address: nodes.Address, size: str) -> str:
    memory, start = location(scope, address)
    if memory == "data":  # bytes know whether they are ASCII
        return f"(data[{start} : {start} + {size}].isascii() or _is_text(data, {start}, {bare(size)}))"
    return f"_is_text({memory}, {start}, {bare(size)})"


def _constant(type_: nodes.Scalar, value: float) -> str:
    if type_ == "bool":
        return "True" if value else "False"
    if type_ not in FLOATS:
        return str(int(value)) if value >= 0 else f"({int(value)})"
    with np.errstate(over="ignore"):
        number = float(np.float32(value)) if type_ == "f32" else float(value)
    if math.isnan(number):
        return "math.nan"
    if math.isinf(number):
        return "math.inf" if number > 0 else "(-math.inf)"
    return repr(number) if not repr(number).startswith("-") else f"({number!r})"


def _loaded(scope: Scope, type_: nodes.Scalar, at: str, order: str) -> str:
    if type_ == "u8":
        return f"data[{at}]"
    if type_ == "bool":
        return f"(data[{at}] != 0)"
    return f"{scope.struct('<' if nodes.WIDTH[type_] == 1 else order, CODES[type_], 'load')}(data, {at})[0]"


def _unary(function: str, type_: nodes.Scalar, value: str) -> str:
    match function:
        case "not" if type_ == "bool":
            return f"(not {value})"
        case "not":
            return f"(~{value})" if type_[0] == "i" else f"({value} ^ {2 ** (8 * nodes.WIDTH[type_]) - 1})"
        case "neg":
            return f"(-{value})"
        case "abs":
            return f"abs({bare(value)})"
        case _ if type_ not in FLOATS:
            return value
        case "floor" | "ceil" | "trunc" | "rint":
            return f"_rounded({ROUNDINGS[function]}, {bare(value)})"
        case _:
            return _rounded(type_, f"_of_math(math.{function}, {bare(value)})")


def _rounded(type_: nodes.Scalar, value: str) -> str:
    return f"_single({bare(value)})" if type_ == "f32" else value


def _binary(op: str, type_: nodes.Scalar, left: str, right: str) -> str:
    match op:
        case "and" | "or" | "xor" if type_ == "bool":
            return f"({left} {LOGICAL[op]} {right})"
        case "min" | "max" if type_ in FLOATS:
            return f"_{'least' if op == 'min' else 'most'}({bare(left)}, {bare(right)})"
        case "min" | "max":
            return f"{op}({bare(left)}, {bare(right)})"
        case "div":
            return (
                _rounded(type_, f"_divided({bare(left)}, {bare(right)})") if type_ in FLOATS else f"_quotient({bare(left)}, {bare(right)})"
            )
        case "rem":
            return f"_of_math(math.fmod, {left}, {right})" if type_ in FLOATS else f"_remainder({bare(left)}, {bare(right)})"
        case "atan2":
            return f"_of_math(math.atan2, {left}, {right})"
        case "shl":
            return wrapped(type_, f"({left} << {right})")
        case _:
            return _rounded(type_, f"({left} {OPERATORS[op]} {right})") if type_ in FLOATS else f"({left} {OPERATORS[op]} {right})"


def slice_of(scope: Scope, at: nodes.Expr, size: nodes.Expr) -> str:
    """Bytes of the message."""
    begin = bare(expression(scope, at))
    if isinstance(at, nodes.Const) and isinstance(size, nodes.Const):
        return f"data[{begin} : {int(at.value + size.value)}]"
    end = scope.sums.get(nodes.Binary("add", at, size)) or f"{begin} + {expression(scope, size)}"
    return f"data[{begin} : {end}]"


def location(scope: Scope, address: nodes.Address) -> tuple[str, str]:
    """Memory, and the number of a byte in there."""
    match address:
        case nodes.Wire(at):
            return "data", bare(expression(scope, at))
        case nodes.Place(lane, row, offset):
            return scope.view(lane, ""), _scaled(expression(scope, row), scope.lanes.stride(lane), offset)
        case _:
            assert_never(address)
