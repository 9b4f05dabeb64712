"""From kernels to object code: link them with the entries from CPython, optimise once, emit.

The object exports, beside each kernel as `kernel` (and `size`, of an encoder, and `write`, of a bridge), what the entry's own file defines:

    decode, borrow    call many
    encode            call many sizes
    bridge            call many
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from llvmlite import binding, ir

from rosetta_jit.backends.entry.host_table import TABLE, table_text
from rosetta_jit.backends.entry.references import references_text
from rosetta_jit.backends.llvm import function as llvm
from rosetta_jit.kernel.entries import SYMBOLS
from rosetta_jit.kernel.shape import (
    are_straight,
    are_vast,
    calls_to_host,
    have_short_counted_loops,
    is_large,
    is_short_and_straight,
    is_told,
    our_functions,
)
from rosetta_jit.runtime.code.assembler import linked, make_private, run_few_passes, run_passes, target_machine
from rosetta_jit.runtime.code.prelink import prelinked

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rosetta_jit.kernel.entries import EntryName
    from rosetta_jit.kernel.host import UserFunction
    from rosetta_jit.kernel.ir import Kernel

TEMPLATES: dict[EntryName, tuple[str, ...]] = {
    "decode": ("objects.ll", "decode.ll", "many.ll"),
    "borrow": ("objects.ll", "borrow.ll", "many.ll"),
    "encode": ("objects.ll", "encode.ll", "many.ll"),
    "bridge": ("objects.ll", "bridge.ll"),
}
FUNCTIONS = ("kernel", "size", "write")
"""The names of a program's kernels: what decodes or encodes; to encode, what measures; of a bridge, what encodes what was decoded."""


def compile_program(
    kernels: Sequence[Kernel],
    entry: EntryName,
    *,
    with_numba: bool,
    functions: Sequence[UserFunction] = (),
    references: Sequence[int] = (),
) -> bytes:
    """Code for this machine's CPU, to be loaded by `runtime.code.native`: prelinked, or else an object file.

    Parameters
    ----------
    kernels
        Verified kernels: one, or to encode the encoder and its size kernel; of a bridge, the decoder, the size kernel and the encoder.
    with_numba
        Whether the first kernel is typed by numba on its way, unless it is large: that optimises it once more. The code does the same.
    functions
        Those of the user's that the kernels call; they need numba.
    references
        Of a bridge, the lanes that become the message when it is decoded.
    """
    image = object_file(kernels, entry, with_numba=with_numba, functions=functions, references=references)
    return prelinked(image) or image


def object_file(
    kernels: Sequence[Kernel],
    entry: EntryName,
    *,
    with_numba: bool,
    functions: Sequence[UserFunction] = (),
    references: Sequence[int] = (),
) -> bytes:
    """The same as an object file, which only a linker can load."""
    machine = target_machine(hurried=are_vast(kernels))
    return machine.emit_object(optimised(kernels, entry, machine, with_numba=with_numba, functions=functions, references=references))


def llvm_text(
    kernels: Sequence[Kernel],
    entry: EntryName,
    *,
    with_numba: bool,
    functions: Sequence[UserFunction] = (),
    references: Sequence[int] = (),
) -> str:
    """The optimised LLVM module as text."""
    return str(optimised(kernels, entry, target_machine(), with_numba=with_numba, functions=functions, references=references))


def assembly(
    kernels: Sequence[Kernel],
    entry: EntryName,
    *,
    with_numba: bool,
    functions: Sequence[UserFunction] = (),
    references: Sequence[int] = (),
) -> str:
    """The machine code as assembler text."""
    machine = target_machine(hurried=are_vast(kernels))
    return machine.emit_assembly(optimised(kernels, entry, machine, with_numba=with_numba, functions=functions, references=references))


def optimised(
    kernels: Sequence[Kernel],
    entry: EntryName,
    machine: binding.TargetMachine,
    *,
    with_numba: bool,
    functions: Sequence[UserFunction] = (),
    references: Sequence[int] = (),
) -> binding.ModuleRef:
    """The program's module after one run of LLVM's passes.

    Kernels leave little for LLVM to find, and the passes of O1 find it. Those of O3, which take twice as long, are for loops over elements;
    making vectors of statements that stand side by side, which looks at all values of loops in one another, for kernels without loops. Vast
    kernels get the few passes that take time in proportion to their size. docs/performance.md has the figures.
    """
    parts = _parts(kernels, entry, with_numba=with_numba, functions=functions)
    module = linked([*parts, references_text(references)] if entry == "bridge" else parts)
    make_private(module, (*SYMBOLS[entry], TABLE))
    if are_vast(kernels):
        run_few_passes(module, machine)
        return module
    apart = [[each] for each in kernels] if entry == "bridge" else [kernels]
    thorough = bool(functions) or any(map(have_short_counted_loops, apart))
    options = binding.create_pipeline_tuning_options(speed_level=3 if thorough else 1)
    options.loop_vectorization, options.slp_vectorization = True, thorough or are_straight(kernels)
    builder = binding.create_pass_builder(machine, options)
    run_passes(builder.getModulePassManager(), module, builder)
    return module


def _parts(kernels: Sequence[Kernel], entry: EntryName, *, with_numba: bool, functions: Sequence[UserFunction]) -> Iterator[str]:
    """The modules that a program is linked from, as LLVM text."""
    if with_numba and not is_large(kernels[0]) and not calls_to_host(kernels):
        yield from _typed(kernels[0])
    else:
        yield _emitted(kernels[0], FUNCTIONS[0])
    yield from (_emitted(kernel, name) for kernel, name in zip(kernels[1:], FUNCTIONS[1:], strict=False))
    for function in functions:
        from rosetta_jit.backends.numba.user_functions import compile_function

        yield str(compile_function(function))
    if our_functions(kernels):
        yield table_text(kernels)
    yield _entries(kernels, entry)


def _emitted(kernel: Kernel, name: str) -> str:
    module = ir.Module(name)
    llvm.emit(module, kernel, name)
    return str(module)


def _typed(kernel: Kernel) -> tuple[str, str]:
    """The library of the typed function, and `kernel` as an adapter to numba's calling convention."""
    from rosetta_jit.backends.numba.function import library, typed

    text, name = library(typed(kernel))
    return text, _template("numba.ll").replace("@typed", f'@"{name}"')


def _entries(kernels: Sequence[Kernel], entry: EntryName) -> str:
    """The entry's functions. `#0` are the attributes of the call that is to be quick, `#1` and `#2` those of a bridge's other kernels."""
    told = "told.ll" if is_told(kernels) else "untold.ll"
    hosted = "hosted.ll" if calls_to_host(kernels) else "unhosted.ll"
    templates = (*TEMPLATES[entry], told, hosted, _thread_template())
    inline = ("alwaysinline" if is_short_and_straight(kernel) else "" for kernel in kernels)
    attributes = (f"attributes #{number} = {{ nounwind {each} }}" for number, each in enumerate(inline))
    return "\n".join((*map(_template, templates), *attributes))


def _thread_template() -> str:
    """What says which thread calls: what the system's own function would do, where that is known."""
    return "thread_linux_x86_64.ll" if sys.platform == "linux" and os.uname().machine == "x86_64" else "thread.ll"


def _template(file: str) -> str:
    return Path(__file__).with_name(file).read_text("utf-8")
