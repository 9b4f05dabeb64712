"""Arithmetic of rules and computed fields as kernel expressions, with the checks that it needs written down."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Arithmetic, Binary, Bits, Compare, Comparison, Const, Expr, Fits, Select
from rosetta_jit.kernel.terms import add, index, mul, type_of
from rosetta_jit.lowering.writer import Where, Writer
from rosetta_jit.model.expr import Operator

_OPS: dict[str, Arithmetic] = {"+": "add", "-": "sub", "*": "mul", "/": "div", "%": "rem"}
_BITS: dict[str, Arithmetic] = {"&": "and", "|": "or", "^": "xor", "and": "and", "or": "or", "<<": "shl", ">>": "shr"}
WORD = 64
"""Bits of an int64."""

LEAST = -(1 << 63)
"""The least int64."""

COMPARISONS: dict[str, Comparison] = {"==": "eq", "!=": "ne", "<": "lt", "<=": "le", ">": "gt", ">=": "ge"}


def binary(writer: Writer, operator: Operator, left: Expr, right: Expr, where: Where, line: str = "") -> Expr:
    """``left operator right`` of two int64 or two floats of one size. Integers are checked: they never wrap, never divide by zero."""
    if type_of(left) in ("f32", "f64"):
        return Binary(_OPS[operator], left, right)
    match operator:
        case "&" | "|" | "^" | "and" | "or":
            return Binary(_BITS[operator], left, right)
        case "<<" | ">>":
            return _shift(writer, operator, left, right, where, line)
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
            raise AssertionError(operator)


def differ(writer: Writer, left: Expr, right: Expr) -> Expr:
    """Whether two floats are not the same to the bit; all NaNs are the same, -0 and 0 are not."""
    word = "u32" if type_of(left) == "f32" else "u64"
    left, right = writer.once(left), writer.once(right)
    bits = Compare("ne", Bits(word, left), Bits(word, right))
    return Binary("and", bits, Binary("or", Compare("eq", left, left), Compare("eq", right, right)))


def _shift(writer: Writer, operator: str, left: Expr, right: Expr, where: Where, line: str) -> Expr:
    """By 0 to 63 bits; bits that leave at the top are lost."""
    if not (isinstance(right, Const) and 0 <= right.value < WORD):
        right = writer.let("bits", right)
        usable = Binary("and", Compare("ge", right, index(0)), Compare("lt", right, index(WORD)))
        writer.expect(usable, "range", where, f"a shift by less than 0 or more than {WORD - 1} bits", line=line)
    return Binary(_BITS[operator], left, right)


def _division(writer: Writer, operator: str, left: Expr, right: Expr, where: Where, line: str) -> Expr:
    """By 0 nothing is divided, and by -1 the least int64 is not: its quotient is none."""
    if isinstance(right, Const) and right.value == -1:
        return writer.checked("sub", index(0), left, where, line=line) if operator == "/" else index(0)
    if not (isinstance(right, Const) and right.value != 0):
        left, right = writer.once(left), writer.once(right)
        writer.expect(Compare("ne", right, index(0)), "range", where, "division by 0", line=line)
        bounded = Binary("or", Compare("ne", left, index(LEAST)), Compare("ne", right, index(-1)))  # as the proof asks for it
        writer.expect(bounded, "range", where, "a number grows beyond 64 bits", line=line)
    return Binary("div" if operator == "/" else "rem", left, right)


def divided(writer: Writer, left: Expr, right: Expr, where: Where, line: str = "") -> Expr:
    """``left / right``; of integers only where nothing remains."""
    if type_of(left) in ("f32", "f64"):
        return Binary("div", left, right)
    left, right = writer.once(left), writer.once(right)
    over = binary(writer, "%", left, right, where, line)
    writer.expect(Compare("eq", over, index(0)), "range", where, "the division leaves a remainder", line=line)
    return binary(writer, "/", left, right, where, line) if right == index(-1) else Binary("div", left, right)


def floored(writer: Writer, function: str, left: Expr, right: Expr, where: Where, line: str = "") -> Expr:
    """The quotient of integers rounded down, or what it leaves: that has the sign of ``right``."""
    left, right = writer.let("dividend", left), writer.let("divisor", right)
    over = writer.let("over", binary(writer, "%", left, right, where, line))
    signs = Compare("ne", Compare("lt", over, index(0)), Compare("lt", right, index(0)))
    is_between = Binary("and", Compare("ne", over, index(0)), signs)
    if function == "modulo":
        return binary(writer, "+", over, writer.let("missing", Select(is_between, right, index(0))), where, line)
    quotient, more = writer.let("quotient", Binary("div", left, right)), writer.let("more", Select(is_between, index(1), index(0)))
    return binary(writer, "-", quotient, more, where, line)


def others(writer: Writer, number: Expr, without: list[Expr], where: Where, line: str = "") -> Expr:
    """The integer of a number, from 0, among those that are not left out: each that is left out and not above it moves it on by one."""
    ordered = [writer.once(each) for each in without]
    for turn in range(len(ordered)):
        for low in range(turn % 2, len(ordered) - 1, 2):
            one, other = ordered[low : low + 2]
            ordered[low], ordered[low + 1] = writer.let("lower", Binary("min", one, other)), writer.let("upper", Binary("max", one, other))
    found, before = writer.let("number", number), None
    for each in ordered:
        is_passed: Expr = Compare("le", each, found)
        if before is not None:  # twice the same counts once
            is_passed = Binary("and", is_passed, Compare("ne", each, before))
        step = writer.let("step", Select(is_passed, index(1), index(0)))
        found, before = writer.once(writer.checked("add", found, step, where, line=line)), each
    return found


def align(writer: Writer, number: Expr, quantum: Expr, where: Where, line: str = "") -> Expr:
    """``number`` rounded up to a multiple of ``quantum``; a quantum of 1 or less changes nothing."""
    number = writer.once(number)
    writer.expect(Compare("ge", number, index(0)), "range", where, "a negative size cannot be aligned", line=line)
    step = writer.let("step", Binary("max", quantum, index(1)))
    over = writer.let("over", Binary("rem", number, step))
    writer.expect(Fits("sub", step, over), "range", where, "a size cannot be aligned so", line=line)  # true anyway; said for the proof
    missing = writer.let("missing", Select(Compare("eq", over, index(0)), index(0), Binary("sub", step, over)))
    return writer.checked("add", number, missing, where, line=line)


def inside(number: Expr, count: Expr) -> Expr:
    """Whether an index is one of so many."""
    return Binary("and", Compare("ge", number, index(0)), Compare("lt", number, count))
