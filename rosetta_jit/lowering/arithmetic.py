"""Arithmetic of rules and computed fields as kernel expressions, with the checks that it needs written down."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel.ir import Binary, Compare, Const, Expr, Select, add, index, mul, type_of

if TYPE_CHECKING:
    from rosetta_jit.lowering.writer import Where, Writer
    from rosetta_jit.model.expr import Operator

_OPS = {"+": "add", "-": "sub", "*": "mul", "/": "div", "%": "rem"}


def binary(writer: Writer, operator: Operator, left: Expr, right: Expr, where: Where, line: str = "") -> Expr:
    """``left operator right`` of two int64 or two floats of one size. Integers are checked: they never wrap, never divide by zero."""
    if type_of(left) in ("f32", "f64"):
        match _OPS[operator]:
            case "add" | "sub" | "mul" | "div" | "rem" as op:
                return Binary(op, left, right)
            case _:
                raise AssertionError(operator)
    match operator:
        case "+" | "*" if isinstance(left, Const) and isinstance(right, Const):
            return add(left, right) if operator == "+" else mul(left, right)
        case "+":
            return writer.checked("add", left, right, where, line=line)
        case "-":
            return writer.checked("sub", left, right, where, line=line)
        case "*":
            return writer.checked("mul", left, right, where, line=line)
        case "/" | "%":
            return _division(writer, operator, left, right, where, line)
        case _:
            assert_never(operator)


def _division(writer: Writer, operator: str, left: Expr, right: Expr, where: Where, line: str) -> Expr:
    """Divisors 0 and -1 are refused: the one has no quotient, the other none that always fits."""
    if not (isinstance(right, Const) and right.value not in (0, -1)):
        usable = Binary("or", Compare("gt", right, index(0)), Compare("lt", right, index(-1)))
        writer.expect(usable, "range", where, "division by 0 or -1", line=line)
    return Binary("div" if operator == "/" else "rem", left, right)


def align(writer: Writer, number: Expr, quantum: Expr, where: Where, line: str = "") -> Expr:
    """``number`` rounded up to a multiple of ``quantum``; a quantum of 1 or less changes nothing."""
    writer.expect(Compare("ge", number, index(0)), "range", where, "a negative size cannot be aligned", line=line)
    step = writer.let("step", Binary("max", quantum, index(1)))
    over = writer.let("over", Binary("rem", number, step))
    missing = writer.let("missing", Select(Compare("eq", over, index(0)), index(0), Binary("sub", step, over)))
    return writer.checked("add", number, missing, where, line=line)
