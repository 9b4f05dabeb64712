"""What a program keeps from one message to the next, as its header says it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.traits import calls_to_host, registers_read
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language.parameters.state import Declared
    from rosetta_jit.lowering.rules import state
else:
    state = Late("rosetta_jit.lowering.rules.state")


def kept_of(kernels: Sequence[Kernel], declared: Mapping[str, Declared | None]) -> dict[str, Any]:
    """Each state variable that the mappings of a program declare, in the order of the registers; `runtime.registers.Kept` reads it.

    Variables are named as their mapping names them, behind the key of the mapping: `decode.` and `encode.` where a program has two.
    """
    variables = [
        [f"{key}{name}", each.types[name], state.word_of(value, each.types[name])]
        for key, each in declared.items()
        if each is not None
        for name, value in each.initial.items()
    ]
    sizes = any(registers_read(kernel) for kernel in kernels if kernel.direction == "size")
    return {"variables": variables, "sizes": sizes, "is_shared": bool(variables and calls_to_host(kernels))}
