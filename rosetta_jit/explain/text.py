"""An explanation as text in columns, as wide as the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import zip_longest

from rosetta_jit.diagnostics import render
from rosetta_jit.explain.content import Direction, Explanation, Side
from rosetta_jit.explain.lines import Line
from rosetta_jit.explain.phrases import cost, heading, kind, loss, missing, shown
from rosetta_jit.terminal import cells, columns, cut, padded, wrapped

NARROWEST = 40


def as_text(explanation: Explanation, *, width: int = 100) -> str:
    """Paragraphs: the two types side by side, each direction, the warnings.

    Parameters
    ----------
    width
        Cells of a line; longer ones are cut.
    """
    width = max(width, NARROWEST)
    parts = [shown(explanation.mapping), "\n".join(_sides(explanation.wire, explanation.holder, width))]
    parts += ["\n".join(_direction(each, explanation, width)) for each in explanation.directions]
    parts += [missing(explanation)] if missing(explanation) else []
    parts += [render(each) for each in explanation.warnings]
    return "\n\n".join(parts)


def _sides(wire: Side, holder: Side, width: int) -> Iterator[str]:
    """The fields of both, each side with half of the width."""
    half = (width - 3) // 2
    left, right = (_side(each, half) for each in (wire, holder))
    filled = min(half, max(map(cells, left)))
    for one, other in zip_longest(left, right, fillvalue=""):
        yield f"{padded(one, filled)} │ {other}".rstrip()


def _side(side: Side, width: int) -> list[str]:
    fields = columns([(f"{'  ' * (len(row.names) - 1)}.{shown(row.names[-1])}", kind(row)) for row in side.rows])
    more = ["and more fields"] if side.more else []
    head = [f"{side.side}: {shown(side.type)}" + (f" ({side.framework})" if side.framework else "")]
    return [cut(line, width) for line in [*head, *(f"  {field}" for field in (*fields, *more))]]


def _direction(direction: Direction, explanation: Explanation, width: int) -> Iterator[str]:
    yield cut(heading(direction, explanation), width)
    yield from _rules(direction.lines, width)
    losses = [loss(each) for each in direction.losses]
    yield from _listed("lost", losses or ["nothing"], width)
    if direction.refusals:
        yield from _listed("refused", [shown(each) for each in direction.refusals], width)
    yield from _listed("cost", cost(direction.cost), width)


def _rules(lines: tuple[Line, ...], width: int) -> Iterator[str]:
    """A rule: its number in the file, its block, its text; what is done to values below it where it does not fit beside."""
    heads = columns([(f"  {line.line or ''}", shown(line.file) or line.block) for line in lines])
    room = max(map(cells, heads), default=0)
    for line, head in zip(lines, heads, strict=True):
        before, below = padded(head, room + 2) + "  " * line.depth, " " * (room + 4 + 2 * line.depth)
        notes = "; ".join(shown(note.text) for note in line.notes)
        whole = f"{before}{shown(line.text)}   · {notes}"
        if notes and cells(whole) > width:
            yield from wrapped(shown(line.text), width, first=before, then=below)
            yield from wrapped(notes, width, first=f"{below}· ", then=f"{below}  ")
        else:
            yield from wrapped(whole[len(before) :] if notes else shown(line.text), width, first=before, then=below)


def _listed(name: str, items: list[str], width: int) -> Iterator[str]:
    for number, item in enumerate(items):
        indent = " " * (len(item) - len(item.lstrip()))
        yield from wrapped(item.lstrip(), width, first=f"  {padded('' if number else name, 8)}{indent}", then=f"{' ' * 12}{indent}")
