"""The types of LLVM, and the constants, addresses and declared functions, that all printers of its code use."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from llvmlite import ir

from rosetta_jit.kernel.nodes import Scalar

I1, I8, I16, I32, I64 = (ir.IntType(bits) for bits in (1, 8, 16, 32, 64))
F32, F64, POINTER = ir.FloatType(), ir.DoubleType(), ir.PointerType()

LLVM_TYPES: dict[str, ir.Type] = {
    "bool": I1,
    "i8": I8,
    "u8": I8,
    "i16": I16,
    "u16": I16,
    "i32": I32,
    "u32": I32,
    "i64": I64,
    "u64": I64,
    "f32": F32,
    "f64": F64,
}

COLD = (1 << 20, 1)
"""Branch weights where the second edge is taken for a broken message only."""


def forgotten(builder: ir.IRBuilder, number: ir.Value) -> ir.Value:
    """The same integer, of which LLVM knows nothing: an instruction that does nothing, but may do anything for all that it can tell."""
    return builder.asm(ir.FunctionType(number.type, [number.type]), "", "=r,0", [number], side_effect=False)


def is_float(scalar: Scalar) -> bool:
    """Whether a scalar is one of IEEE 754."""
    return scalar in ("f32", "f64")


def is_signed(scalar: Scalar) -> bool:
    """Whether a scalar is a signed integer."""
    return scalar in ("i8", "i16", "i32", "i64")


@lru_cache(maxsize=1024)
def constant(value: int) -> ir.Constant:
    """An int64 constant. One object prints its text once."""
    return ir.Constant(I64, value)


def state_word(builder: ir.IRBuilder, state: ir.Value, word: int | ir.Value) -> ir.Value:
    """The address of a word of the holder's state."""
    number = constant(word) if isinstance(word, int) else word
    return builder.gep(state, [number], inbounds=True, source_etype=I64)


def intrinsic(module: ir.Module, name: str, result: ir.Type, parameters: Sequence[ir.Type]) -> ir.Function:
    """A function of LLVM or of a module, declared once."""
    if name in module.globals:
        return module.globals[name]
    return ir.Function(module, ir.FunctionType(result, parameters), name)
