"""Holders as arguments of compiled functions: taken when the function is called, given back when it returns, whatever happens in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from llvmlite import ir
from numba.core import cgutils
from numba.core.errors import NumbaTypeError
from numba.extending import NativeValue, box, typeof_impl, unbox

from rosetta_jit.in_numba.ownership import give_back, take
from rosetta_jit.in_numba.types import MessageType
from rosetta_jit.runtime.holder import Holder
from rosetta_jit.runtime.holder.message import View

if TYPE_CHECKING:
    from numba.core.pythonapi import BoxContext, UnboxContext


@typeof_impl.register(Holder)
def _type_of_holder(holder: Holder, context: object) -> MessageType:  # noqa: ARG001 - numba passes it
    if isinstance(holder, View):
        raise NumbaTypeError("a message inside another cannot be handed to compiled code: hand over the holder that it lies in")
    return MessageType(holder.family_, holder.family_.tree.root)


@unbox(MessageType)
def _unbox(type_: MessageType, holder: ir.Value, context: UnboxContext) -> NativeValue:
    python, builder = context.pyapi, context.builder
    made = cgutils.create_struct_proxy(type_)(context.context, builder)
    is_error = cgutils.alloca_once_value(builder, cgutils.true_bit)
    taken = _call(context, take, holder)
    slot = cgutils.alloca_once_value(builder, taken)
    with builder.if_then(cgutils.is_not_null(builder, taken)):
        made.taken = builder.bitcast(taken, cgutils.voidptr_t)
        made.state = builder.inttoptr(_word(context, taken, "address"), made.state.type)
        made.row = ir.Constant(ir.IntType(64), 0)
        made.meminfo = builder.bitcast(
            python.nrt_meminfo_new_from_pyobject(ir.Constant(cgutils.voidptr_t, None), made.taken), made.meminfo.type
        )
        builder.store(cgutils.false_bit, is_error)

    def cleanup() -> None:
        with python.err_push(keep_new=True):
            mine = builder.load(slot)
            python.decref(_call(context, give_back, mine))
            python.decref(mine)

    return NativeValue(made._getvalue(), is_error=builder.load(is_error), cleanup=cleanup)  # noqa: SLF001 - numba's way to its value


def _call(context: UnboxContext, function: object, argument: ir.Value) -> ir.Value:
    """Call a Python function of ours."""
    python = context.pyapi
    callee = python.unserialize(python.serialize_object(function))
    result = python.call_function_objargs(callee, (argument,))
    python.decref(callee)
    return result


def _word(context: UnboxContext, taken: ir.Value, name: str) -> ir.Value:
    """An attribute that is a number."""
    python = context.pyapi
    attribute = python.object_getattr_string(taken, name)
    word = python.long_as_longlong(attribute)
    python.decref(attribute)
    return word


@box(MessageType)
def _box(type_: MessageType, value: ir.Value, context: BoxContext) -> ir.Value:
    if not type_.is_whole:
        raise NumbaTypeError("a message inside another cannot leave compiled code: return the holder that it lies in, or values")
    python, builder = context.pyapi, context.builder
    made = cgutils.create_struct_proxy(type_)(context.context, builder, value=value)
    holder = python.object_getattr_string(builder.bitcast(made.taken, python.pyobj), "holder")
    context.context.nrt.decref(builder, type_, value)
    return holder
