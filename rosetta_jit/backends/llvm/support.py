"""Functions that kernels call and that are the same for all kernels: declared where they are called, defined once (`definitions`).

`rosetta_is_text(bytes, size)` says whether bytes are UTF-8. The others are about floats in decimal: `rosetta_shortest_f64` and its like
give digits and scale as `kernel.decimals.shortest` does, `rosetta_fixed` the digits to a number of decimals, `rosetta_nearest(bytes, size,
exponent)` the float64 nearest to the digits of a text times a power of ten, and `rosetta_digits` reads what C's `snprintf` has written.
"""

from __future__ import annotations

from llvmlite import ir

from rosetta_jit.backends.llvm.values import F64, I1, I32, I64, POINTER

BOTH = ir.LiteralStructType([I64, I64])

SIGNATURES = {
    "rosetta_is_text": ir.FunctionType(I1, [POINTER, I64]),
    "rosetta_shortest_f64": ir.FunctionType(BOTH, [F64]),
    "rosetta_shortest_f32": ir.FunctionType(BOTH, [F64]),
    "rosetta_fixed": ir.FunctionType(I64, [F64, I32]),
    "rosetta_nearest": ir.FunctionType(F64, [POINTER, I64, I64]),
    "rosetta_digits": ir.FunctionType(BOTH, [POINTER]),
}


def declared(module: ir.Module, name: str) -> ir.Function:
    """One of the functions, declared in the module at the first mention."""
    if name in module.globals:
        return module.globals[name]
    function = ir.Function(module, SIGNATURES[name], name)
    function.attributes.add("nounwind")
    return function
