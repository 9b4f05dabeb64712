"""Calls of the host's functions, by numba's calling convention: a status is returned, the result goes through the first argument.

    int32 host.NAME(result *, void **exception, number …, (uint8 *, int64 size) …)

A status that is not 0 says that the function refuses. What the name stands for is linked in later: `backends.entry.link`.
"""

from __future__ import annotations

from llvmlite import ir

from rosetta_jit.backends.llvm.expr import expression, pointer
from rosetta_jit.backends.llvm.frame import Frame
from rosetta_jit.backends.llvm.values import I8, I64, LLVM_TYPES, POINTER, intrinsic
from rosetta_jit.kernel.nodes import HostCall, Scalar
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.kernel.walk import extents_of

I32 = ir.IntType(32)


def symbol(function: str) -> str:
    """The name of a host's function in a module."""
    return f"host.{function}"


def host_called(frame: Frame, call: HostCall) -> tuple[ir.Value, ir.Value]:
    """The status of a call, and where its result is."""
    builder = frame.builder
    types: list[Scalar] = [type_of(argument) for argument in call.arguments]
    parameters = [POINTER, POINTER, *map(_passed, types), *[POINTER, I64] * len(extents_of(call))]
    function = intrinsic(frame.module, symbol(call.function), I32, parameters)
    result = frame.entry.alloca(_passed(call.result.type), name="result")
    exception = frame.entry.alloca(POINTER, name="exception")
    arguments = [expression(frame, argument) for argument in call.arguments]
    passed = [builder.zext(value, I8) if type_ == "bool" else value for value, type_ in zip(arguments, types, strict=True)]
    for extent in extents_of(call):
        passed += [pointer(frame, extent.address), expression(frame, extent.size)]
    return builder.call(function, [result, exception, *passed]), result


def _passed(scalar: Scalar) -> ir.Type:
    """How numba passes a scalar: a bool is a byte."""
    return I8 if scalar == "bool" else LLVM_TYPES[scalar]
