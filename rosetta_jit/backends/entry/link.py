"""From kernels to object code: compile them with the entries from CPython.

The object exports, beside each kernel as `kernel` (and `size`, of an encoder, and `write`, of a bridge), what the entry's own file defines:

    decode, borrow    call many
    encode            call many sizes
    bridge            call many

A program is made of two modules. *Its own* has the kernels, and, where the first of them is short, the usual call, so that LLVM puts the
kernel into it; a bridge's has all. *The surroundings* have the rest, which is the same for many programs: compiled once a machine, they are
kept in the cache.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, NotRequired, TypedDict, Unpack

from llvmlite import binding, ir

from rosetta_jit.backends.entry.host_table import table_text
from rosetta_jit.backends.entry.references import references_text
from rosetta_jit.backends.llvm import definitions, support
from rosetta_jit.backends.llvm import function as llvm
from rosetta_jit.kernel.entries import HOST, ON_DEMAND, SYMBOLS, EntryName
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.state import ERROR_SITE, USED, lane_word, state_words
from rosetta_jit.kernel.traits import (
    are_straight_and_compute,
    are_vast,
    asks_host,
    calls_to_host,
    has_loops_for_vectors,
    is_large,
    is_moderate,
    is_short,
    is_short_and_straight,
    leaves_something,
    our_functions,
)
from rosetta_jit.runtime.cache.texts import kept
from rosetta_jit.runtime.code.assembler import linked, make_private, object_of, run_few_passes, run_passes, shortened, target_machine
from rosetta_jit.runtime.code.prelink import is_prelinking, prelinked

if TYPE_CHECKING:
    from rosetta_jit.kernel.host import UserFunction

USUAL: dict[EntryName, tuple[str, ...]] = {
    "decode": ("owning.ll", "decode.ll"),
    "borrow": ("borrowing.ll", "decode.ll"),
    "encode": ("usable.ll", "measured.ll", "encode.ll"),
    "bridge": ("bridge.ll",),
}
"""The usual call."""

REST: dict[EntryName, tuple[str, ...]] = {
    "decode": ("any_decode.ll", "unmeasured.ll", "many.ll"),
    "borrow": ("borrowing.ll", "any_borrow.ll", "unmeasured.ll", "many.ll"),
    "encode": ("usable.ll", "measured.ll", "unmeasured.ll", "any_encode.ll", "many.ll", "sizes.ll"),
    "bridge": (),
}
"""Whatever else is called."""

ALONE = ("any_decode.ll",)
"""What is left to call of a decoder whose loop over many messages stands beside its kernel."""

FUNCTIONS = ("kernel", "size", "write")
"""The names of a program's kernels: what decodes or encodes; to encode, what measures; of a bridge, what encodes what was decoded."""

REST_SYMBOL = "any_call"


class Options(TypedDict):
    """What a program is compiled with, besides its kernels.

    ``with_numba`` says whether the first kernel is typed by numba on its way, unless it is large: that optimises it once more; the code
    does the same. ``functions`` are those of the user's that the kernels call; they need numba. ``references`` are, of a bridge, the lanes
    that become the message when it is decoded. ``thorough`` takes the time for LLVM's slow passes, whatever the kernels look like.
    ``opening`` is what messages begin with that are left to another program, which is made on demand (`rosetta_jit.runtime.on_demand`).
    """

    with_numba: bool
    functions: NotRequired[Sequence[UserFunction]]
    references: NotRequired[Sequence[int]]
    thorough: NotRequired[bool]
    opening: NotRequired[bytes | None]


def compile_program(kernels: Sequence[Kernel], entry: EntryName, **options: Unpack[Options]) -> bytes:
    """Code for this machine's CPU, to be loaded by `runtime.code.native`: prelinked, or else an object file.

    ``kernels`` are verified: one, or to encode the encoder and its size kernel; of a bridge, the decoder, the size kernel and the encoder.
    """
    if not is_prelinking():
        return object_file(kernels, entry, **options)
    machine = target_machine(hurried=are_vast(kernels))
    module = _own(kernels, entry, machine, options)
    images = machine.emit_object(module), *_surroundings(module, kernels, entry)
    return prelinked(*images, gives=(*SYMBOLS[entry], HOST, ON_DEMAND)) or object_file(kernels, entry, **options)


def object_file(kernels: Sequence[Kernel], entry: EntryName, **options: Unpack[Options]) -> bytes:
    """The same as one object file, which only a linker can load."""
    machine = target_machine(hurried=are_vast(kernels))
    return machine.emit_object(optimised(kernels, entry, machine, options))


def llvm_text(kernels: Sequence[Kernel], entry: EntryName, **options: Unpack[Options]) -> str:
    """The optimised LLVM module as text."""
    return str(optimised(kernels, entry, target_machine(), options))


def assembly(kernels: Sequence[Kernel], entry: EntryName, **options: Unpack[Options]) -> str:
    """The machine code as assembler text."""
    machine = target_machine(hurried=are_vast(kernels))
    return machine.emit_assembly(optimised(kernels, entry, machine, options))


def optimised(kernels: Sequence[Kernel], entry: EntryName, machine: binding.TargetMachine, options: Options) -> binding.ModuleRef:
    """The whole program in one module, after one run of LLVM's passes."""
    module = linked((*_own_parts(kernels, entry, options, whole=True), *_surrounding_texts(kernels, entry)))
    _optimise(module, kernels, entry, machine, options)
    return module


def _own(kernels: Sequence[Kernel], entry: EntryName, machine: binding.TargetMachine, options: Options) -> binding.ModuleRef:
    """A program's own module, after LLVM's passes: for what unusual messages need, which is much and seldom runs, a few of them do."""
    unusual = ir.Module("unusual") if _has_unusual_apart(kernels, options) else None
    context = binding.create_context()
    module = linked(_own_parts(kernels, entry, options, whole=False, unusual=unusual), context)
    _optimise(module, kernels, entry, machine, options)
    if unusual is not None:
        rest = linked((str(unusual),), context)
        _empty(unusual)
        run_few_passes(rest, machine)
        module.link_in(rest)
        make_private(module, (*SYMBOLS[entry], HOST, ON_DEMAND))
    return module


def _has_unusual_apart(kernels: Sequence[Kernel], options: Options) -> bool:
    """Whether the bodies for unusual messages are optimised for themselves: LLVM's slow passes are for the arithmetic of the usual one."""
    first = kernels[0]
    return len(first.bodies) > 1 and not (first.routines or _is_typed(kernels, options)) and are_straight_and_compute(kernels)


def _is_typed(kernels: Sequence[Kernel], options: Options) -> bool:
    """Whether the first kernel goes through numba."""
    return options["with_numba"] and not is_large(kernels[0]) and not calls_to_host(kernels)


def _optimise(
    module: binding.ModuleRef, kernels: Sequence[Kernel], entry: EntryName, machine: binding.TargetMachine, options: Options
) -> None:
    """Run LLVM's passes once.

    Kernels leave little for LLVM to find, and a few passes find it, in time that is in proportion to the kernel. Those of O3, which take
    five times as long, are for loops over elements that become loops over vectors; those of O1 for such loops in large kernels and, with
    vectors made of statements that stand side by side, for arithmetic without loops. docs/performance.md has the figures.
    """
    make_private(module, (*SYMBOLS[entry], HOST, ON_DEMAND))
    wants_thorough = bool(options.get("functions") or options.get("thorough"))
    loops = [kernel for kernel in kernels if has_loops_for_vectors(kernel)]
    is_straight = are_straight_and_compute(kernels)
    is_vast = are_vast(kernels)
    if is_vast or not (wants_thorough or loops or is_straight):
        # Of protobuf's TestAllTypesProto3, to combine costs the encoder 0.3 s, of branches and of instructions.
        # A call of it is a twentieth quicker with fewer branches, and 1.5 % with fewer instructions.
        run_few_passes(module, machine, combining=not (is_vast and entry == "encode"))
        return
    thorough = wants_thorough or any(map(is_moderate, loops))
    tuning = binding.create_pipeline_tuning_options(speed_level=3 if thorough else 1)
    tuning.loop_vectorization, tuning.slp_vectorization = True, thorough or is_straight
    builder = binding.create_pass_builder(machine, tuning)
    run_passes(builder.getModulePassManager(), module, builder)


# --- parts ---------------------------------------------------------------------------------------------------------------


def _own_parts(
    kernels: Sequence[Kernel], entry: EntryName, options: Options, *, whole: bool, unusual: ir.Module | None = None
) -> Iterator[str]:
    """The modules that a program's own is linked from, as LLVM text; if it is to be ``whole``, they define what they call of `support`.

    What is for unusual messages goes into a module of its own, if one is given.
    """
    opening = options.get("opening")
    has_usual = _has_usual(kernels, entry, options)
    if _is_typed(kernels, options):
        yield from _typed(kernels[0])
    else:
        yield _emitted(kernels[0], FUNCTIONS[0], whole=whole, has_usual=has_usual, unusual=unusual)
    yield from (_emitted(kernel, name, whole=whole) for kernel, name in zip(kernels[1:], FUNCTIONS[1:], strict=False))
    if opening is not None:
        yield _going_on(kernels[0], opening)
    for function in options.get("functions", ()):
        from rosetta_jit.backends.numba.user_functions import compile_function

        yield str(compile_function(function))
    if our_functions(kernels):
        yield table_text(kernels)
    if entry == "bridge":
        yield references_text(options.get("references", ()))
    if _is_inside(kernels, entry):
        yield _usual(_entry_text((*USUAL[entry], "first_body.ll" if has_usual else "all_bodies.ll"), kernels), SYMBOLS[entry])
    if _has_own_many(kernels, entry):
        yield from _own_many(kernels[0], whole=whole)


def _surrounding_texts(kernels: Sequence[Kernel], entry: EntryName) -> tuple[str, ...]:
    """The modules that a program's surroundings are linked from."""
    rest = ALONE if _has_own_many(kernels, entry) else REST[entry]
    if entry == "encode" and leaves_something(kernels[1]):
        rest = tuple("leaving.ll" if each == "unmeasured.ll" else each for each in rest)
    around = (rest,) if _is_inside(kernels, entry) else ((*USUAL[entry], "all_bodies.ll"), rest)
    return tuple(_entry_text(templates, kernels) for templates in around if templates)


def _is_inside(kernels: Sequence[Kernel], entry: EntryName) -> bool:
    """Whether the usual call is compiled with the kernels, of which those that are short become a part of it."""
    return entry == "bridge" or is_short_and_straight(kernels[0])


def _has_usual(kernels: Sequence[Kernel], entry: EntryName, options: Options) -> bool:
    """Whether of the kernel the first of several bodies alone becomes a part of the usual call."""
    kernel = kernels[0]
    several = len(kernel.bodies) > 1 and not kernel.hidden and is_short_and_straight(kernel)
    return entry in ("decode", "borrow") and several and not (calls_to_host(kernels) or _is_typed(kernels, options))


def _has_own_many(kernels: Sequence[Kernel], entry: EntryName) -> bool:
    """Whether the loop over many messages is compiled with the kernel, whose usual body becomes a part of it.

    That is so where messages depend on those before them: what one keeps, the next one must not wait for.
    """
    kernel = kernels[0]
    return entry == "decode" and kernel.registers > 0 and is_short(kernel) and not calls_to_host(kernels)


def _own_many(kernel: Kernel, *, whole: bool) -> Iterator[str]:
    """The loop over many messages, and the kernel's usual body for it."""
    module = ir.Module("first")
    llvm.emit(module, replace(kernel, bodies=kernel.bodies[:1], goes_on=False), "first", whole=whole).attributes.add("alwaysinline")
    yield str(module)
    words, count = state_words(kernel.lanes), kernel.registers
    used = [_copied_word(lane_word(lane, USED)) for lane in range(kernel.lanes)]
    sizes = {"words": words, "count": count, "state_bytes": 8 * words, "register_bytes": 8 * count}
    yield Template(_template("many_kept.ll")).substitute(sizes, used="\n".join(used))


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


def _surroundings(module: binding.ModuleRef, kernels: Sequence[Kernel], entry: EntryName) -> Iterator[bytes]:
    """The object files of what stands around a program's own module."""
    around = _surrounding_texts(kernels, entry)
    if around:
        yield _entries(*around)
    wanted = {each.name for each in module.functions if each.is_declaration} & set(support.SIGNATURES)
    yield from map(_support, sorted(wanted))


@cache
def _entries(*texts: str) -> bytes:
    return kept("entries", "\n".join(texts), lambda: object_of(texts, (*SYMBOLS["encode"], REST_SYMBOL), thorough=False))


@cache
def _support(name: str) -> bytes:
    return kept("support", name, lambda: object_of([definitions.text((name,))], (name,)))


def _emitted(kernel: Kernel, name: str, *, whole: bool, has_usual: bool = False, unusual: ir.Module | None = None) -> str:
    module = ir.Module(name)
    llvm.emit(module, kernel, name, whole=whole, has_usual=has_usual, unusual=unusual)
    text = str(module)
    _empty(module)
    return text


def _empty(module: ir.Module) -> None:
    """Let go of a module's instructions, which refer to one another: LLVM needs the memory before the next search for garbage."""
    for function in module.functions:
        for block in function.blocks:
            block.instructions.clear()
            block.terminator = None
        function.blocks.clear()


def _going_on(kernel: Kernel, opening: bytes) -> str:
    """What a kernel calls where it has failed and another program may not."""
    name = f"{FUNCTIONS[0]}.inside" if kernel.hidden else FUNCTIONS[0]
    words = {"name": f"{name}.next", "size": len(opening), "bits": 8 * len(opening), "opening": int.from_bytes(opening, sys.byteorder)}
    return Template(_template("on_demand.ll")).substitute(words, site=ERROR_SITE, sites=len(kernel.sites))


def _typed(kernel: Kernel) -> tuple[str, str]:
    """The library of the typed function, and `kernel` as an adapter to numba's calling convention."""
    from rosetta_jit.backends.numba.function import library, typed

    text, name = library(typed(kernel))
    return text, _template("numba.ll").replace("@typed", f'@"{name}"')


def _entry_text(templates: Sequence[str], kernels: Sequence[Kernel]) -> str:
    """A module of an entry's functions. `#0` to `#2` are the attributes of the calls of kernels that are to be quick."""
    stamps = "time_and_number.ll" if asks_host(kernels) else "no_time_or_number.ll"
    hosted = "hosted.ll" if calls_to_host(kernels) else "unhosted.ll"
    count = max(kernel.registers for kernel in kernels)
    kept = _template("registers.ll").replace("COUNT", str(count)) if count else _template("no_registers.ll")
    joined = "joined.ll" if any(kernel.kept for kernel in kernels) else "alone.ll"
    shared = ("shared.ll", stamps, hosted, joined, _thread_template(), "thread_check.ll", _large_template())
    texts = (*map(_template, shared), kept, *map(_template, templates))
    inline = ("alwaysinline" if is_short_and_straight(kernel) else "" for kernel in kernels)
    attributes = (f"attributes #{number} = {{ nounwind {each} }}" for number, each in enumerate(inline))
    return "\n".join((*texts, *attributes))


def _thread_template() -> str:
    """What says which thread calls: what the system's own function would do, where that is known."""
    return "thread_linux_x86_64.ll" if sys.platform == "linux" and os.uname().machine == "x86_64" else "thread.ll"


def _large_template() -> str:
    """How memory for large messages is asked for."""
    return "large_linux.ll" if sys.platform == "linux" else "large.ll"


@cache
def _template(file: str) -> str:
    return Path(__file__).with_name(file).read_text("utf-8")
