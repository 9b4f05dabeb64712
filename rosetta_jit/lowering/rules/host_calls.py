"""What rules ask of the kernel's host, as numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel.ir import HostCall, Local, Told
from rosetta_jit.language import typed
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.images import measured
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Bool, Float, Int

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Expr
    from rosetta_jit.lowering.evaluation import Evaluation


def asked(value: typed.Asked, values: Evaluation) -> Expr:
    """The time or the number of the message, a measure of an image, or what a user's function gives."""
    match value:
        case typed.Told(what):
            return Told(what)
        case typed.ImageCall():
            return measured(value, values)
        case typed.HostCall():
            return _called(value, values)
        case _:
            assert_never(value)


def _called(call: typed.HostCall, values: Evaluation) -> Expr:
    """Where the function refuses, so does the mapping."""
    assert isinstance(call.type, Bool | Int | Float)
    writer = values.writer
    arguments = tuple(values.of(argument) for argument in call.arguments)
    found = Local(scalar_name(scalar_of(call.type)), writer.fresh(call.function))
    failure = writer.failure("rejected", values.where, f"`{call.function}` raised an exception", line=values.line)
    writer.emit(HostCall(call.function, arguments, found, failure))
    return found
