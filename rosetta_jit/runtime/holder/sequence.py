"""Arrays of a message that numpy cannot show, as Python's own sequences; they hold no values, only where to look."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, MutableSequence
from contextlib import suppress
from copy import copy
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np

from rosetta_jit.runtime.attributes.sequences import bind_place, compiled, extend_texts, iterator_class, sequence_base
from rosetta_jit.runtime.callable import sealed
from rosetta_jit.runtime.holder.message import Message, View, check_readable, element, place, writable
from rosetta_jit.runtime.holder.record import Blob, Entry, Items, Node, Numbers, Record, Scalar, Text
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder import access, arena, coerce, values
else:
    access, arena, coerce, values = late("rosetta_jit.runtime.holder", "access", "arena", "coerce", "values")


def _element(message: View, entry: Entry, record: Record, index: int) -> View:
    """A view of one row of an array or map of records."""
    family = message.access_.family
    cls = family.view_class(record.struct)
    return element(cls.__new__(cls), message, family.access(record), entry, index)


def store_row(node: Node, lanes: Lanes, row: int, value: Any) -> None:
    """Make a value that of an element that is empty; of a leaf with the errors of an assignment."""
    if isinstance(node, Scalar | Text | Blob | Numbers):
        values.store(node, lanes, row, value)
    else:
        values.write(node, lanes, row, value)


def detached(value: Any) -> Any:
    """A value that has been read from a message, as one of its own: what the message becomes does not change it."""
    match value:
        case Message() | np.ndarray():
            return copy(cast("Any", value))
        case Sequence():
            return [detached(each) for each in value]
        case _:
            return value


if TYPE_CHECKING:
    Base = object
else:
    Base = sequence_base()


class Sequence(MutableSequence[Any], Base):
    """An array of messages, strings, bytes or arrays.

    Elements that are messages are views, and strings and bytes are Python's own. What is assigned or appended is copied.
    """

    __slots__ = ("entry", "message", "node", "spare_one", "spare_two")  # in this order in memory
    entry: Entry
    message: View
    node: Items

    def __new__(cls, message: View, entry: Entry) -> Self:  # noqa: ARG004  which is for __init__
        return super().__new__(cast("type[Self]", compiled(cls)) if message.access_.table else cls)

    def __init__(self, message: View, entry: Entry) -> None:
        check_readable(message)
        _set_message(self, message)
        _set_entry(self, entry)
        _set_node(self, entry.node)
        bind_place(self, message.access_.place_of(entry.name))

    def _span(self) -> tuple[Lanes, int, int]:
        lanes, row = place(self.message)
        return lanes, *arena.span_of(lanes, self.node.span, row)

    def __len__(self) -> int:
        return self._span()[2]

    def __getitem__(self, index: Any) -> Any:
        return self.message.lanes_.consistent(self._at, index)

    def _at(self, index: Any) -> Any:
        lanes, start, count = self._span()
        if isinstance(index, slice):
            return [self._element(lanes, start, each) for each in range(count)[index]]
        return self._element(lanes, start, _checked(index, count))

    def __iter__(self) -> Iterator[Any]:
        for index in itertools.count():
            try:
                element = self[index]
            except IndexError:
                return
            yield element

    def __reversed__(self) -> Iterator[Any]:
        """From the last element that there is now; like a list's, it ends where elements that it has not reached are gone."""
        with suppress(IndexError):
            for index in range(len(self))[::-1]:
                yield self[index]

    def _element(self, lanes: Lanes, start: int, index: int) -> Any:
        match self.node.element:
            case Record():
                return _element(self.message, self.entry, self.node.element, index)
            case element:
                return values.read(element, lanes, start + index, values.Form.RAW)

    def __setitem__(self, index: Any, value: Any) -> None:
        if isinstance(index, slice):
            epoch = self.message.lanes_.epoch()
            elements = list(self)
            elements[index] = value
            self._replace(elements, epoch)
            return
        plain = access.raw(value)
        with self.message.lanes_:
            count = len(self)
            at = _checked(index, count)
            self._append([plain])
            self._order([*range(at), count, *range(at + 1, count)])

    def __delitem__(self, index: Any) -> None:
        with self.message.lanes_:
            self._remove(index)

    def insert(self, index: int, value: Any) -> None:
        plain = access.raw(value)
        with self.message.lanes_:
            count = len(self)
            self._allow(count + 1)
            at = range(count)[:index].stop if count else 0
            self._append([plain])
            self._order([*range(at), count, *range(at, count)])

    def append(self, value: Any) -> None:
        self.extend([value])

    def extend(self, values: Iterable[Any]) -> None:
        if self.message.access_.table and extend_texts(self, values):
            return
        plain = [access.raw(each) for each in values]
        with self.message.lanes_:
            self._allow(len(self) + len(plain))
            self._append(plain)

    def pop(self, index: int = -1) -> Any:
        """Remove an element and return it; a message as one of its own."""
        epoch = self.message.lanes_.epoch()
        value = self[index]
        popped = detached(value)
        with self.message.lanes_ as lanes:
            lanes.check_unchanged(epoch)
            self._remove(index)
        return popped

    def remove(self, value: Any) -> None:
        """Remove the first element that equals a value; ValueError if there is none."""
        epoch = self.message.lanes_.epoch()
        index = self.index(value)
        with self.message.lanes_ as lanes:
            lanes.check_unchanged(epoch)
            self._remove(index)

    def clear(self) -> None:
        self._allow(0)
        with self.message.lanes_:
            self._order([])

    def sort(self, *, key: Callable[[Any], Any] | None = None, reverse: bool = False) -> None:
        """Sort the elements in place."""
        epoch = self.message.lanes_.epoch()
        elements = list(self)
        order = sorted(range(len(elements)), key=lambda each: key(elements[each]) if key else elements[each], reverse=reverse)
        with self.message.lanes_ as lanes:
            lanes.check_unchanged(epoch)
            self._order(order)

    def reverse(self) -> None:
        with self.message.lanes_:
            self._order(list(range(len(self)))[::-1])

    def _allow(self, count: int) -> None:
        """Refuse a number of elements that the type does not have: ValueError."""
        coerce.counted(count, self.node.length, self.node.maximum)

    def _append(self, plain: list[Any]) -> None:
        """Inside ``with home_:``, add elements at the end: all of them, or none where one is wrong."""
        node = self.node
        lanes, row = writable(self.message)
        _, count = arena.span_of(lanes, node.span, row)
        start = arena.resize(lanes, node, row, count + len(plain))
        try:
            for index, each in enumerate(plain, count):
                store_row(node.element, lanes, start + index, each)
        except BaseException:
            arena.resize(lanes, node, row, count)
            raise

    def _remove(self, index: Any) -> None:
        """Inside ``with home_:``, remove an element, or those of a slice."""
        count = len(self)
        gone = set(range(count)[index]) if isinstance(index, slice) else {_checked(index, count)}
        self._allow(count - len(gone))
        self._order([each for each in range(count) if each not in gone])

    def _replace(self, elements: list[Any], epoch: int) -> None:
        """Make these the elements, unless the message has changed since an epoch."""
        self._allow(len(elements))
        plain = [access.raw(each) for each in elements]
        with self.message.lanes_ as lanes:
            lanes.check_unchanged(epoch)
            count = len(self)
            self._append(plain)
            self._order(list(range(count, count + len(plain))))

    def _order(self, order: list[int]) -> None:
        lanes, row = writable(self.message)
        arena.rearrange(lanes, self.node, row, order)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, str | bytes) or not isinstance(other, Iterable):
            return NotImplemented
        return list(self) == list(cast("Iterable[Any]", other))

    __hash__ = None  # pyright: ignore[reportAssignmentType]  as of every mutable sequence

    def __repr__(self) -> str:
        return repr(list(self))


_set_entry, _set_message, _set_node, *_ = sealed(Sequence).values()


def _checked(index: int, count: int) -> int:
    try:
        return range(count)[index]
    except IndexError:
        raise IndexError("list index out of range") from None


class _OfSequences:
    """What compiled code asks of sequences that it does not know itself."""

    length = staticmethod(Sequence.__len__)
    item = staticmethod(Sequence.__getitem__)

    @property
    def iterator(self) -> type:
        """The class of their iterators."""
        return iterator_class()


OF_SEQUENCES = _OfSequences()
