"""Kernel expressions as forms of exactly their type: integers are declared to have their width, bools are t and nil.

(u32-at message +header.seq+)                   a field of the message's row
(f64-at points (row 24 i +points.x+))           one of another lane
(f64-be-at data (i64+ at 8))                    a number of the message, its high byte first

Arithmetic that the proof knows to stay within its type is declared to do so, and compiles to single instructions.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, assert_never

import numpy as np

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.arithmetic import FLOATS, SIGNED, binary, to_bytes, unary
from rosetta_jit.kernel.arithmetic import constant as of_type
from rosetta_jit.kernel.terms import END, is_wider, type_of
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.lisp.lanes import Lanes
    from rosetta_jit.generate.lisp.words import Names

ARITHMETIC = {"add": "+", "wrapping_add": "+%", "sub": "-", "mul": "*", "div": "/", "rem": "-rem", "shl": "<<", "shr": ">>"}
"""Behind the name of an integer type: `i64+`."""
OF_FLOATS = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
BITWISE = {"and": "logand", "or": "logior", "xor": "logxor"}
COMPARISONS = {"eq": "=", "ne": "/=", "lt": "<", "le": "<=", "gt": ">", "ge": ">="}
LARGE = 1 << 32
"""Integers from here on are bits rather than amounts."""

LEAST, GREATEST = 1e-300, 1e300
"""Doubles between these are written as decimals; others by their bits, as readers may refuse what is so small that it has fewer digits."""


@dataclass(slots=True)
class Scope:
    """What the printers of a function share.

    ``touched`` are the lanes whose rows it reads or writes, ``counted`` those whose rows in use it counts, ``registers`` those
    with the state of the mapping.
    """

    locals: Names
    lanes: Lanes
    touched: set[int] = field(default_factory=set[int])
    counted: set[int] = field(default_factory=set[int])
    registers: Literal["unpack", "pack"] = "unpack"

    def rows(self, lane: int) -> str:
        """The variable with a lane's rows."""
        self.touched.add(lane)
        return self.lanes.rows(lane)

    def used(self, lane: int) -> str:
        """The variable that counts a lane's rows in use."""
        self.counted.add(lane)
        return self.lanes.used(lane)


def expression(scope: Scope, expr: nodes.Expr) -> str:
    """The form of an expression."""
    match expr:
        case nodes.Const(type_, value):
            return constant(type_, value)
        case nodes.Local(_, name):
            return "end" if name == END.name else scope.locals.symbol(name)
        case nodes.Load(type_, at, order):
            return f"({access(type_, order)} data {expression(scope, at)})"
        case nodes.Get(type_, place):
            return got(scope, type_, place)
        case nodes.Used() | nodes.Capacity() | nodes.HostValue() | nodes.Register():
            return _known(scope, expr)
        case nodes.Unary() | nodes.Binary():
            return _operation(scope, expr)
        case nodes.Compare(op, left, right):
            return _compare(op, type_of(left), expression(scope, left), expression(scope, right))
        case nodes.Fits(op, left, right):
            return f"(fits{ARITHMETIC[op]} {expression(scope, left)} {expression(scope, right)})"
        case nodes.Convert(type_, operand):
            return _convert(type_, type_of(operand), expression(scope, operand))
        case nodes.Bits(type_, operand):
            return _bits(type_, type_of(operand), expression(scope, operand))
        case nodes.Select(condition, then, otherwise):
            return f"(if {expression(scope, condition)} {expression(scope, then)} {expression(scope, otherwise)})"
        case nodes.IsText(address, size):
            memory, start = location(scope, address)
            return f"(text-p {memory} {start} {expression(scope, size)})"
        case nodes.Nearest() | nodes.Digits() | nodes.Scale():
            return _decimal(scope, expr)
        case nodes.Lookup(type_, values, index):
            return f"(aref {_table(type_, values)} {expression(scope, index)})"
        case _:
            assert_never(expr)


def _operation(scope: Scope, expr: nodes.Unary | nodes.Binary) -> str:
    known = _of_constants(expr)
    if known is not None and math.isnan(known):
        return constant(type_of(expr), known)  # SBCL warns where it computes one itself
    match expr:
        case nodes.Unary(function, operand):
            return _unary(function, type_of(operand), expression(scope, operand))
        case nodes.Binary(op, left, right):
            return _binary(op, type_of(left), expression(scope, left), expression(scope, right))
        case _:
            assert_never(expr)


def _of_constants(expr: nodes.Unary | nodes.Binary) -> float | None:
    """What an operation on constant floats gives; None where there are others."""
    with np.errstate(all="ignore"):
        match expr:
            case nodes.Unary(function, nodes.Const(type_, value)) if type_ in FLOATS:
                return float(unary(type_, function, of_type(type_, value)))
            case nodes.Binary(op, nodes.Const(type_, left), nodes.Const(_, right)) if type_ in FLOATS:
                return float(binary(type_, op, of_type(type_, left), of_type(type_, right)))
            case _:
                return None


def _table(type_: nodes.Scalar, values: tuple[int, ...]) -> str:
    """An array that is made when the file is loaded."""
    element = f"({'signed' if type_ in SIGNED else 'unsigned'}-byte {8 * nodes.WIDTH[type_]})"
    made = f"(make-array {len(values)} :element-type '{element} :initial-contents '({' '.join(map(str, values))}))"
    return f"(the (simple-array {element} ({len(values)})) (load-time-value {made} t))"


def _known(scope: Scope, expr: nodes.Known) -> str:
    match expr:
        case nodes.Used(lane):
            return scope.used(lane)
        case nodes.Capacity(lane):
            return "1" if lane == 0 else f"(the i64 (truncate (length {scope.rows(lane)}) {scope.lanes.stride(lane)}))"
        case nodes.HostValue(what):
            return f"(codec-state-{what} codec)"
        case nodes.Register(number):
            return state_word(scope, number)
        case _:
            assert_never(expr)


def state_word(scope: Scope, number: int) -> str:
    """What a state variable holds."""
    return f"(aref (codec-state-{scope.registers}-registers codec) {number})"


def constant(type_: nodes.Scalar, value: float) -> str:
    """A literal."""
    if type_ == "bool":
        return "t" if value else "nil"
    if type_ not in FLOATS:
        return str(int(value)) if abs(value) < LARGE else f"#x{int(value):x}"
    with np.errstate(over="ignore"):
        number = np.float32(value) if type_ == "f32" else np.float64(value)
    single = type_ == "f32"
    size = abs(float(number))
    plain = size == 0 or (1e-37 < size < 1e38 if single else LEAST < size < GREATEST)
    if not math.isfinite(number) or not plain:
        return f"({type_}-of-bits #x{int.from_bytes(to_bytes(type_, number), 'little'):x})"
    mantissa, _, exponent = str(number).partition("e")
    mantissa = mantissa if "." in mantissa else f"{mantissa}.0"
    return f"{mantissa}{'f' if single else 'd'}{int(exponent or 0)}"


def zero(type_: nodes.Scalar) -> str:
    """What a variable has before it has a value."""
    return constant(type_, 0)


def _unary(function: str, type_: nodes.Scalar, value: str) -> str:
    match function:
        case "not" if type_ == "bool":
            return f"(not {value})"
        case "not":
            return f"(lognot {value})" if type_ in SIGNED else f"(logxor {value} #x{2 ** (8 * nodes.WIDTH[type_]) - 1:x})"
        case "neg" | "abs" if type_ in FLOATS:
            return f"({'-' if function == 'neg' else 'abs'} {value})"
        case "neg" | "abs":
            return f"({type_}-{function} {value})"
        case _ if type_ not in FLOATS:
            return value
        case _:
            return f"({type_}-{function} {value})"


def _binary(op: str, type_: nodes.Scalar, left: str, right: str) -> str:
    match op:
        case "and" | "or" if type_ == "bool":
            return f"({op} {left} {right})"
        case "xor" if type_ == "bool":
            return f"(not (eq {left} {right}))"
        case "and" | "or" | "xor":
            return f"({BITWISE[op]} {left} {right})"
        case "min" | "max":
            return f"({type_}-{op} {left} {right})" if type_ in FLOATS else f"({op} {left} {right})"
        case "rem" | "atan2" if type_ in FLOATS:
            return f"({type_}-{op} {left} {right})"
        case _:
            return f"({OF_FLOATS[op] if type_ in FLOATS else f'{type_}{ARITHMETIC[op]}'} {left} {right})"


def _compare(op: str, type_: nodes.Scalar, left: str, right: str) -> str:
    if type_ == "bool":
        if op in ("eq", "ne"):
            return f"(eq {left} {right})" if op == "eq" else f"(not (eq {left} {right}))"
        left, right = f"(if {left} 1 0)", f"(if {right} 1 0)"
    return f"({type_}{COMPARISONS[op]} codec {left} {right})" if type_ in FLOATS else f"({COMPARISONS[op]} {left} {right})"


def _convert(target: nodes.Scalar, source: nodes.Scalar, value: str) -> str:
    if target == source:
        return value
    if target == "bool":
        return _compare("ne", source, value, zero(source))
    if source == "bool":
        return f"(if {value} {constant(target, 1)} {zero(target)})"
    if source in FLOATS:
        return f"({target}-of-{source} {value})"
    if target in FLOATS:
        return f"({target}-of-{'u64' if source == 'u64' else 'i64'} {value})"
    return value if is_wider(target, source) else f"(wrap-{target} {value})"


def _bits(target: nodes.Scalar, source: nodes.Scalar, value: str) -> str:
    if target == source:
        return value
    unsigned: nodes.Scalar = "u64" if nodes.WIDTH[source] == 8 else "u32"
    if source in FLOATS:
        return _convert(target, unsigned, f"(bits-of-{source} {value})")
    if target in FLOATS:
        return f"({target}-of-bits {_convert(unsigned, source, value)})"
    return _convert(target, source, value)


def _decimal(scope: Scope, expr: nodes.Nearest | nodes.Digits | nodes.Scale) -> str:
    match expr:
        case nodes.Nearest(address, size, exponent):
            memory, start = location(scope, address)
            return f"(the f64 (nearest {memory} {start} {expression(scope, size)} {expression(scope, exponent)}))"
        case nodes.Digits(value, None):
            return f"(the u64 (shortest-digits {expression(scope, value)}))"
        case nodes.Digits(value, places):
            return f"(the u64 (fixed-digits {expression(scope, value)} {places}))"
        case nodes.Scale(value):
            return f"(the i64 (shortest-scale {expression(scope, value)}))"
        case _:
            assert_never(expr)


# --- memory ------------------------------------------------------------------------------------------------------------


def access(type_: nodes.Scalar, order: str = "<") -> str:
    """The function that reads a scalar, which `setf` writes."""
    return f"{type_}{'-be' if order == '>' and nodes.WIDTH[type_] > 1 else ''}-at"


def got(scope: Scope, type_: nodes.Scalar, place: nodes.Place) -> str:
    """A field of a row, which `setf` writes, too."""
    memory, start = location(scope, place, type_)
    return f"({access(type_)} {memory} {start})"


def location(scope: Scope, address: nodes.Address, scalar: nodes.Scalar | None = None) -> tuple[str, str]:
    """Memory, and the number of a byte in there; a field's by its name."""
    match address:
        case nodes.Wire(at):
            return "data", expression(scope, at)
        case nodes.Place(lane, row, offset):
            behind = str(offset) if scalar is None else scope.lanes.offset(lane, offset, scalar)
            return scope.rows(lane), row_start(scope.lanes.stride(lane), expression(scope, row), behind)
        case _:
            assert_never(address)


def row_start(stride: int, row: str, offset: str = "0") -> str:
    """The byte where a row of a lane begins, or a field of it."""
    if row == "0":
        return offset
    if offset == "0":
        return row if stride == 1 else f"(row {stride} {row})"
    return f"(row {stride} {row} {offset})"
