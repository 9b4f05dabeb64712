"""Which rows of a SQLite file lie partly behind its end: SQLite reads zeros for what is missing of the last page, and says nothing.

The pages of a table are a tree. A leaf has rows; what is too long for it goes on in a chain of overflow pages.
https://www.sqlite.org/fileformat2.html, sections 1.6 and 1.7. Rows that were written last are in the last leaves, which are read first.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.logs.reading.storage import Storage

LEAF, INTERIOR = 13, 5
HEADER_BYTES = 100
"""Of the file, before the first page's own header."""

MOST_DEPTH, MOST_LEAVES, MOST_OVERFLOW = 20, 64, 1 << 18
"""Pages above each other, leaves, and overflow pages that are looked at: a damaged file may have circles."""


@dataclass(frozen=True, slots=True)
class Row:
    """A row in a leaf: where its bytes there end, and where they go on, if they do: page 0 is none."""

    number: int
    end: int
    overflow: int


@dataclass(frozen=True, slots=True)
class Pages:
    """The pages of a file; ``usable`` are the bytes of each that SQLite uses."""

    storage: Storage
    size: int
    usable: int

    def page(self, number: int) -> bytes:
        """A page, with zeros for what the file lacks."""
        if number < 1:
            return bytes(self.size)
        return self.storage.read((number - 1) * self.size, self.size).ljust(self.size, b"\0")

    def rows_cut(self, root: int) -> set[int]:
        """The numbers of the rows of a table that reach into what is missing of the last page."""
        last, there = divmod(self.storage.size, self.size)
        last += 1
        found, overflows = set[int](), MOST_OVERFLOW
        for leaves, number in enumerate(self._leaves(root, MOST_DEPTH)):
            if leaves == MOST_LEAVES or overflows <= 0:
                break
            for row in self._rows(number):
                if number == last and row.end > there:
                    found.add(row.number)
                overflow = row.overflow
                while overflow and overflows > 0 and overflow != last:
                    overflow, overflows = int.from_bytes(self.page(overflow)[:4], "big"), overflows - 1
                if overflow == last:
                    found.add(row.number)
            if found:
                break
        return found

    def _leaves(self, number: int, depth: int) -> Iterator[int]:
        """The leaves of a tree, the last one first."""
        page, begin = self.page(number), HEADER_BYTES if number == 1 else 0
        if page[begin] == LEAF:
            yield number
        elif page[begin] == INTERIOR and depth:
            (right,) = struct.unpack_from(">I", page, begin + 8)
            yield from self._leaves(right, depth - 1)
            for at in reversed(_cells(page, begin, 12)):
                yield from self._leaves(int.from_bytes(page[at : at + 4], "big"), depth - 1)

    def _rows(self, number: int) -> Iterator[Row]:
        page, begin = self.page(number), HEADER_BYTES if number == 1 else 0
        for cell in _cells(page, begin, 8):
            payload, at = _varint(page, cell)
            row, at = _varint(page, at)
            local = self._local(payload)
            end = at + local
            yield Row(row, end, 0 if local == payload else int.from_bytes(page[end : end + 4], "big"))

    def _local(self, payload: int) -> int:
        """How many bytes of a row are in its leaf."""
        most, least = self.usable - 35, (self.usable - 12) * 32 // 255 - 23
        if payload <= most:
            return payload
        some = least + (payload - least) % (self.usable - 4)
        return some if some <= most else least


def _cells(page: bytes, begin: int, header: int) -> list[int]:
    """Where the cells of a page lie."""
    (count,) = struct.unpack_from(">H", page, begin + 3)
    count = min(count, (len(page) - begin - header) // 2)
    return list(struct.unpack_from(f">{count}H", page, begin + header))


def _varint(page: bytes, at: int) -> tuple[int, int]:
    """An integer of one to nine bytes, big-endian, and the place behind it."""
    value = 0
    for number in range(9):
        byte = page[at + number] if at + number < len(page) else 0
        if number == 8:
            return value << 8 | byte, at + 9
        value = value << 7 | byte & 0x7F
        if byte < 0x80:
            return value, at + number + 1
    raise AssertionError("the ninth byte ends the loop")
