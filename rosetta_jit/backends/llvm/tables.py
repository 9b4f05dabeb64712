"""Numbers that code looks up: constants of its module."""

from __future__ import annotations

from collections.abc import Sequence

from llvmlite import ir

from rosetta_jit.backends.llvm.values import I64
from rosetta_jit.startup.sha import sha256


def table(module: ir.Module, numbers: Sequence[int]) -> ir.Value:
    """Integers of 64 bits, one behind the other; equal tables are one."""
    name = f"rosetta_table_{sha256(repr(numbers).encode()).hexdigest()[:16]}"
    found = module.globals.get(name)
    if found is None:
        array = ir.ArrayType(I64, len(numbers))
        found = ir.GlobalVariable(module, array, name)
        found.linkage, found.global_constant, found.initializer = "internal", True, ir.Constant(array, list(map(signed, numbers)))
    return found


def signed(number: int) -> int:
    """An integer of 64 bits, with or without a sign, as one with a sign."""
    return (number + 2**63) % 2**64 - 2**63
