"""Values that a wire schema computes from other fields of the message, as kernel expressions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Expr, Get
from rosetta_jit.kernel.terms import index
from rosetta_jit.lowering.arithmetic import align, binary
from rosetta_jit.lowering.writer import integer
from rosetta_jit.model import expr

if TYPE_CHECKING:
    from rosetta_jit.lowering.codec.fields import Fields
    from rosetta_jit.lowering.writer import Where, Writer


def evaluate(value: expr.Expr, fields: Fields, writer: Writer, where: Where) -> Expr:
    """The value as an int64. Paths start at the message and name numbers that come before, or are given."""
    match value:
        case expr.Literal(int(number)):
            return index(number)
        case expr.Path(_, steps):
            path = tuple(step.name for step in steps if isinstance(step, expr.Member))
            found = fields.get(path)
            assert found is not None, path
            return integer(writer.let("told", found) if isinstance(found, Get) else found)  # the proof looks at each reading anew
        case expr.Len(path):
            return fields.stored(tuple(step.name for step in path.steps if isinstance(step, expr.Member))).size
        case expr.Unary(_, operand):
            return binary(writer, "-", index(0), evaluate(operand, fields, writer, where), where)
        case expr.Binary(operator, left, right):
            return binary(writer, operator, evaluate(left, fields, writer, where), evaluate(right, fields, writer, where), where)
        case expr.Call("align", (number, quantum)):
            return align(writer, evaluate(number, fields, writer, where), evaluate(quantum, fields, writer, where), where)
        case _:
            raise AssertionError(value)
