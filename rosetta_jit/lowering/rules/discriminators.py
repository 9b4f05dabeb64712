"""Discriminators of unions while rules run: the case that a value selects."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Assign, Const, Expr, Switch
from rosetta_jit.kernel.terms import index
from rosetta_jit.lowering.writer import integer
from rosetta_jit.model.initial_values import selected

if TYPE_CHECKING:
    from rosetta_jit.lowering.writer import Writer
    from rosetta_jit.model.types import Union


def chosen_case(union: Union, value: Expr, writer: Writer) -> Expr:
    """The number of the case that a value selects."""
    if isinstance(value, Const):
        return index(selected(union, int(value.value)))
    found = writer.var("case", index(0 if union.default is None else union.default + 1))
    numbers = ((label, number) for number, labels in enumerate(union.labels, 1) for label in labels)
    cases = tuple((label, (Assign(found.name, index(number)),)) for label, number in numbers)
    writer.emit(Switch(writer.let("label", integer(value)), cases, ()))
    return found
