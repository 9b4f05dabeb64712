"""What a program keeps from one message to the next, as its header says it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rosetta_jit.kernel.shape import calls_to_host, registers_read
from rosetta_jit.lowering.rules.state import word_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rosetta_jit.kernel.ir import Kernel
    from rosetta_jit.language.parameters.state import Declared


def kept_of(kernels: Sequence[Kernel], *declared: Declared) -> dict[str, Any]:
    """Each state variable that the mappings of a program declare, in the order of the registers; `runtime.registers.Kept` reads it."""
    variables = [[name, each.types[name], word_of(value, each.types[name])] for each in declared for name, value in each.initial.items()]
    sizes = any(registers_read(kernel) for kernel in kernels if kernel.direction == "size")
    return {"variables": variables, "sizes": sizes, "is_shared": bool(variables and calls_to_host(kernels))}
