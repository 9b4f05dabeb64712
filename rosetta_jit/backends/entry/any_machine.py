"""Kernels as an object file for any machine that LLVM knows: nothing of CPython, nothing of this process.

Each kernel is a function ``int64 NAME(uint8 *buffer, int64 begin, int64 end, int64 *state, int64 row)``; the state's words are those of
`kernel.state`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from llvmlite import binding, ir

from rosetta_jit.backends.llvm import function as llvm
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.runtime.code.assembler import linked, make_private, run_passes

HIGH_BYTE_FIRST = "E"
"""How the data layout of such machines begins."""


SYSTEMS = frozenset({"none", "linux", "freebsd", "netbsd", "openbsd", "windows", "fuchsia"})
"""What stands second in a triple whose vendor is left out."""
FEATURES = {("riscv64", "linux"): "+m,+a,+f,+d,+c"}
"""What every machine of a kind has by convention, which LLVM leaves to compilers: with floats in registers, as its libraries pass them."""


class TargetError(ValueError):
    """A machine that objects cannot be made for; says why."""


def object_for(kernels: Mapping[str, Kernel], triple: str, cpu: str = "") -> bytes:
    """The object file that defines kernels by name.

    Parameters
    ----------
    kernels
        Verified kernels that call no functions of the host.
    triple
        The machine as LLVM names it: ``thumbv7em-none-eabihf``.
    cpu
        One that it has, as ``cortex-m7``; any of the kind by default.

    Raises
    ------
    TargetError
        LLVM knows no such machine, or the kernels do not run on it.
    """
    binding.initialize_all_targets()
    binding.initialize_all_asmprinters()
    triple = _with_vendor(triple)
    try:
        target = binding.Target.from_triple(triple)
    except RuntimeError as error:
        raise TargetError(str(error)) from error
    machine = _machine(target, triple, cpu)
    if str(machine.target_data).startswith(HIGH_BYTE_FIRST):
        raise TargetError("its numbers have their high byte first")
    module = linked(_emitted(kernel, name) for name, kernel in kernels.items())
    module.triple, module.data_layout = triple, str(machine.target_data)
    make_private(module, tuple(kernels))
    options = binding.create_pipeline_tuning_options(speed_level=2)
    builder = binding.create_pass_builder(machine, options)
    run_passes(builder.getModulePassManager(), module, builder)
    return machine.emit_object(module)


def _with_vendor(triple: str) -> str:
    """A triple as LLVM reads it, which would take `linux` in ``armv7-linux-gnueabihf`` for the vendor, and pass floats otherwise."""
    arch, *others = triple.split("-")
    return "-".join([arch, "unknown", *others]) if others and others[0] in SYSTEMS else triple


def _machine(target: binding.Target, triple: str, cpu: str) -> binding.TargetMachine:
    """Code of one machine, which may lie anywhere in memory where an operating system loads it."""
    arch, _, system = (*triple.split("-"), "", "")[:3]
    is_bare = system == "none"
    relocation, model = ("static", "default") if is_bare else ("pic", "small")
    return target.create_target_machine(cpu=cpu, features=FEATURES.get((arch, system), ""), opt=3, reloc=relocation, codemodel=model)


def _emitted(kernel: Kernel, name: str) -> str:
    """Not every machine has the calling convention of the attempts behind the first, and none is this one, of which loops' widths are."""
    module = ir.Module(name)
    llvm.emit(module, kernel, name)
    return re.sub(r"preserve_mostcc |, !llvm\.loop !\d+", "", str(module))
