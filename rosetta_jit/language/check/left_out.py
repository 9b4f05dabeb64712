"""What a mapping leaves out without saying so: fields that no rule reads, and optional ones that no rule sets."""

from __future__ import annotations

from collections.abc import Mapping

from rosetta_jit.catalogue import check as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.places import shown_names
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Rule
from rosetta_jit.language.untouched import unread, unset
from rosetta_jit.model.expr import Side
from rosetta_jit.source import Span


def left_out(
    rules: tuple[Rule, ...],
    source: Message,
    target: Message,
    spans: tuple[Span | None, Span | None],
    where: tuple[Side, words.Block],
    wires: Mapping[str, Span | None],
) -> list[Diagnostic]:
    """Warnings about one direction; ``spans`` are where the types of source and target are named, ``wires`` those of several wires.

    ``where`` is the side of the target, and the block in which what is missing is to be written.
    """
    side, block = where
    other = "holder" if side == "wire" else "wire"

    def place(of: Side, names: tuple[str, ...], span: Span | None) -> Span | None:
        return wires.get(names[0], span) if of == "wire" else span

    return [
        *(words.never_read(place(other, names, spans[0]), other, shown_names(names, source), block) for names in unread(rules, source)),
        *(words.left_out(place(side, names, spans[1]), side, shown_names(names, target), block) for names in unset(rules, target)),
    ]
