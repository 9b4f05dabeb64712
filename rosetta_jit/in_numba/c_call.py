"""Calls from compiled code into C functions of this process: what ctypes makes of Python's among them."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, cast

from llvmlite import ir

from rosetta_jit.backends.llvm.values import POINTER

if TYPE_CHECKING:
    from numba.core.base import BaseContext


def call_c(context: BaseContext, builder: ir.IRBuilder, function: Any, result: ir.Type, arguments: list[ir.Value]) -> ir.Value:
    """Call a C function, which must live as long as the process."""
    address = cast("int", ctypes.cast(function, ctypes.c_void_p).value)
    pointer = context.add_dynamic_addr(builder, address, info="a kernel's")
    values = [builder.bitcast(each, POINTER) if isinstance(each.type, ir.PointerType) else each for each in arguments]
    function_type = ir.FunctionType(result, [each.type for each in values])
    return builder.call(builder.bitcast(pointer, function_type.as_pointer()), values)
