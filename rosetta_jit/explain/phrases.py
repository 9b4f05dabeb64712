"""The words in which an explanation is told, the same as text and as a page."""

from __future__ import annotations

from rosetta_jit.explain.content import Direction, Explanation, KernelCost, Loss
from rosetta_jit.explain.cost import Cost
from rosetta_jit.explain.limits import MAX_LOOPS, MAX_TEXT
from rosetta_jit.explain.rows import Row
from rosetta_jit.terminal import printable


def shown(text: str) -> str:
    """A text that somebody wrote, as it is safe to show."""
    return printable(text if len(text) <= MAX_TEXT else f"{text[:MAX_TEXT]}…")


def heading(direction: Direction, explanation: Explanation) -> str:
    """Which way a direction goes."""
    source, target = explanation.wire, explanation.holder
    if direction.name == "pack":
        source, target = target, source
    return f"{direction.name}: {shown(source.type)} → {shown(target.type)}"


def missing(explanation: Explanation) -> str:
    """That a mapping has one direction alone; empty where it has both."""
    names = {"unpack", "pack"} - {each.name for each in explanation.directions}
    return "" if not names else f"one-way: there are no rules to {' or '.join(sorted(names))}"


def kind(row: Row) -> str:
    """A field's type and what else is known of it."""
    unit = [] if row.unit is None else [f"in {row.unit}"]
    return shown(", ".join([row.type, *unit, *row.notes]))


def loss(each: Loss) -> str:
    """What is lost, and whether the mapping says so."""
    return shown(f"{each.what}: {each.why}") + ("" if each.meant else " (nothing says that it is meant)")


def cost(found: KernelCost | str) -> list[str]:
    """What a kernel does, a line for the message and one for each loop."""
    if not isinstance(found, KernelCost):
        return [f"there is no kernel: {shown(found)}"]
    more = f"; the first of {found.attempts} forms that it tries" if found.attempts > 1 else ""
    lines = [f"{_counted(found.cost)} ({found.encoding}{more})", *_repeated(found.cost, 1)]
    return lines if len(lines) <= MAX_LOOPS else [*lines[:MAX_LOOPS], f"and {len(lines) - MAX_LOOPS} more loops"]


def _repeated(found: Cost, depth: int) -> list[str]:
    lines: list[str] = []
    for each in found.repeated:
        lines.append(f"{'  ' * depth}per {shown(each.count)}: {_counted(each.cost)}")
        lines += _repeated(each.cost, depth + 1)
    return lines


def _counted(found: Cost) -> str:
    parts = [
        ("reads", found.read, "byte"),
        ("writes", found.written, "byte"),
        ("", found.operations, "operation"),
        ("", found.checks, "check"),
    ]
    counts = [f"{verb} {number} {noun}{'' if number == 1 else 's'}".strip() for verb, number, noun in parts if number]
    return ", ".join(counts) or "nothing else"
