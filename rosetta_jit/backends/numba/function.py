"""A kernel as a typed numba function, so that users call it inside their own compiled loops.

The function's body is one intrinsic that emits the whole kernel: numba spends milliseconds on every intrinsic call in a function's source.

Examples
--------
Decode many messages of one size in a loop of one's own; ``state`` is the state array of a holder::

    from numba import njit
    from rosetta_jit.backends.numba.function import data_pointer, typed

    kernel = typed(decoder_kernel)

    @njit
    def total(messages, state, values):
        result = 0.0
        for index in range(messages.shape[0]):
            if kernel(data_pointer(messages[index]), 0, messages.shape[1], data_pointer(state), 0) >= 0:
                result += values[0]
        return result
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from numba import njit, types
from numba.extending import intrinsic

from rosetta_jit.backends.llvm import function as llvm
from rosetta_jit.backends.llvm.values import POINTER
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.traits import calls_to_host

if TYPE_CHECKING:
    from llvmlite import ir
    from numba.core.base import BaseContext
    from numba.core.dispatcher import Dispatcher
    from numba.core.typing.templates import Signature
    from numba.extending import Implementation


BYTES, WORDS = types.CPointer(types.uint8), types.CPointer(types.int64)
SIGNATURE = types.int64(BYTES, types.intp, types.intp, WORDS, types.intp)


def typed(kernel: Kernel) -> Dispatcher:
    """The kernel as ``int64(uint8*, intp begin, intp end, int64*, intp row)``.

    It is callable in compiled code only. The caller answers for the pointers: a buffer of at least ``end`` bytes, a holder's state.

    Raises
    ------
    ValueError
        The kernel calls functions of its host, with which only a program links it.
    """
    run = body(kernel)

    def kernel_function(buffer: int, begin: int, end: int, state: int, row: int) -> int:
        return run(buffer, begin, end, state, row)

    decorate = njit(SIGNATURE, error_model="numpy", nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)
    return decorate(kernel_function)


def library(dispatcher: Dispatcher) -> tuple[str, str]:
    """LLVM text that defines the function, and its mangled name there."""
    (compiled,) = dispatcher.overloads.values()
    return compiled.library.get_llvm_str(), compiled.fndesc.mangled_name


@intrinsic
def data_pointer(typing: object, array: types.Array) -> Implementation:  # noqa: ARG001 - numba passes it
    """The address of an array's first element, for a kernel that is called in compiled code."""

    def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
        made = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.bitcast(made.data, context.get_value_type(signature.return_type))

    return (WORDS if array.dtype == types.int64 else BYTES)(array), codegen


def body(kernel: Kernel) -> Callable[..., int]:
    """An intrinsic that emits the kernel into the module of whoever calls it, in one place.

    Raises
    ------
    ValueError
        The kernel calls functions of its host, with which only a program links it.
    """
    if calls_to_host([kernel]):
        raise ValueError("a kernel that calls functions, or compresses images, cannot be called from one's own compiled code")

    @intrinsic
    def emitted(typing: object, buffer: object, begin: object, end: object, state: object, row: object) -> Implementation:  # noqa: ARG001 - numba passes the types
        def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:  # noqa: ARG001 - as above
            function = llvm.emit(builder.module, kernel, "rosetta_kernel")
            function.linkage = "internal"
            buffer, begin, end, state, row = arguments
            return builder.call(function, [builder.bitcast(buffer, POINTER), begin, end, builder.bitcast(state, POINTER), row])

        return SIGNATURE, codegen

    return emitted
