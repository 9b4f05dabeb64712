"""Random relations of fields that are bits of one integer: each flag and number by a relation of its own, or all by one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tests.random_mappings.digits import LONG
from tests.random_mappings.meaning import Refused, fits
from tests.random_mappings.message_types import Kind, Scalar
from tests.random_mappings.relations import Part

if TYPE_CHECKING:
    import random

    from tests.random_mappings.blocks import Relations
    from tests.random_mappings.relations import Values

BITS = 32


@dataclass(frozen=True)
class Piece:
    """Neighbouring bits from ``shift`` on; a flag is one bit, asked for or its opposite."""

    name: str
    shift: int
    count: int
    is_flag: bool = False
    is_opposite: bool = False

    @property
    def kind(self) -> Kind:
        return Scalar("bool" if self.is_flag else "int64")

    def of(self, number: int) -> int | bool:
        bits = number >> self.shift & ((1 << self.count) - 1)
        return bool(bits) != self.is_opposite if self.is_flag else bits

    def some(self, rng: random.Random) -> int | bool:
        if self.is_flag:
            return rng.random() < 0.5
        below = 1 << self.count
        return rng.choice([0, below - 1, rng.randrange(below), rng.choice([below, -1]) if rng.random() < 0.1 else 0])


def pieces(rng: random.Random, name: str, *, opposite: bool) -> list[Piece]:
    """Two to four of them, with bits of none between."""
    found: list[Piece] = []
    at = rng.choice([0, 0, 1, 3])
    for letter in "abcd"[: rng.randrange(2, 5)]:
        count = rng.choice([1, 1, 2, 5, 7])
        is_flag = count == 1 and rng.random() < 0.7
        found.append(Piece(name + letter, at, count, is_flag, is_flag and opposite and rng.random() < 0.3))
        at += count + rng.choice([0, 0, 1, 4])
    return found


def taken(rng: random.Random, piece: Piece, whole: str) -> str:
    """A way to ask for bits."""
    mask = (1 << piece.count) - 1
    shifted = f"{whole} >> {piece.shift}" if piece.shift else whole
    if not piece.is_flag:
        return rng.choice([f"{shifted} & {mask}", f"{mask} & {shifted}"])
    at, sign = 1 << piece.shift, "==" if piece.is_opposite else "!="
    ways = [f"{whole} & {at} {sign} 0", f"{shifted} & 1 {sign} 0", f"{whole} & {at} {'!=' if piece.is_opposite else '=='} {at}"]
    return rng.choice([*ways, f"{'not ' if piece.is_opposite else ''}bool({shifted} & 1)"])


def flags(relations: Relations, name: str) -> Part:
    """Bits of an integer of the wire, a relation each."""
    rng = relations.rng
    found = pieces(rng, name, opposite=True)
    lines = [f".{piece.name} <-> {taken(rng, piece, f'.{name}')}\n" for piece in found]
    rng.shuffle(lines)

    def unpack(values: Values) -> Values:
        return {piece.name: piece.of(values[name]) for piece in found}

    return Part(
        {name: LONG},
        {piece.name: piece.kind for piece in found},
        "".join(lines),
        unpack,
        lambda rng: {name: rng.choice([0, -1, 1, rng.randrange(1 << BITS), rng.randrange(-(1 << 62), 1 << 62)])},
        lambda rng: {piece.name: piece.some(rng) for piece in found},
        is_bounded=True,
    )


def joined(relations: Relations, name: str) -> Part:
    """Fields of the wire that are bits of an integer of the holder, by one relation."""
    rng = relations.rng
    found = pieces(rng, name, opposite=False)
    terms = [(f"int64(.{piece.name})" if piece.is_flag else f".{piece.name}", piece.shift) for piece in found]
    rng.shuffle(terms)
    text = " | ".join(f"{term} << {shift}" if shift else term for term, shift in terms)

    def unpack(values: Values) -> Values:
        total = 0
        for piece, above in zip(found, [*found[1:], None], strict=True):
            value = int(values[piece.name])
            if above is not None and not 0 <= value < 1 << above.shift - piece.shift:
                raise Refused("rejected")
            total |= value << piece.shift
        return {name: fits(total)}

    return Part(
        {piece.name: piece.kind for piece in found},
        {name: LONG},
        f".{name} <-> {text}\n",
        unpack,
        lambda rng: {piece.name: piece.some(rng) for piece in found},
        lambda rng: {name: rng.choice([0, 1, -1, rng.randrange(1 << BITS)])},
        is_bounded=True,
    )
