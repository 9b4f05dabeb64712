"""The proof of a mapping's kernels as text: a paragraph a kernel, a line an obligation under the statement that owes it."""

from __future__ import annotations

from collections import Counter
from itertools import groupby
from typing import TYPE_CHECKING

from rosetta_jit.terminal import columns, printable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.explain.proof import KernelProof, MappingProof, Owed


def as_text(found: MappingProof) -> str:
    """All obligations of a mapping's kernels, and a summary."""
    return "\n\n".join([*("\n".join(_kernel(each, found.mapping)) for each in found.kernels), summary(found)])


def summary(found: MappingProof) -> str:
    """One line: how many kernels and obligations there are, who proved them, and what z3 says; more only where something is wrong."""
    owed = [each for kernel in found.kernels for each in kernel.owed]
    procedures = sum((kernel.procedures() for kernel in found.kernels), Counter[str]())
    parts = [_plural(len(found.kernels), "kernel"), _plural(len(owed), "obligation"), _counted(procedures)]
    verdicts = Counter(each.opinion.verdict for each in owed if each.opinion is not None)
    parts += [f"z3: {_counted(verdicts)}"] if verdicts else []
    verdict = "proved" if found.is_proved else "NOT PROVED"
    lines = [f"{printable(found.mapping)}: {verdict} - {'; '.join(filter(None, parts))}"]
    for kernel in found.kernels:
        lines += [f"  {kernel.purpose}, {kernel.encoding}: {printable(line)}" for line in kernel.refusal.splitlines()]
        lines += [f"  {kernel.purpose}, {kernel.encoding}: {_line(each)}" for each in kernel.owed if not each.is_proved]
    return "\n".join([*lines, *(f"  left out: {reason}" for reason in found.absent)])


def _kernel(kernel: KernelProof, mapping: str) -> Iterator[str]:
    yield f"{printable(mapping)}: {kernel.purpose}, {kernel.encoding}"
    part = ""
    for (where, statement), owed in groupby(kernel.owed, lambda each: (each.part, each.statement)):
        if where != part:
            yield f"  {where}:"
            part = where
        yield f"  {statement or 'at the begin'}"
        rows = [(each.claim, each.path, each.procedure or "NOBODY", _opinion(each)) for each in owed]
        yield from (f"    {line}" for line in columns([(*row, _times(count)) for row, count in Counter(rows).items()]))


def _line(owed: Owed) -> str:
    """An obligation by itself."""
    return "  ".join(filter(None, (owed.statement, owed.claim, owed.path, owed.procedure or "NOBODY", _opinion(owed))))


def _opinion(owed: Owed) -> str:
    if owed.opinion is None:
        return ""
    values = ", ".join(f"{name} = {value}" for name, value in owed.opinion.counterexample)
    return f"z3: {owed.opinion.verdict}{f' by {values}' if values else ''}"


def _times(count: int) -> str:
    return f"x {count}" if count > 1 else ""


def _plural(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _counted(counts: Counter[str]) -> str:
    return ", ".join(f"{count} {what}" for what, count in sorted(counts.items()))
