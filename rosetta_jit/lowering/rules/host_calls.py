"""Calls of functions that whoever makes a program gives."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Expr, HostCall, Local
from rosetta_jit.language import typed
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Bool, Float, Int


def called(call: typed.HostCall, values: Evaluation) -> Expr:
    """The result of a call of a user's function; if that raises an exception, the mapping rejects the message."""
    assert isinstance(call.type, Bool | Int | Float)
    writer = values.writer
    arguments = tuple(values.of(argument) for argument in call.arguments)
    found = Local(scalar_name(scalar_of(call.type)), writer.fresh(call.function))
    failure = writer.failure("rejected", values.where, f"`{call.function}` raised an exception", line=values.line)
    writer.emit(HostCall(call.function, arguments, found, failure))
    return found
