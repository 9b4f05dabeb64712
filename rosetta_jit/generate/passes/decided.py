"""Comparisons that a number's type decides, as `byte < 0` or `int64_t(byte) >= 256`: compilers complain of them. Values stand instead."""

from __future__ import annotations

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.arithmetic import FLOATS, limits
from rosetta_jit.kernel.passes.fold import FALSE, OPPOSITE, TRUE, folded
from rosetta_jit.kernel.rewrite import with_blocks, with_expressions, with_operands
from rosetta_jit.kernel.terms import is_wider, type_of


def decided(block: nodes.Block) -> nodes.Block:
    """A block without such comparisons, nor checks that hold whatever a message says."""
    changed = (with_blocks(with_expressions(stmt, _decided), decided) for stmt in block)
    return tuple(stmt for stmt in changed if not (isinstance(stmt, nodes.Expect) and stmt.condition == TRUE))


def _decided(expr: nodes.Expr) -> nodes.Expr:
    found = with_operands(expr, _decided)
    match found:
        case nodes.Compare(op, left, nodes.Const(type_, value)) if type_ not in FLOATS and type_ != "bool":
            answer = _answer(op, *_limits(left), int(value))
            return found if answer is None else TRUE if answer else FALSE
        case _:
            return found if found is expr else folded(found)


def _limits(expr: nodes.Expr) -> tuple[int, int]:
    """Least and greatest value that an integer can have, for its type or the narrower one that it comes from."""
    match expr:
        case nodes.Convert(type_, operand) if (
            type_of(operand) not in FLOATS and type_of(operand) != "bool" and is_wider(type_, type_of(operand))
        ):
            return _limits(operand)
        case _:
            return limits(type_of(expr))


def _answer(op: nodes.Comparison, least: int, greatest: int, value: int) -> bool | None:
    """What all numbers within limits give; None where some differ."""
    match op:
        case "lt":
            return True if greatest < value else False if least >= value else None
        case "le":
            return True if greatest <= value else False if least > value else None
        case "eq":
            return None if least <= value <= greatest else False
        case "ne" | "gt" | "ge":
            opposite = _answer(OPPOSITE[op], least, greatest, value)
            return None if opposite is None else not opposite
