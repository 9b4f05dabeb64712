"""The table in which compiled accessors find each field of a record: some words a field.

Before the table stand the address of a Python function that assigns to members, and that of a list of what messages of the record keep: how
many they are, and of each its offset in the message, what it is (`Kept`), and the address of its place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from rosetta_jit.kernel.state import ADDRESS, LANE_WORDS, LANES, lane_word
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Enum
from rosetta_jit.runtime.cells import SCALARS, dtype_of
from rosetta_jit.runtime.holder.record import Bit, Blob, Case, Entry, Items, Numbers, Pairs, Presence, Record, Scalar, Spanned, Text, extent
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray


Getter = Callable[[Any], Any]
Setter = Callable[[Any, Any], None]


class Place:
    """The words of a place.

    Offsets are in bytes: those of fields in their row, those of lanes in the state, those of what is kept in the message.
    """

    OFFSET = 0
    GETTER = 1
    SETTER = 2
    MASK = 3
    """Bits of the row that tell whether the field is there; 0 if that need not be asked before it is read."""
    PRESENCE = 4
    WANTED = 5
    MARKS = 6
    """Address of a list of words of the row, of each its offset, and the bits to set when the field is written; 0 if that is not all."""
    TARGET = 7
    KEPT = 8
    KEY = 9
    """The target lane as Python's integer."""
    LEAST = 10
    MOST = 11
    """How many elements there can be. Where there are fewer, Python shows what is not there."""
    TYPE = 12
    TABLE = 13
    ACCESS = 14
    """Class, table and `Access` of the messages that are shown, once one was."""
    ENTRY = 15
    KIND = 16
    LENGTH = 17
    ITEM = 18
    ITERATOR = 19
    """Python functions that say the length and an element of a sequence, and the class of its iterators."""
    ELEMENT_OFFSET = 20
    ELEMENT_TARGET = 21
    ROOM = 22
    """Python function that makes room in a lane."""
    CELL = 23
    """Of numbers: their scalar, by its index in `runtime.cells.SCALARS`."""
    ARRAY = 24
    FORMAT = 25
    """The class of arrays, and up to two formats of buffers that have the same numbers, of two bytes each."""
    ITEM_BYTES = 26
    DTYPE = 27
    LONGEST = 28
    """How many bytes each text of an array may have."""


class Kept:
    """What a message keeps of a field: members are made with it, the others when they are first asked for."""

    MEMBER = 0
    MESSAGE = 1
    SEQUENCE = 2
    MAP = 3
    ARRAY = 4


class Shown:
    """What a field, or an element of it, is shown as: `Place.KIND`."""

    RECORD = 0
    VIEW = 1
    UTF_8 = 2
    OCTETS = 3
    PYTHON = 9


WORDS = 30
_ANY = (1 << 63) - 1
PLACE_BYTES = 8 * WORDS


@dataclass(frozen=True, slots=True)
class KeptFields:
    """Where messages of a struct keep what shows their fields, and which of it is made with them."""

    offsets: Mapping[str, int]
    members: frozenset[str]


class OfSequences(Protocol):
    """The two functions and the class that sequences need."""

    @property
    def length(self) -> Callable[[Any], int]: ...
    @property
    def item(self) -> Callable[[Any, Any], Any]: ...
    @property
    def iterator(self) -> type: ...


class FieldTable:
    """The table of a record. It must live as long as any message that knows its ``address``."""

    __slots__ = ("_alive", "_words", "address")

    def __init__(
        self,
        record: Record,
        read: Callable[[str], Getter],
        write: Callable[[str], Setter],
        kept: KeptFields,
        sequences: Callable[[], OfSequences],
    ) -> None:
        entries = list(record.entries.values())
        memory = np.zeros(2 + WORDS * len(entries), np.int64)
        self._words = memory[2:].reshape(len(entries), WORDS)
        self._alive: list[Any] = [record, memory]
        self.address: int = memory.ctypes.data + 16
        children = _children(entries, kept, self.address)
        memory[:2] = self._borrow(_assign), children.ctypes.data
        self._alive.append(children)
        for words, entry in zip(self._words, entries, strict=True):
            words[Place.GETTER], words[Place.SETTER] = self._borrow(read(entry.name)), self._borrow(write(entry.name))
            self._fill(words, record, entry)
            words[Place.KEPT] = kept.offsets.get(entry.name, 0)
            if isinstance(entry.node, Items):
                of = sequences()
                words[Place.LENGTH], words[Place.ITEM], words[Place.ITERATOR] = map(self._borrow, (of.length, of.item, of.iterator))

    def show(self, number: int, view_class: type, access: Any, table: int) -> None:
        """From now on, make views of a field, or of its elements, without asking Python."""
        words = self._words[number]
        words[Place.TABLE], words[Place.ACCESS] = table, self._borrow(access)
        words[Place.TYPE] = self._borrow(view_class)

    def _borrow(self, held: object) -> int:
        """The address of an object that lives as long as the table."""
        self._alive.append(held)
        return id(held)

    def _fill(self, words: NDArray[np.int64], record: Record, entry: Entry) -> None:
        node = entry.node
        words[Place.ENTRY] = id(entry)
        words[Place.MASK], words[Place.PRESENCE], words[Place.WANTED] = _presence_bits(entry)
        words[Place.KIND] = Shown.PYTHON
        match node:
            case Record():
                words[Place.KIND] = Shown.RECORD
            case Scalar():
                words[Place.OFFSET] = extent(node)[1]
                if node.choice is None:
                    self._mark(words, record, entry)
            case _:
                words[Place.OFFSET], words[Place.TARGET] = 8 * node.span.index, 8 * lane_word(node.lane, ADDRESS)
                words[Place.ROOM] = self._borrow(_make_room)
                words[Place.LEAST], words[Place.MOST] = _lengths(node)
                self._mark(words, record, entry)
                if isinstance(node, Numbers):
                    self._fill_numbers(words, node)
                if isinstance(node, Items):
                    self._fill_elements(words, node)

    def _mark(self, words: NDArray[np.int64], record: Record, entry: Entry) -> None:
        marks = _marks((*record.touch, entry.presence))
        closed = isinstance(entry.node, Scalar | Numbers) and isinstance(entry.node.type, Enum) and entry.node.type.closed
        if marks is not None and not closed:
            words[Place.MARKS] = marks.ctypes.data
            self._alive.append(marks)

    def _fill_numbers(self, words: NDArray[np.int64], node: Numbers) -> None:
        scalar = scalar_of(node.type)
        dtype = dtype_of(scalar)
        words[Place.KEY], words[Place.CELL] = self._borrow(int(node.lane)), SCALARS.index(scalar)
        words[Place.ARRAY], words[Place.DTYPE], words[Place.ITEM_BYTES] = id(np.ndarray), self._borrow(dtype), dtype.itemsize
        letters = {dtype.char, np.dtype(dtype.str).char, *("lq" if scalar == "i64" else "LQ" if scalar == "u64" else "")}
        words[Place.FORMAT] = int.from_bytes(b"".join(letter.encode() + b"\0" for letter in sorted(letters)), "little")

    def _fill_elements(self, words: NDArray[np.int64], node: Items) -> None:
        match node.element:
            case Record():
                words[Place.KIND] = Shown.VIEW
            case Text(span, lane, type_) if type_.encoding != "utf-16":
                words[Place.KIND] = Shown.UTF_8 if type_.encoding == "utf-8" else Shown.OCTETS
                words[Place.ELEMENT_OFFSET], words[Place.ELEMENT_TARGET] = 8 * span.index, 8 * lane_word(lane, ADDRESS)
                _, words[Place.LONGEST] = _lengths(node.element)
            case _:
                pass


def _make_room(message: Any, lane: int, rows: int) -> None:
    """Make room for so many rows more of a lane, whose words lie at an offset in the state."""
    with message.lanes_ as lanes:
        lanes.grow((lane // 8 - LANES) // LANE_WORDS, rows)
    message.access_.family.learn_room(lanes)


def _lengths(node: Spanned) -> tuple[int, int]:
    """How many elements there must be, and can be."""
    match node:
        case Text(_, _, type_):
            return 0, _ANY if type_.maximum is None else type_.maximum
        case Blob() | Numbers() | Items():
            most = node.maximum if node.length is None else node.length
            return node.length or 0, _ANY if most is None else most
        case _:
            return 0, 0


def _presence_bits(entry: Entry) -> tuple[int, int, int]:
    """Mask, offset and wanted bits of what tells whether a field is there, where what is absent is not read as zero."""
    match entry.presence:
        case Bit(cell, mask) if entry.default:
            return _signed(mask), 8 * cell.index, _signed(mask)
        case Case(cell, number):
            return -1, 8 * cell.index, number
        case _:
            return 0, 0, 0


def _marks(presences: tuple[Presence | None, ...]) -> NDArray[np.int64] | None:
    """What must be set when a field is written, if bits are all."""
    found: list[int] = []
    for each in presences:
        match each:
            case None:
                pass
            case Bit(cell, mask, ()):
                found += [8 * cell.index, _signed(mask)]
            case _:
                return None
    return np.array([len(found) // 2, *found], np.int64)


def _signed(bits: int) -> int:
    """The same 64 bits as a signed number."""
    return bits - (bits >> 63 << 64)


def _assign(message: Any, name: str, value: Any) -> bool:
    """Assign to a member, which CPython regards as read-only; False if the attribute is none."""
    if name not in message.access_.record.entries:
        return False
    message.access_.setters[name](message, value)
    return True


def _children(entries: list[Entry], kept: KeptFields, table: int) -> NDArray[np.int64]:
    found = [
        (kept.offsets[each.name], Kept.MEMBER if each.name in kept.members else _kind(each), table + PLACE_BYTES * number)
        for number, each in enumerate(entries)
        if each.name in kept.offsets
    ]
    return np.array([len(found), *(word for child in found for word in child)], np.int64)


def _kind(entry: Entry) -> int:
    match entry.node:
        case Record():
            return Kept.MESSAGE
        case Pairs():
            return Kept.MAP
        case Numbers():
            return Kept.ARRAY
        case _:
            return Kept.SEQUENCE
