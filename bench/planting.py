"""A loop planted in all compiled code: how the benchmarks themselves are tested. What they do not tell from such code, they do not watch.

`make bench-planted` measures with it, and `python -m bench.planting RUN.json` says for each family of rows by how much its worst ratio grew
against the runs that the repository keeps, of those that have a target. It ends with 1 where a family would not fail `make bench-check`.

`plant()` changes what this process compiles from then on: each kernel, each body of its loops, each accessor of holders and each generated
Python function begins with a loop of `ROUNDS` rounds that does nothing. Only for x86-64: LLVM would take away a loop that it understands.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from llvmlite import binding, ir

from bench import baseline
from bench.compare import Change, changes, together
from bench.report.markdown import table
from bench.run import RunError, read
from rosetta_jit.backends.llvm import function as llvm
from rosetta_jit.generate import build
from rosetta_jit.runtime.code import assembler

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable, Sequence

ROUNDS = 20

ASSEMBLER = rf"movl $${ROUNDS}, %ecx\0A1: imull $$3, %eax, %eax\0Adecl %ecx\0Ajnz 1b\0Alfence"
LOOP = f'call void asm sideeffect "{ASSEMBLER}", "~{{eax}},~{{ecx}},~{{flags}}"()'
"""In LLVM's text; a processor takes three cycles a round, as for any arithmetic on what was computed just before, and some for the fence.

Without that nothing waits for the loop: a processor runs it beside what follows, and an Imu takes no longer to decode.
"""

DEFINED = re.compile(r'^define [^@\n]*@"?([\w.$]+)"?\([^\n]*\n?\{\n(?:[\w.$-]+:[^\n]*\n)?', re.MULTILINE)
"""The head of a function in LLVM's text, up to its first instruction."""

BODIES = re.compile(r"entry|(each|round)(\.\d+)?")
"""Names of a kernel's blocks: its first one, and those that its loops begin with."""

PYTHON = re.compile(r"^( *)def \w+\((?:[^()]|\([^()]*\))*\)[^\n]*:\n", re.MULTILINE)


WITHOUT_CALLS = frozenset({"start", "compile", "memory", "classes", "large_logs"})
"""Families in which no call of code that is planted shows: what a process pays before its first one, what is held, generated C++, and logs
whose messages are megabytes.
"""


def plant() -> None:
    """Plant the loop from now on, with a cache of its own. Call it before anything is compiled or imports what generates code."""
    os.environ["ROSETTA_JIT_CACHE_DIR"] = tempfile.mkdtemp(prefix="planted-")
    binding.initialize_native_asmparser()
    # None of these is an interface: the benchmarks change the program under them as nobody else does.
    emit: Callable[..., ir.Function] = llvm.emit

    def emit_planted(module: Any, *asked: Any, **options: Any) -> ir.Function:
        before = set(module.functions)
        function = emit(module, *asked, **options)
        for each in set(module.functions) - before:
            in_blocks(each.blocks)
        return function

    def generated_planted(*asked: Any, **options: Any) -> dict[str, str]:
        return {name: in_source(name, text) for name, text in generated(*asked, **options).items()}

    llvm.emit = emit_planted
    assembled: Callable[..., bytes] = assembler.assembled

    def assembled_planted(text: str, exported: Sequence[str], **options: Any) -> bytes:
        return assembled(in_functions(text, exported), exported, **options)

    assembler.assembled = assembled_planted
    generated: Callable[..., dict[str, str]] = build.generated
    build.generated = generated_planted


def in_blocks(blocks: Iterable[ir.Block]) -> None:
    """Plant the loop in the blocks of a kernel, behind what LLVM wants to stand first."""
    for block in blocks:
        if BODIES.fullmatch(block.name):
            behind = sum(" = phi " in str(each) for each in block.instructions)
            block.instructions.insert(behind, LOOP)


def in_functions(text: str, names: Container[str]) -> str:
    """LLVM's text with the loop in some functions."""
    return DEFINED.sub(lambda head: f"{head[0]}  {LOOP}\n" if head[1] in names else head[0], text)


def in_source(name: str, text: str) -> str:
    """Generated text with the loop in each function, if it is Python."""
    if not name.endswith(".py"):
        return text
    return PYTHON.sub(lambda head: f"{head[0]}{head[1]}    for _ in range({ROUNDS}): pass\n", text)


def families(found: Iterable[Change]) -> dict[str, Change]:
    """Of each family that measures calls: the ratio that grew most, where one is a regression the most of these."""
    worst: dict[str, Change] = {}
    for each in sorted(found, key=lambda each: (each.is_regression, each.factor)):
        if each.new.family not in WITHOUT_CALLS and each.new.at_most is not None:
            worst[each.new.family] = each
    return worst


def main(given: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="bench.planting", description="Which families of rows tell that a loop was planted in all code.")
    parser.add_argument("run", type=Path, help="the JSON of a run with --planted")
    asked = parser.parse_args(given)
    try:
        before = together([read(path).report.rows for path in baseline.kept()])
        worst = families(changes(before, read(asked.run).report.rows))
    except RunError as error:
        print(f"bench.planting: {error}", file=sys.stderr)
        return 2
    lines = (
        (family, each.new.what, f"{100 * (each.factor - 1):+.0f} %", "told" if each.is_regression else "**not told**")
        for family, each in worst.items()
    )
    print(table(("family", "row", "change", f"a loop of {ROUNDS} rounds is"), lines), end="")
    return int(not worst or not all(each.is_regression for each in worst.values()))


if __name__ == "__main__":
    sys.exit(main())
