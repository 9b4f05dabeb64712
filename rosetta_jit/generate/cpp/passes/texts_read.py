"""Texts of a decoder in the header, whose bytes are checked where they are set: one call does both, and none is made for an empty text.

check: bytes `at` to `at + size` are a text        set text of lane 1[i] = bytes at, size, if they are a text
set text of lane 1[i] = bytes at, size
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from rosetta_jit.generate.c.holder.lanes import Lanes
from rosetta_jit.generate.c.printing.straight import size_left
from rosetta_jit.kernel.nodes import Block, Expect, Expr, IsText, SetField, Stmt, Wire
from rosetta_jit.kernel.rewrite import with_blocks
from rosetta_jit.kernel.walk import blocks_of
from rosetta_jit.startup.dataclass import replace

Field = tuple[int, int]
"""A field, by its lane and offset."""
Text = tuple[Expr, Expr | None]
"""Bytes of the message: where they begin, and how many they are."""


def with_texts_read(body: Block, lanes: Lanes, otherwise: str) -> tuple[Block, Lanes]:
    """The same of texts that are checked wherever they are set, and how these are set; ``otherwise`` is done where bytes are none."""
    plain, read = set[Field](), set[Field]()
    for block in _blocks(body):
        checked = set(map(_checked, block))
        for field, text in _texts(block, lanes):
            (read if text in checked else plain).add(field)
    read -= plain
    texts = {at: lanes.straight[at] for at in read}
    straight = {at: replace(each, statement=f"if (!{each.checked}) {{\n    {otherwise}\n}}") for at, each in texts.items()}
    return _without_checks(body, lanes, read), replace(lanes, straight={**lanes.straight, **straight})


def _blocks(block: Block) -> Iterator[Block]:
    yield block
    for stmt in block:
        for inner in blocks_of(stmt):
            yield from _blocks(inner)


def _checked(stmt: Stmt) -> Text | None:
    """The bytes that a statement finds to be a text."""
    match stmt:
        case Expect(IsText(Wire(at), size), _):
            return at, size
        case _:
            return None


def _texts(block: Block, lanes: Lanes) -> Iterator[tuple[Field, Text]]:
    """The texts that statements of a block set, and from which bytes."""
    for start, count in pairwise(block):
        if isinstance(start, SetField) and isinstance(count, SetField):
            field = start.place.lane, start.place.offset
            if field in lanes.straight and lanes.straight[field].text:
                yield field, (start.value, size_left(count.value))


def _without_checks(block: Block, lanes: Lanes, read: set[Field]) -> Block:
    found = {text for field, text in _texts(block, lanes) if field in read}
    kept = (stmt for stmt in block if _checked(stmt) not in found)
    return tuple(with_blocks(stmt, lambda inner: _without_checks(inner, lanes, read)) for stmt in kept)
