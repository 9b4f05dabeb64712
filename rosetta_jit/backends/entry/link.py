"""From kernels to object code: compile them with the entries from CPython.

The object exports, beside each kernel as `kernel` (and `size`, of an encoder, and `write`, of a bridge), what the entry's own file defines:

    decode, borrow    call many
    encode            call many sizes
    bridge            call many

A program is made of two modules. *Its own* has the kernels, and, where the first of them is short, the usual call, so that LLVM puts the
kernel into it; a bridge's has all. *The surroundings* have the other calls (`entry.texts`), which are the same for many programs: compiled
once a machine, they are kept in the cache. So are functions that kernels share: those of `llvm.support`, and common routines
(`llvm.routines`). The rest of the calls may be left out, and compiled by itself when it is asked for.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from functools import cache, lru_cache
from string import Template
from typing import TYPE_CHECKING, Unpack

from llvmlite import binding, ir

from rosetta_jit.backends.entry.program import Options, Program
from rosetta_jit.backends.entry.texts import next_text, rest_text, template, usual_text
from rosetta_jit.backends.llvm import definitions, support
from rosetta_jit.backends.llvm import function as llvm
from rosetta_jit.backends.llvm.printing import taken_parts, taken_text
from rosetta_jit.backends.llvm.routines import common_routine
from rosetta_jit.kernel.entries import ANY_CALL, LATER, NEXT_CALL, REST, SYMBOLS, EntryName
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.state import ERROR_SITE, USED, lane_word, state_words
from rosetta_jit.kernel.traits import has_loops_for_vectors, is_moderate, our_functions
from rosetta_jit.runtime.cache.texts import kept
from rosetta_jit.runtime.code.assembler import linked, make_private, object_of, run_few_passes, run_passes, shortened, target_machine
from rosetta_jit.runtime.code.parts import part_of
from rosetta_jit.runtime.code.prelink import is_prelinking, prelinked
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.backends.entry import host_table, references
else:
    host_table, references = late("rosetta_jit.backends.entry", "host_table", "references")

FUNCTIONS = ("kernel", "size", "write")
"""The names of a program's kernels: what decodes or encodes; to encode, what measures; of a bridge, what encodes what was decoded."""

MAX_SHARED = 128
"""Object files of shared functions that a process remembers."""


def compile_program(kernels: Sequence[Kernel], entry: EntryName, **options: Unpack[Options]) -> bytes:
    """Code for this machine's CPU, to be loaded by `runtime.code.native`: prelinked, or else an object file.

    ``kernels`` are verified: one, or to encode the encoder and its size kernel; of a bridge, the decoder, the size kernel and the encoder.
    """
    if is_prelinking():
        program = Program(kernels, entry, options)
        images, declared = _own_images(program)
        code = prelinked(*images, *_surroundings(declared, program), gives=program.exported)
        if code is not None:
            return code
    return object_file(kernels, entry, **options)


def object_file(kernels: Sequence[Kernel], entry: EntryName, **options: Unpack[Options]) -> bytes:
    """The same as one object file, which only a linker can load; it has the rest."""
    module, machine = _whole(kernels, entry, options)
    return machine.emit_object(module)


def llvm_text(kernels: Sequence[Kernel], entry: EntryName, **options: Unpack[Options]) -> str:
    """The optimised LLVM module as text."""
    module, _ = _whole(kernels, entry, options)
    return str(module)


def assembly(kernels: Sequence[Kernel], entry: EntryName, **options: Unpack[Options]) -> str:
    """The machine code as assembler text."""
    module, machine = _whole(kernels, entry, options)
    return machine.emit_assembly(module)


def compile_rest(text: str) -> bytes:
    """Code of the rest of programs, from its text: prelinked, it wants their kernels."""
    exported = (ANY_CALL, NEXT_CALL, *LATER)

    def compiled() -> bytes:
        image = prelinked(object_of([part_of(text, exported)], exported, thorough=False))
        assert image is not None, "a program leaves it only where code is prelinked"
        return image

    return kept("rest", text, compiled)


def _whole(kernels: Sequence[Kernel], entry: EntryName, options: Options) -> tuple[binding.ModuleRef, binding.TargetMachine]:
    """A program in one module, after one run of LLVM's passes, and what makes code of it."""
    program = Program(kernels, entry, {**options, "leaves_rest": False})
    return _optimised(program, (*_own_parts(program, whole=True), *_surrounding_texts(program)))


def _own_images(program: Program) -> tuple[list[bytes], set[str]]:
    """The object files of a program's own modules, and the functions that they want others to define.

    The modules of a vast program become code one after another, so that LLVM holds but one of them.
    """
    texts = list(_own_parts(program, whole=False))
    if not program.is_vast:
        module, machine = _optimised(program, texts)
        return [machine.emit_object(module)], _declared(module)
    images, declared, hurried = list[bytes](), set[str](), _is_hurried(program, texts)
    machine = target_machine(hurried=hurried)
    while texts:
        module = linked([texts.pop(0)])
        _optimise(module, program, machine, hurried=hurried)
        images.append(machine.emit_object(module))
        declared |= _declared(module)
        del module
    return images, declared


def _declared(module: binding.ModuleRef) -> set[str]:
    return {each.name for each in module.functions if each.is_declaration}


def _optimised(program: Program, parts: Iterable[str]) -> tuple[binding.ModuleRef, binding.TargetMachine]:
    """Parts of a program as one module, after LLVM's passes, and what makes code of it."""
    texts = tuple(parts)
    hurried = _is_hurried(program, texts)
    module, machine = linked(texts), target_machine(hurried=hurried)
    make_private(module, program.exported)
    _optimise(module, program, machine, hurried=hurried)
    return module, machine


def _is_hurried(program: Program, texts: Iterable[str]) -> bool:
    """Whether code is made in a hurry of a program whose own modules have some texts."""
    return program.would_take_long(sum(text.count("\n") for text in texts))


def _optimise(module: binding.ModuleRef, program: Program, machine: binding.TargetMachine, *, hurried: bool) -> None:
    """Run LLVM's passes once.

    Kernels leave little for LLVM to find, and a few passes find it, in time that is in proportion to the kernel. Those of O3, which take
    five times as long, are for loops over elements that become loops over vectors; those of O1 for such loops in large kernels. Vectors of
    statements that stand side by side are printed as such (`llvm.vectors`). docs/performance.md has the figures.
    """
    wants_thorough = bool(program.options.get("functions") or program.options.get("thorough"))
    loops = [kernel for kernel in program.kernels if has_loops_for_vectors(kernel)]
    if program.is_vast or not (wants_thorough or loops):
        # Of protobuf's TestAllTypesProto3, whose code is made in a hurry, to combine costs the decoder 0.2 s and 4.5 MB, the encoder 0.3 s.
        # A call of the decoder is no quicker, one of the encoder a twentieth with fewer branches, and 1.5 % with fewer instructions.
        run_few_passes(module, machine, combining=not (program.is_vast and (hurried or program.entry == "encode")))
        return
    thorough = wants_thorough or any(map(is_moderate, loops))
    tuning = binding.create_pipeline_tuning_options(speed_level=3 if thorough else 1)
    tuning.loop_vectorization, tuning.slp_vectorization = True, thorough
    builder = binding.create_pass_builder(machine, tuning)
    run_passes(builder.getModulePassManager(), module, builder)


# --- parts ---------------------------------------------------------------------------------------------------------------


def _own_parts(program: Program, *, whole: bool) -> Iterator[str]:
    """The modules that a program's own is linked from, as LLVM text; if it is to be ``whole``, they define what they call of `support`."""
    kernels, options = program.kernels, program.options
    opening = options.get("opening")
    if program.is_typed:
        yield from _typed(program.first)
    else:
        yield from _emitted(program, 0, whole=whole)
    for number in range(1, len(kernels)):
        yield from _emitted(program, number, whole=whole)
    if opening is not None:
        yield _going_on(program.first, opening)
    for function in options.get("functions", ()):
        from rosetta_jit.backends.numba.user_functions import compile_function

        yield str(compile_function(function))
    if program.calls_host and our_functions(kernels):
        yield host_table.table_text(kernels)
    if program.entry == "bridge":
        yield references.references_text(options.get("references", ()))
    if program.is_inside:
        yield _usual(usual_text(program).text, program.symbols)
    if program.has_own_many:
        yield from _own_many(program.first, whole=whole)


def _surrounding_texts(program: Program) -> tuple[str, ...]:
    """The modules that a program's surroundings are linked from."""
    usual = None if program.is_inside else usual_text(program)
    following = None if program.leaves_next else next_text(program)
    rest = None if program.leaves_rest else rest_text(program)
    return tuple(each.text for each in (usual, following, rest) if each is not None)


def _own_many(kernel: Kernel, *, whole: bool) -> Iterator[str]:
    """The loop over many messages, and the kernel's usual body for it."""
    module = ir.Module("first")
    llvm.emit(module, replace(kernel, bodies=kernel.bodies[:1], goes_on=False), "first", whole=whole).attributes.add("alwaysinline")
    yield str(module)
    words, count = state_words(kernel.lanes), kernel.registers
    used = [_copied_word(lane_word(lane, USED)) for lane in range(kernel.lanes)]
    sizes = {"words": words, "count": count, "state_bytes": 8 * words, "register_bytes": 8 * count}
    yield Template(template("many_kept.ll")).substitute(sizes, used="\n".join(used))


def _copied_word(word: int) -> str:
    """Lines that copy a word from one state to another, in `many_kept.ll`."""
    at = f"getelementptr i64, ptr {{}}, i64 {word}"
    return f"""\
  %from.{word} = {at.format("%from.state")}
  %value.{word} = load i64, ptr %from.{word}
  %to.{word} = {at.format("%state")}
  store i64 %value.{word}, ptr %to.{word}"""


@cache
def _usual(text: str, exported: tuple[str, ...]) -> str:
    """The module of the usual call with nothing left to do in it but to put kernels there."""
    return kept("call", text, lambda: shortened(text, exported).encode()).decode()


def _surroundings(declared: set[str], program: Program) -> Iterator[bytes]:
    """The object files of what stands around a program's own modules, which have declared some functions."""
    around = _surrounding_texts(program)
    if around:
        yield _entries(*around)
    yield from map(_shared, sorted(_wanted(declared)))


def _wanted(declared: Iterable[str]) -> set[str]:
    """The functions that programs share, among those that a module declares, and those that they call themselves."""
    wanted, waiting = set[str](), [*declared]
    while waiting:
        name = waiting.pop()
        routine = common_routine(name)
        if name not in wanted and (routine is not None or name in support.SIGNATURES):
            wanted.add(name)
            waiting += () if routine is None else routine.declares
    return wanted


@cache
def _entries(*texts: str) -> bytes:
    exported = (*SYMBOLS["encode"], ANY_CALL, NEXT_CALL, REST)
    return kept("entries", "\n".join(texts), lambda: object_of([part_of(text, exported) for text in texts], exported, thorough=False))


@lru_cache(maxsize=MAX_SHARED)
def _shared(name: str) -> bytes:
    """The object file of a function that programs share."""
    routine = common_routine(name)
    if routine is not None:
        return kept("routine", routine.text, lambda: object_of([routine.text], (name,), thorough=False))
    return kept("support", name, lambda: object_of([definitions.text((name,))], (name,)))


def _emitted(program: Program, number: int, *, whole: bool) -> Iterator[str]:
    """One of a program's kernels, of a vast program in parts."""
    module = ir.Module(FUNCTIONS[number])
    llvm.emit(module, program.kernels[number], FUNCTIONS[number], whole=whole, has_usual=number == 0 and program.has_usual)
    if whole or not program.is_vast:
        yield taken_text(module)
    else:
        yield from taken_parts(module)


def _going_on(kernel: Kernel, opening: bytes) -> str:
    """What a kernel calls where it has failed and another program may not."""
    name = f"{FUNCTIONS[0]}.inside" if kernel.hidden else FUNCTIONS[0]
    words = {"name": f"{name}.next", "size": len(opening), "bits": 8 * len(opening), "opening": int.from_bytes(opening, sys.byteorder)}
    return Template(template("on_demand.ll")).substitute(words, site=ERROR_SITE, sites=len(kernel.sites))


def _typed(kernel: Kernel) -> tuple[str, str]:
    """The library of the typed function, and `kernel` as an adapter to numba's calling convention."""
    from rosetta_jit.backends.numba.function import library, typed

    text, name = library(typed(kernel))
    return text, template("numba.ll").replace("@typed", f'@"{name}"')
