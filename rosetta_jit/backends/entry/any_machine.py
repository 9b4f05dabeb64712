"""Kernels as an object file for any machine that LLVM knows: nothing of CPython, nothing of this process.

Each kernel is a function ``int64 NAME(uint8 *buffer, int64 begin, int64 end, int64 *state, int64 row)``; the state's words are those of
`kernel.state`.
"""

from __future__ import annotations

from collections.abc import Mapping

from llvmlite import binding, ir

from rosetta_jit.backends.llvm import function as llvm
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.runtime.code.assembler import linked, make_private, run_passes

HIGH_BYTE_FIRST = "E"
"""How the data layout of such machines begins."""


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
    try:
        target = binding.Target.from_triple(triple)
    except RuntimeError as error:
        raise TargetError(str(error)) from error
    relocation = "static" if "-none" in triple else "pic"
    machine = target.create_target_machine(cpu=cpu, opt=3, reloc=relocation, codemodel="small" if relocation == "pic" else "default")
    if str(machine.target_data).startswith(HIGH_BYTE_FIRST):
        raise TargetError("its numbers have their high byte first")
    module = linked(_emitted(kernel, name) for name, kernel in kernels.items())
    module.triple, module.data_layout = triple, str(machine.target_data)
    make_private(module, tuple(kernels))
    options = binding.create_pipeline_tuning_options(speed_level=2)
    builder = binding.create_pass_builder(machine, options)
    run_passes(builder.getModulePassManager(), module, builder)
    return machine.emit_object(module)


def _emitted(kernel: Kernel, name: str) -> str:
    """Not every machine has the calling convention of the attempts behind the first."""
    module = ir.Module(name)
    llvm.emit(module, kernel, name)
    return str(module).replace("preserve_mostcc ", "")
