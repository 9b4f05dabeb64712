"""Whether compilers may make one operation of a product and a sum, which rounds once where the library rounds twice."""

from __future__ import annotations

from collections.abc import Iterable

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.kernel.walk import parts_of, statements

TWO_ROUNDINGS = """\
/* A product and a sum are rounded one after the other, whatever the machine has and the compiler is told. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && (defined(__FP_FAST_FMA) || defined(__FP_FAST_FMAF))
#pragma GCC optimize("fp-contract=off")
#endif
"""
"""Before all includes: gcc does not put functions into others that are compiled otherwise."""


def two_roundings(kernels: Iterable[Kernel]) -> str:
    """What stands at the head of a file in C or C++, if its kernels have products and sums of floats."""
    blocks = [block for kernel in kernels for block in (*kernel.bodies, *(routine.body for routine in kernel.routines))]
    parts = parts_of(stmt for block in blocks for stmt, _ in statements(block))
    ops = {part.op for part in parts if isinstance(part, nodes.Binary) and type_of(part) in ("f32", "f64")}
    return TWO_ROUNDINGS if "mul" in ops and ops & {"add", "sub"} else ""
