"""The nodes that kernels are made of: scalars, expressions, statements. `rosetta_jit.kernel.ir` says what each of them means."""

from __future__ import annotations

from typing import Literal

from rosetta_jit.startup.dataclass import dataclass

Scalar = Literal["bool", "i8", "u8", "i16", "u16", "i32", "u32", "i64", "u64", "f32", "f64"]
Order = Literal["<", ">"]
Direction = Literal["decode", "encode", "size"]
Arithmetic = Literal["add", "wrapping_add", "sub", "mul", "div", "rem", "and", "or", "xor", "shl", "shr", "min", "max", "atan2"]
Comparison = Literal["eq", "ne", "lt", "le", "gt", "ge"]
Function = Literal["neg", "not", "abs", "sqrt", "floor", "ceil", "trunc", "rint", "sin", "cos", "tan", "asin", "acos", "atan"]
"""The last six, and `atan2`, are those of the C library, of f64 alone; which NaN they give is not said."""

WIDTH: dict[str, int] = {
    "bool": 1,
    "i8": 1,
    "u8": 1,
    "i16": 2,
    "u16": 2,
    "i32": 4,
    "u32": 4,
    "i64": 8,
    "u64": 8,
    "f32": 4,
    "f64": 8,
}
"""Bytes of a scalar, on the wire and in a lane."""

# --- expressions -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Const:
    type: Scalar
    value: int | float | bool


@dataclass(frozen=True, slots=True)
class Local:
    type: Scalar
    name: str


@dataclass(frozen=True, slots=True)
class Load:
    """The scalar at byte ``at`` of the message."""

    type: Scalar
    at: Expr
    order: Order = "<"


@dataclass(frozen=True, slots=True)
class Place:
    """The field at byte ``offset`` of row ``row`` of a lane."""

    lane: int
    row: Expr
    offset: int = 0


@dataclass(frozen=True, slots=True)
class Get:
    """The scalar at a place of the holder."""

    type: Scalar
    place: Place


@dataclass(frozen=True, slots=True)
class Used:
    """How many rows of a lane are in use (i64)."""

    lane: int


@dataclass(frozen=True, slots=True)
class Capacity:
    """How many rows a lane has room for (i64)."""

    lane: int


@dataclass(frozen=True, slots=True)
class HostValue:
    """What the host says of this message (i64): when it is made, or how many were made before."""

    what: Literal["now", "number"]


@dataclass(frozen=True, slots=True)
class Register:
    """What a register holds when the kernel starts (i64)."""

    number: int


@dataclass(frozen=True, slots=True)
class Unary:
    function: Function
    operand: Expr


@dataclass(frozen=True, slots=True)
class Binary:
    """Both operands have the type of the result."""

    op: Arithmetic
    left: Expr
    right: Expr


@dataclass(frozen=True, slots=True)
class Compare:
    op: Comparison
    left: Expr
    right: Expr


@dataclass(frozen=True, slots=True)
class Fits:
    """Whether ``left op right`` of two i64 is an i64."""

    op: Literal["add", "sub", "mul"]
    left: Expr
    right: Expr


@dataclass(frozen=True, slots=True)
class Convert:
    type: Scalar
    operand: Expr


@dataclass(frozen=True, slots=True)
class Bits:
    """The bits of a number as another type of the same width."""

    type: Scalar
    operand: Expr


@dataclass(frozen=True, slots=True)
class Select:
    """Both values are computed."""

    condition: Expr
    then: Expr
    otherwise: Expr


@dataclass(frozen=True, slots=True)
class Wire:
    """Byte ``at`` of the message."""

    at: Expr


Address = Wire | Place


@dataclass(frozen=True, slots=True)
class IsText:
    """Whether ``size`` bytes are valid UTF-8 (Unicode 15, table 3-7)."""

    address: Address
    size: Expr


@dataclass(frozen=True, slots=True)
class Nearest:
    """The f64 nearest to the integer that the digits among ``size`` bytes spell, times ten to the power of ``exponent`` (i64)."""

    address: Address
    size: Expr
    exponent: Expr


@dataclass(frozen=True, slots=True)
class Digits:
    """Decimal digits of a float's absolute value, as a u64: the fewest that, rounded correctly, read back.

    With ``places`` (up to 17) those of the number rounded to so many decimals, half to even, of which the low 64 bits count.
    What is not finite has the digits 0.
    """

    value: Expr
    places: int | None = None


@dataclass(frozen=True, slots=True)
class Scale:
    """The power of ten (i64) times which the fewest `Digits` are the float."""

    value: Expr


@dataclass(frozen=True, slots=True)
class Lookup:
    """The one of some integers that has the number ``index`` (i64): 0 <= index < how many they are."""

    type: Scalar
    values: tuple[int, ...]
    index: Expr


Decimal = Nearest | Digits | Scale
Known = Used | Capacity | HostValue | Register
Expr = Const | Local | Load | Get | Known | Unary | Binary | Compare | Fits | Convert | Bits | Select | IsText | Decimal | Lookup

# --- statements --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Failure:
    """What a failing statement reports: its site, the byte offset, and the values of the enclosing indices in the site's path."""

    site: int
    at: Expr
    indices: tuple[Expr, ...] = ()


@dataclass(frozen=True, slots=True)
class Require:
    """``size >= 0`` bytes of the message lie at ``at >= 0``, before `end`."""

    at: Expr
    size: Expr
    failure: Failure


@dataclass(frozen=True, slots=True)
class Expect:
    condition: Expr
    failure: Failure


@dataclass(frozen=True, slots=True)
class Let:
    name: str
    value: Expr


@dataclass(frozen=True, slots=True)
class Var:
    name: str
    value: Expr


@dataclass(frozen=True, slots=True)
class Assign:
    name: str
    value: Expr


@dataclass(frozen=True, slots=True)
class Store:
    """Write a scalar to byte ``at`` of the message."""

    at: Expr
    value: Expr
    order: Order = "<"


@dataclass(frozen=True, slots=True)
class SetField:
    place: Place
    value: Expr


@dataclass(frozen=True, slots=True)
class Reserve:
    """``count >= 0`` more rows fit in the lane. Changes nothing."""

    lane: int
    count: Expr


@dataclass(frozen=True, slots=True)
class Advance:
    """``count >= 0`` rows, reserved before, are now in use."""

    lane: int
    count: Expr


@dataclass(frozen=True, slots=True)
class Copy:
    """``size >= 0`` bytes between the message and a lane, which never overlap, or between two parts of a lane that do not."""

    target: Address
    source: Address
    size: Expr


@dataclass(frozen=True, slots=True)
class Fill:
    """``size >= 0`` bytes of one value."""

    target: Address
    size: Expr
    byte: int = 0


@dataclass(frozen=True, slots=True)
class For:
    """``variable`` from 0 to ``count`` (exclusive; a count below 1 runs nothing)."""

    variable: str
    count: Expr
    body: Block


@dataclass(frozen=True, slots=True)
class While:
    """``invariant`` holds before and after each round; ``measure`` grows in each round, and ``condition`` bounds it from above."""

    condition: Expr
    body: Block
    invariant: tuple[Expr, ...]
    measure: Expr


@dataclass(frozen=True, slots=True)
class If:
    condition: Expr
    then: Block
    otherwise: Block = ()


@dataclass(frozen=True, slots=True)
class Switch:
    """Distinct integer cases of an integer."""

    value: Expr
    cases: tuple[tuple[int, Block], ...]
    default: Block


@dataclass(frozen=True, slots=True)
class Return:
    """The end of a message that was handled; ``registers`` are those that hold other values from now on, by their numbers, which rise."""

    position: Expr
    registers: tuple[tuple[int, Expr], ...] = ()


@dataclass(frozen=True, slots=True)
class Call:
    """Run a routine and bind its results. ``sites`` stand for the routine's own, from its number 1 on, and ``indices`` belong to them."""

    routine: str
    arguments: tuple[Expr, ...]
    results: tuple[Local, ...]
    sites: tuple[int, ...]
    indices: tuple[Expr, ...] = ()


@dataclass(frozen=True, slots=True)
class Extent:
    """``size >= 0`` bytes from an address."""

    address: Address
    size: Expr


@dataclass(frozen=True, slots=True)
class HostCall:
    """Run a function of the host and bind its result."""

    function: str
    arguments: tuple[Expr, ...]
    result: Local
    failure: Failure
    inputs: tuple[Extent, ...] = ()
    target: Extent | None = None


Effect = Store | SetField | Copy | Fill
Nest = For | While | If | Switch
Stmt = Require | Expect | Let | Var | Assign | Effect | Reserve | Advance | Nest | Return | Call | HostCall
Block = tuple[Stmt, ...]
