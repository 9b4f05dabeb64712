"""The integer that a relation packs a float as: the nearest one, if the relation unpacks it to the same float again."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Convert, Expr, Unary
from rosetta_jit.language import typed
from rosetta_jit.language.conversions import describe
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.model.layout import scalar_of


def nearest(value: typed.Nearest, values: Evaluation) -> Expr:
    """The integer, of the type of its field; what no integer of that type unpacks to is refused."""
    writer, target = values.writer, scalar_name(scalar_of(value.type))
    whole = writer.let("whole", Unary("rint", values.of(value.operand)))
    values.in_range(whole, target)
    made = writer.let("nearest", Convert(target, whole))
    inner = values.with_local(value.variable.name, made, afresh=True)
    writer.expect(inner.of(value.check), "range", values.where, f"no {describe(value.type)} unpacks to the value", line=values.line)
    return made
