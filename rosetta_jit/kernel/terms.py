"""Small terms of kernels: the parameters, positions in their normal form, and what type a term has."""

from __future__ import annotations

from rosetta_jit.kernel import ir

BEGIN, END, ROW = ir.Local("i64", "begin"), ir.Local("i64", "end"), ir.Local("i64", "row")


def index(value: int) -> ir.Const:
    """An int64 constant."""
    return ir.Const("i64", value)


def add(left: ir.Expr, right: ir.Expr | int) -> ir.Expr:
    """``left + right`` in i64, with constants folded to the right: the normal form of a position."""
    if isinstance(right, ir.Const) and right.type == "i64":
        right = int(right.value)
    if not isinstance(right, int):
        return right if left == index(0) else ir.Binary("add", left, right)
    match left:
        case ir.Const("i64", value):
            return index(int(value) + right)
        case ir.Binary("add", base, ir.Const("i64", value)):
            total = int(value) + right
            return ir.Binary("add", base, index(total)) if total else base
        case _:
            return ir.Binary("add", left, index(right)) if right else left


def split(expr: ir.Expr) -> tuple[ir.Expr, int]:
    """An int64 expression without the constant that `add` has put behind it, and that constant."""
    match expr:
        case ir.Binary("add", base, ir.Const("i64", value)):
            return base, int(value)
        case _:
            return expr, 0


def mul(left: ir.Expr, right: ir.Expr | int) -> ir.Expr:
    """``left * right`` in i64, with constants folded."""
    if isinstance(right, int):
        right = index(right)
    match left, right:
        case ir.Const("i64", a), ir.Const("i64", b):
            return index(int(a) * int(b))
        case _, ir.Const("i64", 1):
            return left
        case ir.Const("i64", 1), _:
            return right
        case ir.Const(), _:
            return ir.Binary("mul", right, left)
        case _:
            return ir.Binary("mul", left, right)


def type_of(expr: ir.Expr) -> ir.Scalar:
    """The type of an expression."""
    match expr:
        case ir.Const() | ir.Local() | ir.Load() | ir.Get() | ir.Convert() | ir.Bits() | ir.Lookup():
            return expr.type
        case ir.Used() | ir.Capacity() | ir.HostValue() | ir.Register():
            return "i64"
        case ir.Unary(_, operand):
            return type_of(operand)
        case ir.Binary(_, left, _):
            return type_of(left)
        case ir.Compare() | ir.Fits() | ir.IsText():
            return "bool"
        case ir.Select(_, then, _):
            return type_of(then)
        case ir.Nearest():
            return "f64"
        case ir.Digits():
            return "u64"
        case ir.Scale():
            return "i64"


def is_wider(target: ir.Scalar, source: ir.Scalar) -> bool:
    """Whether all values of an integer type are ones of another."""
    if target[0] == source[0]:
        return ir.WIDTH[target] >= ir.WIDTH[source]
    return target[0] == "i" and ir.WIDTH[target] > ir.WIDTH[source]
