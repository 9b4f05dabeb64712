"""Sequences in compiled code: ``len(poses)``, ``poses[-1]``, ``for pose in poses``."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import TYPE_CHECKING, cast

from numba import types
from numba.core import cgutils
from numba.core.imputils import RefType, impl_ret_new_ref, iternext_impl
from numba.extending import intrinsic, lower_builtin, overload

from rosetta_jit.backends.llvm.values import constant
from rosetta_jit.in_numba.reading import Reader
from rosetta_jit.in_numba.types import IteratorType, SequenceType

if TYPE_CHECKING:
    from llvmlite import ir
    from numba.core.base import BaseContext
    from numba.core.imputils import IternextResult
    from numba.core.typing.templates import Signature
    from numba.extending import Implementation


@intrinsic
def _count(typing: object, sequence: types.Type) -> Implementation:  # noqa: ARG001 - numba passes it
    def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
        return cgutils.create_struct_proxy(signature.args[0])(context, builder, value=arguments[0]).count

    return types.int64(sequence), codegen


@intrinsic
def _element(typing: object, sequence: types.Type, index: types.Type) -> Implementation:  # noqa: ARG001 - as above

    def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
        reader = Reader(context, builder, cast("SequenceType", signature.args[0]), arguments[0])
        count = reader.value.count
        index = arguments[1]
        at = builder.select(builder.icmp_signed("<", index, constant(0)), builder.add(index, count), index)
        reader.refuse_if(builder.icmp_unsigned(">=", at, count), "index out of range", IndexError)
        return _read_element(reader, at)

    return cast("SequenceType", sequence).element(sequence, types.int64), codegen


def _read_element(reader: Reader, at: ir.Value) -> ir.Value:
    assert isinstance(reader.type, SequenceType)
    reader.check_valid()
    return reader.node(reader.type.node.element, reader.builder.add(reader.value.start, at))


# Numba compares the parameters of what says a type and of what it returns, annotations included.


@overload(len)
def _len(sequence: types.Type) -> Callable[..., object] | None:
    def length(sequence: types.Type) -> object:
        return _count(sequence)

    return length if isinstance(sequence, SequenceType) else None


@overload(operator.getitem)
def _getitem(sequence: types.Type, index: types.Type) -> Callable[..., object] | None:
    def element(sequence: types.Type, index: types.Type) -> object:
        return _element(sequence, index)

    return element if isinstance(sequence, SequenceType) and isinstance(index, types.Integer) else None


@lower_builtin("getiter", SequenceType)
def _iterate(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
    made = cgutils.create_struct_proxy(signature.return_type)(context, builder)
    made.index = cgutils.alloca_once_value(builder, constant(0))
    made.sequence = arguments[0]
    context.nrt.incref(builder, signature.args[0], arguments[0])
    return impl_ret_new_ref(context, builder, signature.return_type, made._getvalue())  # noqa: SLF001 - numba's way to its value


@lower_builtin("iternext", IteratorType)
@iternext_impl(RefType.NEW)
def _next(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value], result: IternextResult) -> None:
    type_ = cast("IteratorType", signature.args[0])
    iterator = cgutils.create_struct_proxy(type_)(context, builder, value=arguments[0])
    reader = Reader(context, builder, type_.sequence, iterator.sequence)
    index = builder.load(iterator.index)
    is_more = builder.icmp_signed("<", index, reader.value.count)
    result.set_valid(is_more)
    with builder.if_then(is_more):
        result.yield_(_read_element(reader, index))
        builder.store(builder.add(index, constant(1)), iterator.index)
