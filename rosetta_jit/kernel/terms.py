"""Small terms of kernels: the parameters, positions in their normal form, and what type a term has."""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.kernel import nodes

BEGIN, END, ROW = nodes.Local("i64", "begin"), nodes.Local("i64", "end"), nodes.Local("i64", "row")


def index(value: int) -> nodes.Const:
    """An int64 constant."""
    return nodes.Const("i64", value)


def add(left: nodes.Expr, right: nodes.Expr | int) -> nodes.Expr:
    """``left + right`` in i64, with constants folded to the right: the normal form of a position."""
    if isinstance(right, nodes.Const) and right.type == "i64":
        right = int(right.value)
    if not isinstance(right, int):
        return right if left == index(0) else nodes.Binary("add", left, right)
    match left:
        case nodes.Const("i64", value):
            return index(int(value) + right)
        case nodes.Binary("add", base, nodes.Const("i64", value)):
            total = int(value) + right
            return nodes.Binary("add", base, index(total)) if total else base
        case _:
            return nodes.Binary("add", left, index(right)) if right else left


def split(expr: nodes.Expr) -> tuple[nodes.Expr, int]:
    """An int64 expression without the constant that `add` has put behind it, and that constant."""
    match expr:
        case nodes.Binary("add", base, nodes.Const("i64", value)):
            return base, int(value)
        case _:
            return expr, 0


def mul(left: nodes.Expr, right: nodes.Expr | int) -> nodes.Expr:
    """``left * right`` in i64, with constants folded."""
    if isinstance(right, int):
        right = index(right)
    match left, right:
        case nodes.Const("i64", a), nodes.Const("i64", b):
            return index(int(a) * int(b))
        case _, nodes.Const("i64", 1):
            return left
        case nodes.Const("i64", 1), _:
            return right
        case nodes.Const(), _:
            return nodes.Binary("mul", right, left)
        case _:
            return nodes.Binary("mul", left, right)


def joined(op: nodes.Arithmetic, terms: Sequence[nodes.Expr]) -> nodes.Expr:
    """Terms under one operation, whichever are grouped: a tree of halves, as a chain of many would nest deeper than expressions may."""
    if len(terms) == 1:
        return terms[0]
    half = len(terms) // 2
    return nodes.Binary(op, joined(op, terms[:half]), joined(op, terms[half:]))


def type_of(expr: nodes.Expr) -> nodes.Scalar:
    """The type of an expression."""
    match expr:
        case nodes.Const() | nodes.Local() | nodes.Load() | nodes.Get() | nodes.Convert() | nodes.Bits() | nodes.Lookup():
            return expr.type
        case nodes.Used() | nodes.Capacity() | nodes.HostValue() | nodes.Register():
            return "i64"
        case nodes.Unary(_, operand):
            return type_of(operand)
        case nodes.Binary(_, left, _):
            return type_of(left)
        case nodes.Compare() | nodes.Fits() | nodes.IsText():
            return "bool"
        case nodes.Select(_, then, _):
            return type_of(then)
        case nodes.Nearest():
            return "f64"
        case nodes.Digits():
            return "u64"
        case nodes.Scale():
            return "i64"


def is_wider(target: nodes.Scalar, source: nodes.Scalar) -> bool:
    """Whether all values of an integer type are ones of another."""
    if target[0] == source[0]:
        return nodes.WIDTH[target] >= nodes.WIDTH[source]
    return target[0] == "i" and nodes.WIDTH[target] > nodes.WIDTH[source]
