"""Texts in the rules of a mapping."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import WIDTH, Binary, Compare, Const, Expr, Get, If, Load, Place, Wire
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.lowering.writer import block

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Address, Scalar
    from rosetta_jit.language import typed
    from rosetta_jit.lowering.evaluation import Evaluation

WORDS: tuple[Scalar, ...] = ("u64", "u32", "u16", "u8")
"""What the bytes of a message are compared in."""


def is_text(values: Evaluation, place: typed.Place, text: bytes) -> Expr:
    """Whether a field holds these bytes."""
    return are_bytes(values, values.source.count(place, values), values.source.address(place, values), text)


def are_bytes(values: Evaluation, count: Expr, address: Address, text: bytes) -> Expr:
    """Whether so many bytes at an address are these. They are looked at only where there are as many."""
    writer = values.writer
    if not text:
        return Compare("eq", count, index(0))
    found = writer.var("is_text", Const("bool", value=False))
    with writer.nested() as inside:
        if isinstance(address, Wire):  # a field that several forms of a message have is not known to be where each of them has it
            writer.require(len(text), values.where, at=address.at)
        writer.assign(found, Const("bool", value=True))
        for offset, piece in _pieces(text, isinstance(address, Place)):
            same = Compare("eq", _word(address, offset, piece), piece)
            writer.assign(found, Binary("and", found, same))
    writer.emit(If(Compare("eq", count, index(len(text))), block(inside)))
    return found


def _pieces(text: bytes, in_lane: bool) -> list[tuple[int, Const]]:
    """A text as integers; rows of a lane are bytes, and read one by one."""
    pieces: list[tuple[int, Const]] = []
    offset = 0
    while offset < len(text):
        left = 1 if in_lane else len(text) - offset
        word: Scalar = next(word for word in WORDS if WIDTH[word] <= left)
        pieces.append((offset, Const(word, int.from_bytes(text[offset : offset + WIDTH[word]], "little"))))
        offset += WIDTH[word]
    return pieces


def _word(address: Address, offset: int, piece: Const) -> Expr:
    if isinstance(address, Place):
        return Get(piece.type, Place(address.lane, add(address.row, offset)))
    return Load(piece.type, add(address.at, offset))
