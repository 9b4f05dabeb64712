"""A program that makes an object file of modules in LLVM's language.

`any_machine` runs it, because LLVM ends a process in which it cannot go on. Its input are the triple, the processor, the functions that
others call, and the modules, as JSON; its output is the object. Where there is none, the last line of its errors says why.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from typing import cast

from llvmlite import binding

from rosetta_jit.runtime.code.assembler import linked, make_private, run_passes

HIGH_BYTE_FIRST = "E"
"""How the data layout of such machines begins."""
SYSTEMS = frozenset({"none", "linux", "freebsd", "netbsd", "openbsd", "windows", "fuchsia"})
"""What stands second in a triple whose vendor is left out."""
FEATURES = {("riscv64", "linux"): "+m,+a,+f,+d,+c"}
"""What every machine of a kind has by convention, which LLVM leaves to compilers: with floats in registers, as its libraries pass them."""


def main() -> None:
    """From standard input to standard output."""
    triple, cpu, names, modules = cast("tuple[str, str, list[str], list[str]]", json.load(sys.stdin))
    try:
        code = object_of(_with_vendor(triple), cpu, names, modules)
    except (RuntimeError, UnicodeError) as error:
        sys.exit(str(error))
    sys.stdout.buffer.write(code)


def object_of(triple: str, cpu: str, names: Sequence[str], modules: Sequence[str]) -> bytes:
    """The object; the ways in which LLVM says that there is none are RuntimeErrors, and the end of the process."""
    binding.initialize_all_targets()
    binding.initialize_all_asmprinters()
    machine = _machine(binding.Target.from_triple(triple), triple, cpu)
    if str(machine.target_data).startswith(HIGH_BYTE_FIRST):
        raise RuntimeError("its numbers have their high byte first")
    module = linked(modules)
    module.triple, module.data_layout = triple, str(machine.target_data)
    make_private(module, names)
    builder = binding.create_pass_builder(machine, binding.create_pipeline_tuning_options(speed_level=2))
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


if __name__ == "__main__":
    main()
