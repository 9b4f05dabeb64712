"""A decoder's kernel as a function for compiled code: ``kernel(message, holder)``, or with the place of one message among many."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.core.errors import TypingError
from numba.extending import intrinsic

from rosetta_jit.backends.llvm.values import I64, constant, state_word
from rosetta_jit.backends.numba.function import BYTES, WORDS, body
from rosetta_jit.in_numba import assigning, boxing, maps, sequences
from rosetta_jit.in_numba.c_call import call_c
from rosetta_jit.in_numba.ownership import BrokenMessage, Program, entries
from rosetta_jit.in_numba.reading import Reader
from rosetta_jit.in_numba.types import MessageType
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.state import CLEAN, VALID
from rosetta_jit.kernel.traits import is_short
from rosetta_jit.runtime.holder.classes import HolderFamily

if TYPE_CHECKING:
    from numba.core.base import BaseContext
    from numba.core.dispatcher import Dispatcher
    from numba.core.typing.templates import Signature
    from numba.extending import Implementation


REGISTERED = (assigning, boxing, maps, sequences)
"""Modules that tell numba of holders when they are imported."""

OUTSIDE = "begin and end of the message fall, or leave the buffer"


def callable_kernel(kernel: Kernel, family: HolderFamily, program: Program) -> Dispatcher:
    """A kernel as ``kernel(message, holder, begin=0, end=None)`` for compiled code, of which a short one becomes a part.

    Raises
    ------
    ValueError
        As `rosetta_jit.backends.numba.function.typed`.
    """
    run = body(kernel)
    begin_filling, mend = _begin_filling(family, program), _mend(program)

    def decode(message: Any, holder: Any, begin: int = 0, end: int | None = None) -> None:
        size = size_of(message)
        first, last = np.int64(begin), size if end is None else np.int64(end)
        if first < 0 or first > last or last > size:
            raise ValueError(OUTSIDE)
        state = begin_filling(holder)
        while True:  # the kernel is called in one place, so that it becomes a part of this function
            result = run(data_of(message), first, last, state, 0)
            if result >= 0:
                break
            if not mend(holder, result, first, last):
                raise BrokenMessage
        filled(holder)

    return njit(nogil=True, error_model="numpy", forceinline=is_short(kernel))(decode)


@intrinsic
def data_of(typing: object, message: types.Type) -> Implementation:  # noqa: ARG001 - numba passes it
    """Where the bytes of a message lie, which lie one after another."""
    _check_buffer(message)

    def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
        made = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.bitcast(made.data, context.get_value_type(signature.return_type))

    return BYTES(message), codegen


@intrinsic
def size_of(typing: object, message: types.Type) -> Implementation:  # noqa: ARG001 - as above
    """How many bytes a message has."""
    _check_buffer(message)

    def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
        return context.make_array(signature.args[0])(context, builder, arguments[0]).nitems

    return types.int64(message), codegen


def _check_buffer(message: types.Type) -> None:
    if not (
        isinstance(message, types.Buffer) and message.dtype in (types.uint8, types.int8) and message.ndim == 1 and message.layout == "C"
    ):
        raise TypingError(f"a message is bytes, or a contiguous array of uint8 in one dimension, not {message}")


@intrinsic
def filled(typing: object, holder: types.Type) -> Implementation:  # noqa: ARG001 - as above
    """Let a holder be read again."""

    def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
        _set_valid(Reader(context, builder, cast("MessageType", signature.args[0]), arguments[0]), CLEAN)
        return context.get_dummy_value()

    return types.void(holder), codegen


def _set_valid(reader: Reader, value: int) -> None:
    reader.builder.store(constant(value), state_word(reader.builder, reader.state, VALID), align=8)


def _begin_filling(family: HolderFamily, program: Program) -> Callable[..., Any]:
    """What comes before a message: the state of the holder, which nobody may read until it is filled."""

    @intrinsic
    def begin_filling(typing: object, holder: types.Type) -> Implementation:  # noqa: ARG001 - as above
        if not (isinstance(holder, MessageType) and holder.is_whole and holder.family is family):
            raise TypingError(f"this kernel fills holders of `{family.struct.name}`, as `decoder.new()` makes them, not {holder}")

        def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
            reader = Reader(context, builder, cast("MessageType", signature.args[0]), arguments[0])
            _set_valid(reader, 0)
            if program.tell is not None:
                call_c(context, builder, entries(program)[0], ir.VoidType(), [reader.value.taken])
            return reader.value.state

        return WORDS(holder), codegen

    return begin_filling


def _mend(program: Program) -> Callable[..., Any]:
    """What is done where a kernel fails: whether there is room now."""

    @intrinsic
    def mend(typing: object, holder: types.Type, result: types.Type, begin: types.Type, end: types.Type) -> Implementation:  # noqa: ARG001 - as above
        def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
            reader = Reader(context, builder, cast("MessageType", signature.args[0]), arguments[0])
            return call_c(context, builder, entries(program)[1], I64, [reader.value.taken, *arguments[1:]])

        return types.int64(holder, types.int64, types.int64, types.int64), codegen

    return mend
