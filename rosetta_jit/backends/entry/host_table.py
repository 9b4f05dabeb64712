"""Functions of the host that are found at run time: each reads its address from a table that whoever loads the code fills in.

@host = dso_local global [n x ptr]        in the order of `kernel.traits.our_functions`
"""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.backends.llvm.host import symbol
from rosetta_jit.kernel.entries import HOST
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.traits import calls_to_host, our_functions
from rosetta_jit.kernel.walk import extents_of

FUNCTION = """
define i32 @"{name}"(ptr %result, ptr %exception{parameters}) {{
  %slot = getelementptr ptr, ptr @{table}, i64 {number}
  %function = load ptr, ptr %slot
  %answer = call i32 %function(ptr %result{parameters})
  %refused = icmp ne i32 %answer, 1
  %status = zext i1 %refused to i32
  ret i32 %status
}}
"""
"""One that is found in the table. What is there gives 1 where it has a result."""


def table_text(kernels: Sequence[Kernel]) -> str:
    """An LLVM module with the table, and the functions that look into it."""
    names = our_functions(kernels)
    shapes = {call.function: (len(call.arguments), len(extents_of(call))) for call in calls_to_host(kernels)}
    functions = [
        FUNCTION.format(name=symbol(name), table=HOST, number=number, parameters=_parameters(*shapes[name]))
        for number, name in enumerate(names)
    ]
    return f"@{HOST} = dso_local global [{len(names)} x ptr] zeroinitializer\n{''.join(functions)}"


def _parameters(numbers: int, extents: int) -> str:
    arguments = [f"i64 %number{number}" for number in range(numbers)]
    for extent in range(extents):
        arguments += [f"ptr %bytes{extent}", f"i64 %size{extent}"]
    return "".join(f", {each}" for each in arguments)
