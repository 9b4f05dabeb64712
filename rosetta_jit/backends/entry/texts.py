"""The entries' LLVM texts: which of the files beside this one a program's calls are put together from.

Three parts stand around a program's kernels. The *usual call* has the common case. The *next call* goes on with a message that the first
body of a kernel has left, where that alone is a part of the usual call. The *rest* is whatever else is called: with a holder that is given,
with other objects than bytes, for many messages. The last two may be left out, and made together when one of them is first asked for
(`rosetta_jit.runtime.rest`): they need no more of a program than where its kernels are, and what a header of the cache can hold.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

from rosetta_jit.kernel.entries import EntryName
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.backends.entry.program import Program

NEW_BYTES = "new_bytes.ll"
"""What an entry that writes messages has besides."""

USUAL: dict[EntryName, tuple[str, ...]] = {
    "decode": ("owning.ll", "finish.ll", "decode.ll"),
    "borrow": ("borrowing.ll", "finish.ll", "decode.ll"),
    "encode": ("usable.ll", "measured.ll", NEW_BYTES, "encode.ll"),
    "bridge": (NEW_BYTES, "bridge.ll"),
}

NEXT: dict[EntryName, tuple[str, ...]] = {
    "decode": ("owning.ll", "finish.ll", "arguments.ll", "next_body.ll"),
    "borrow": ("borrowing.ll", "finish.ll", "arguments.ll", "next_body.ll"),
}

REST: dict[EntryName, tuple[str, ...]] = {
    "decode": ("any_decode.ll", "unmeasured.ll", "many.ll"),
    "borrow": ("borrowing.ll", "any_borrow.ll", "unmeasured.ll", "many.ll"),
    "encode": ("usable.ll", "measured.ll", "unmeasured.ll", "any_encode.ll", "many.ll", "sizes.ll"),
    "bridge": (),
}

ALONE = ("any_decode.ll",)
"""The rest of a decoder whose loop over many messages stands beside its kernel."""


@dataclass(frozen=True, slots=True)
class EntryText:
    """A module of an entry's functions.

    Attributes
    ----------
    files
        Of which it is put together.
    registers
        How many values kernels keep for the next message.
    inline
        Of each kernel, whether calls of it that are to be quick become its body: the functions' attributes ``#0`` to ``#2``. The rest has
        no such calls.
    """

    files: tuple[str, ...]
    registers: int
    inline: tuple[bool, ...]

    @classmethod
    def of(cls, files: Sequence[str], program: Program, *, is_quick: bool = True) -> EntryText:
        """The module of some files, with what they share, for a program."""
        shared = (
            "shared.ll",
            "time_and_number.ll" if program.asks_host else "no_time_or_number.ll",
            "hosted.ll" if program.calls_host else "unhosted.ll",
            "joined.ll" if any(kernel.kept for kernel in program.kernels) else "alone.ll",
            _thread_file(),
            "thread_check.ll",
        )
        large = (_large_file(),) if NEW_BYTES in files else ()
        count = max(kernel.registers for kernel in program.kernels)
        kept = "registers.ll" if count else "no_registers.ll"
        return cls((*shared, *large, kept, *files), count, program.are_short if is_quick else ())

    @classmethod
    def of_plain(cls, plain: Mapping[str, Any]) -> EntryText:
        """From what `plain` gave."""
        return cls(tuple(plain["files"]), plain["registers"], tuple(plain["inline"]))

    @property
    def plain(self) -> dict[str, Any]:
        """The same as JSON holds it."""
        return {"files": self.files, "registers": self.registers, "inline": self.inline}

    @property
    def alone(self) -> str:
        """The module as code of its own, which the cache keeps by its text."""
        return f"; By itself.\n{self.text}"

    @property
    def text(self) -> str:
        """The module."""
        attributes = (f"attributes #{number} = {{ nounwind {'alwaysinline' * each} }}" for number, each in enumerate(self.inline))
        return "\n".join((*map(template, self.files), *attributes)).replace("COUNT", str(self.registers))


def usual_text(program: Program) -> EntryText:
    """The module of the usual call."""
    arguments = "arguments.ll" if program.is_inside else "arguments_left.ll"
    body = "first_body.ll" if program.has_usual else "all_bodies.ll"
    return EntryText.of((*USUAL[program.entry], *_found_rest(program), arguments, *_found_next(program), body), program)


def next_text(program: Program) -> EntryText | None:
    """The module of the next call, where the program has one."""
    return EntryText.of(NEXT[program.entry], program) if program.has_usual else None


def rest_text(program: Program) -> EntryText | None:
    """The module of the rest, where the program has one; of one that leaves it out, with the next call."""
    files = ALONE if program.has_own_many else REST[program.entry]
    if program.leaves_something:
        files = tuple("leaving.ll" if each == "unmeasured.ll" else each for each in files)
    if program.leaves_next:
        files = tuple(dict.fromkeys((*NEXT[program.entry], *files)))
    return EntryText.of(files, program, is_quick=False) if files else None


def _found_rest(program: Program) -> tuple[str, ...]:
    """How the usual call finds the rest."""
    if not REST[program.entry]:
        return ()
    return ("rest_later.ll",) if program.leaves_rest else ("rest_linked.ll",)


def _found_next(program: Program) -> tuple[str, ...]:
    """How the usual call finds the next one."""
    if not program.has_usual:
        return ()
    return ("next_later.ll",) if program.leaves_next else ("next_linked.ll",)


def _thread_file() -> str:
    """What says which thread calls: what the system's own function would do, where that is known."""
    return "thread_linux_x86_64.ll" if sys.platform == "linux" and os.uname().machine == "x86_64" else "thread.ll"


def _large_file() -> str:
    """How memory for large messages is asked for."""
    return "large_linux.ll" if sys.platform == "linux" else "large.ll"


@cache
def template(file: str) -> str:
    """The text of a file beside this one."""
    with open(os.path.join(os.path.dirname(__file__), file), encoding="utf-8") as text:
        return text.read()
