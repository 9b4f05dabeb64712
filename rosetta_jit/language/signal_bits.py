"""Signals: numbers of any width within the bytes of a frame, as DBC files write them down.

    "start|length@order sign"     order = 1 (Intel, little endian) | 0 (Motorola, big endian)       sign = + | -

Bits are numbered as in DBC files: bit ``b`` of byte ``n``, of which 0 is the lowest, is ``8 * n + b``. An Intel signal begins with its
lowest bit and goes on to higher numbers. A Motorola signal begins with its highest bit, goes down to bit 0 of that byte, and on with
bit 7 of the next one.
"""

from __future__ import annotations

import re

from rosetta_jit.language.limits import MAX_SIGNAL_BYTES
from rosetta_jit.model.types import Int
from rosetta_jit.startup.dataclass import dataclass

FORM = re.compile(r"([0-9]{1,4})\|([0-9]{1,3})@([01])([+-])")
MOST_BITS = 64


@dataclass(frozen=True, slots=True)
class Piece:
    """Bits of a signal that lie in one byte: ``count`` of them from ``bit`` on are those of the signal from ``shift`` on."""

    byte: int
    bit: int
    count: int
    shift: int

    @property
    def mask(self) -> int:
        return (1 << self.count) - 1


@dataclass(frozen=True, slots=True)
class Window:
    """A word of ``size`` bytes in a frame that has all bits of a signal, from its bit ``shift`` on."""

    byte: int
    size: int
    shift: int


@dataclass(frozen=True, slots=True)
class Signal:
    """A signal: how many bits it has, whether the highest is a sign, and where they lie."""

    text: str
    length: int
    signed: bool
    pieces: tuple[Piece, ...]

    @property
    def size(self) -> int:
        """How many bytes a frame has at least."""
        return 1 + max(piece.byte for piece in self.pieces)

    @property
    def is_little(self) -> bool:
        """Whether the bytes of a word that has it begin with the lowest."""
        return "@1" in self.text

    def window(self, size: int) -> Window | None:
        """The smallest word within the first ``size`` bytes of a frame that has all of its bits."""
        first = min(piece.byte for piece in self.pieces)
        for width in (1, 2, 4, 8):
            byte = min(first, size - width)
            if byte >= 0 and byte + width >= self.size:
                lowest = self.pieces[0] if self.is_little else self.pieces[-1]
                before = lowest.byte - byte if self.is_little else byte + width - 1 - lowest.byte
                return Window(byte, width, 8 * before + lowest.bit)
        return None

    @property
    def bits(self) -> frozenset[int]:
        """The numbers of its bits."""
        return frozenset(8 * piece.byte + piece.bit + number for piece in self.pieces for number in range(piece.count))

    @property
    def type(self) -> Int:
        """The narrowest type of integers that holds it; of unsigned ones an int64 where that does, for arithmetic takes no uint64."""
        if self.length > 32:
            return Int(64, signed=self.signed or self.length < MOST_BITS)
        return Int(8 if self.length <= 8 else 16 if self.length <= 16 else 32, signed=self.signed)

    @property
    def limits(self) -> tuple[int, int]:
        """The least value, and the first one that is too large."""
        half = 1 << (self.length - 1)
        return (-half, half) if self.signed else (0, 2 * half)


def signal_of(text: str) -> Signal | None:
    """The signal that a text writes down; None where it is none, or does not begin within the largest frame."""
    found = FORM.fullmatch(text)
    if found is None:
        return None
    start, length = int(found[1]), int(found[2])
    if start >= 8 * MAX_SIGNAL_BYTES:
        return None
    return Signal(text, length, found[4] == "-", tuple(_intel(start, length) if found[3] == "1" else _motorola(start, length)))


def _intel(start: int, length: int) -> list[Piece]:
    """From the lowest bit on."""
    pieces: list[Piece] = []
    done = 0
    while done < length:
        byte, bit = divmod(start + done, 8)
        count = min(8 - bit, length - done)
        pieces.append(Piece(byte, bit, count, done))
        done += count
    return pieces


def _motorola(start: int, length: int) -> list[Piece]:
    """From the highest bit on."""
    pieces: list[Piece] = []
    (byte, highest), left = divmod(start, 8), length
    while left > 0:
        count = min(highest + 1, left)
        left -= count
        pieces.append(Piece(byte, highest + 1 - count, count, left))
        byte, highest = byte + 1, 7
    return pieces
