"""LLVM's compiler, for text and modules of ours: it needs llvmlite alone, and is imported where something must be compiled."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache

from llvmlite import binding
from llvmlite.binding.newpassmanagers import NewPassManager

from rosetta_jit.runtime.code.parts import part_of
from rosetta_jit.runtime.code.prelink import prelinked


def target_machine(*, hurried: bool = False) -> binding.TargetMachine:
    """The machine that we run on, with all that its CPU can do.

    ``hurried`` is for vast kernels: code of twice the size, in a tenth of the time.
    """
    return _machine(0 if hurried else 3)


@cache
def _machine(level: int) -> binding.TargetMachine:
    """One for each level of LLVM's code generator: to make one takes a millisecond. LLVM works for one thread of a process at a time."""
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    binding.initialize_native_asmparser()
    features = binding.get_host_cpu_features().flatten()
    target = binding.Target.from_default_triple()
    return target.create_target_machine(cpu=binding.get_host_cpu_name(), features=features, opt=level, reloc="pic", codemodel="small")


def linked(parts: Iterable[str], context: binding.ContextRef | None = None) -> binding.ModuleRef:
    """One module in a context of its own: what LLVM makes for a module, types and constants above all, it keeps as long as the context.

    Modules that are to be linked later have a ``context`` in common.
    """
    context = context or binding.create_context()
    first, *others = (binding.parse_assembly(part, context) for part in parts)
    for module in others:
        first.link_in(module)
    return first


def make_private(module: binding.ModuleRef, exported: Sequence[str]) -> None:
    """Let a module define nothing for others but some symbols."""
    for defined in (*module.functions, *module.global_variables):
        if not defined.is_declaration and defined.name not in exported:
            defined.linkage = "internal"


def run_passes(passes: binding.ModulePassManager, module: binding.ModuleRef, builder: binding.PassBuilder) -> None:
    """Run passes, and free them: llvmlite 0.50 does not, because its class inherits from another one first that frees nothing."""
    passes.run(module, builder)
    NewPassManager._dispose(passes)  # noqa: SLF001 - see above
    passes.detach()


def run_few_passes(module: binding.ModuleRef, machine: binding.TargetMachine, *, combining: bool = True) -> None:
    """Run the passes without which code is poor, all of which take time in proportion to it.

    Without ``combining``, instructions and branches stay as they are printed; only variables become registers.
    """
    few = binding.create_new_module_pass_manager()
    few.add_always_inliner_pass()
    few.add_sroa_pass()
    if combining:
        few.add_instruction_combine_pass()
        few.add_simplify_cfg_pass()
    run_passes(few, module, binding.create_pass_builder(machine, binding.create_pipeline_tuning_options(speed_level=0)))


def assembled(text: str, exported: Sequence[str], *, hurried: bool = False) -> bytes:
    """Code of a module that a person wrote, for `runtime.code.native`: it says itself what is inlined, and needs few passes.

    Of the module it has what is ``exported``, and what that needs.

    ``hurried`` is for what is called once or twice: nothing is inlined.
    """
    machine, module = target_machine(hurried=hurried), linked([part_of(text, exported)])
    make_private(module, exported)
    if not hurried:
        run_few_passes(module, machine)
    image = machine.emit_object(module)
    return prelinked(image) or image


def object_of(texts: Iterable[str], exported: Sequence[str], *, thorough: bool = True) -> bytes:
    """Code of modules that many programs use, as an object file: optimised as far as LLVM can, unless a person wrote it as it should be."""
    machine, module = target_machine(), linked(texts)
    make_private(module, exported)
    if not thorough:
        run_few_passes(module, machine)
        return machine.emit_object(module)
    builder = binding.create_pass_builder(machine, binding.create_pipeline_tuning_options(speed_level=3))
    run_passes(builder.getModulePassManager(), module, builder)
    return machine.emit_object(module)


def shortened(text: str, exported: Sequence[str]) -> str:
    """A module that a person wrote, with all private but what is exported, after a few passes as text."""
    machine, module = target_machine(), linked([part_of(text, exported)])
    run_few_passes(module, machine)
    return str(module)
