"""Small terms of kernels: the parameters, positions in their normal form, and what type a term has."""

from __future__ import annotations

from rosetta_jit.kernel.ir import (
    Binary,
    Bits,
    Capacity,
    Compare,
    Const,
    Convert,
    Digits,
    Expr,
    Fits,
    Get,
    HostValue,
    IsText,
    Load,
    Local,
    Lookup,
    Nearest,
    Register,
    Scalar,
    Scale,
    Select,
    Unary,
    Used,
)

BEGIN, END, ROW = Local("i64", "begin"), Local("i64", "end"), Local("i64", "row")


def index(value: int) -> Const:
    """An int64 constant."""
    return Const("i64", value)


def add(left: Expr, right: Expr | int) -> Expr:
    """``left + right`` in i64, with constants folded to the right: the normal form of a position."""
    if isinstance(right, Const) and right.type == "i64":
        right = int(right.value)
    if not isinstance(right, int):
        return right if left == index(0) else Binary("add", left, right)
    match left:
        case Const("i64", value):
            return index(int(value) + right)
        case Binary("add", base, Const("i64", value)):
            total = int(value) + right
            return Binary("add", base, index(total)) if total else base
        case _:
            return Binary("add", left, index(right)) if right else left


def split(expr: Expr) -> tuple[Expr, int]:
    """An int64 expression without the constant that `add` has put behind it, and that constant."""
    match expr:
        case Binary("add", base, Const("i64", value)):
            return base, int(value)
        case _:
            return expr, 0


def mul(left: Expr, right: Expr | int) -> Expr:
    """``left * right`` in i64, with constants folded."""
    if isinstance(right, int):
        right = index(right)
    match left, right:
        case Const("i64", a), Const("i64", b):
            return index(int(a) * int(b))
        case _, Const("i64", 1):
            return left
        case Const("i64", 1), _:
            return right
        case Const(), _:
            return Binary("mul", right, left)
        case _:
            return Binary("mul", left, right)


def type_of(expr: Expr) -> Scalar:
    """The type of an expression."""
    match expr:
        case Const() | Local() | Load() | Get() | Convert() | Bits() | Lookup():
            return expr.type
        case Used() | Capacity() | HostValue() | Register():
            return "i64"
        case Unary(_, operand):
            return type_of(operand)
        case Binary(_, left, _):
            return type_of(left)
        case Compare() | Fits() | IsText():
            return "bool"
        case Select(_, then, _):
            return type_of(then)
        case Nearest():
            return "f64"
        case Digits():
            return "u64"
        case Scale():
            return "i64"
