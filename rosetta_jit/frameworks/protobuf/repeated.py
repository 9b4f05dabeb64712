"""Repeated fields and maps with protobuf's manners.

Repeated numbers are numpy arrays that also append, extend and delete as lists do. Where a list and an array disagree, the array wins
(``==`` and ``+`` go element by element), but for truth (`if message.samples:` asks whether there are any) and iteration (Python's own
numbers). An array shows the elements that were there when it was read from its message: read the attribute again after a change of length.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from rosetta_jit.runtime.holder import Holder, holder_class
from rosetta_jit.runtime.holder.classes import HolderFamily
from rosetta_jit.runtime.holder.dictionary import Dictionary
from rosetta_jit.runtime.holder.message import Message, View, place, writable
from rosetta_jit.runtime.holder.record import Entry, Items, Numbers, Record
from rosetta_jit.runtime.holder.sequence import Sequence
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder import coerce, merge, values
else:
    coerce, merge, values = late("rosetta_jit.runtime.holder", "coerce", "merge", "values")


_Result = TypeVar("_Result")


class NumberArray(np.ndarray[Any, Any]):
    """A repeated field of numbers, or of enums: a view into its message's lane.

    Attributes
    ----------
    owner_ : tuple of message and field
        Whose elements these are. Slices and copies have none, and cannot change their length.
    """

    __slots__ = ("owner_",)

    def _is_field(self) -> bool:
        """Whether these are the elements of a field, not of a slice or a copy."""
        return getattr(self, "owner_", None) is not None

    def _field(self) -> tuple[Message, Numbers]:
        owner: tuple[Message, Entry] | None = getattr(self, "owner_", None)
        if owner is None:
            raise TypeError("a slice or copy of a repeated field cannot change its length; change the field itself")
        return owner[0], cast("Numbers", owner[1].node)

    def _change(self, change: Callable[[list[Any]], _Result]) -> _Result:
        """Change the field's elements as a list. InUse where they have become others meanwhile."""
        message, node = self._field()
        epoch = message.lanes_.epoch()
        elements = message.lanes_.consistent(_elements, (message, node)).tolist()
        result = change(elements)
        prepared = values.prepare(node, elements)
        with message.lanes_ as lanes:
            lanes.check_unchanged(epoch)
            values.put(node, *writable(message), prepared)
        return result

    def append(self, value: Any) -> None:
        self.extend([value])

    def extend(self, elements: Iterable[Any]) -> None:
        """Append all elements, or none if one is wrong."""
        merge.append_numbers(*self._field(), _iterable(elements))

    MergeFrom = extend

    def insert(self, index: int, value: Any) -> None:
        self._change(lambda elements: elements.insert(index, value))

    def pop(self, index: int = -1) -> Any:
        return self._change(lambda elements: elements.pop(index))

    def remove(self, value: Any) -> None:
        self._change(lambda elements: elements.remove(value))

    def clear(self) -> None:
        """Remove all elements, whichever there are."""
        message, node = self._field()
        with message.lanes_:
            values.put(node, *writable(message), values.prepare(node, []))

    def reverse(self) -> None:
        self._change(lambda elements: elements.reverse())

    def sort(self, *, key: Callable[[Any], Any] | None = None, reverse: bool = False) -> None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Sort in place, as a list does."""
        if self._is_field():
            self._change(lambda elements: elements.sort(key=cast("Any", key), reverse=reverse))
        else:
            self[...] = sorted(self.tolist(), key=cast("Any", key), reverse=reverse)

    def __delitem__(self, index: Any) -> None:
        self._change(lambda elements: elements.__delitem__(index))

    def __setitem__(self, index: Any, value: Any) -> None:
        """Set an element, or several as numpy does; a list in place of a slice may have another length, as in a list."""
        if self._is_field():
            if isinstance(index, slice) and isinstance(value, list | tuple):
                part, elements = cast("slice[Any, Any, Any]", index), cast("list[Any]", value)
                if len(elements) != len(range(self.size)[part]):
                    self._change(lambda whole: whole.__setitem__(part, elements))
                    return
            elif isinstance(index, int):
                super().__setitem__(index, coerce.scalar(self._field()[1].type, value))
                return
        super().__setitem__(cast("Any", index), cast("Any", value))

    def __iter__(self) -> Iterator[Any]:
        return iter(self.tolist())

    def __bool__(self) -> bool:
        return self.size > 0

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        """Results of arithmetic are arrays like any other."""
        return array[()] if return_scalar else np.asarray(array)


def _elements(field: tuple[Message, Numbers]) -> Any:
    message, node = field
    return values.read(node, *place(message), values.Form.RAW)


def _iterable(elements: Any) -> Iterable[Any]:
    if not isinstance(elements, Iterable):
        raise TypeError("must assign iterable")
    return cast("Iterable[Any]", elements)


class RepeatedStrings(Sequence):
    """A repeated field of strings or bytes."""

    __slots__ = ()

    def extend(self, values: Iterable[Any]) -> None:
        super().extend(_iterable(values))

    def MergeFrom(self, other: Iterable[Any]) -> None:  # noqa: N802  as protobuf names it
        """Append the elements of another repeated field."""
        self.extend(other)


class RepeatedMessages(Sequence):
    """A repeated field of messages: they are copied in, and cannot be replaced but by `CopyFrom` of the element."""

    __slots__ = ()

    def add(self, **fields: Any) -> Any:
        """Append an empty message, or one of the fields given; return it."""
        with self.message.lanes_:
            self._append([{}])
            added = self._at(-1)
        try:
            added.set_fields_(fields)
        except BaseException:
            del self[len(self) - 1]
            raise
        return added

    def append(self, value: Any) -> None:
        super().append(self._checked(value))

    def insert(self, index: int, value: Any) -> None:
        super().insert(index, self._checked(value))

    def extend(self, values: Iterable[Any]) -> None:
        super().extend([self._checked(each) for each in _iterable(values)])

    def MergeFrom(self, other: Iterable[Any]) -> None:  # noqa: N802  as protobuf names it
        """Append the elements of another repeated field."""
        self.extend(other)

    def __setitem__(self, index: Any, value: Any) -> None:
        raise TypeError(f"'{type(self).__name__}' object does not support item assignment")

    def _checked(self, value: Any) -> Any:
        record = cast("Record", self.node.element)
        if not isinstance(value, Message) or value.access_.record.struct != record.struct:
            raise TypeError(f"Expected a message object of type {record.struct}, but got {value!r:.80}.")
        return value


def repeated(message: View, entry: Entry) -> Sequence:
    """What shows a repeated field of anything but numbers."""
    match entry.node:
        case Items(element=Record()):
            return RepeatedMessages(message, entry)
        case _:
            return RepeatedStrings(message, entry)


class MapField(Dictionary):
    """A map field: reading a key that is not there puts it there, with a default value or an empty message."""

    __slots__ = ()

    def __getitem__(self, key: Any) -> Any:
        if self.checked(key) not in self._known():
            self._add(key, {} if self._holds_messages else self.node.value.default)
        return super().__getitem__(key)

    get_or_create = __getitem__

    @property
    def _holds_messages(self) -> bool:
        return self.node.value.default is None

    def __setitem__(self, key: Any, value: Any) -> None:
        if self._holds_messages:
            raise ValueError("May not set values directly, call my_map[key].foo = 5")
        super().__setitem__(key, value)

    def setdefault(self, key: Any, default: Any = None) -> Any:
        if self._holds_messages:
            raise NotImplementedError("Set message map value directly is not supported, call my_map[key].foo = 5")
        if default is None:
            raise ValueError("The value for scalar map setdefault must be set.")
        return super().setdefault(key, default)

    def get(self, key: Any, default: Any = None) -> Any:
        return self.found(key) if key in self else default

    def GetEntryClass(self) -> type[Holder]:  # noqa: N802  as protobuf names it
        """The class of messages with a ``key`` and a ``value``, as the pairs are in bytes and in protobuf's text format."""
        family = cast("HolderFamily", self.message.access_.family)
        field = cast("Any", self.message).DESCRIPTOR.fields_by_name[self.entry.name]
        return holder_class(field.message_type.struct, family.schema, family.manners)

    def MergeFrom(self, other: Mapping[Any, Any]) -> None:  # noqa: N802  as protobuf names it
        """Take over the pairs of another map."""
        for key, value in other.items():
            Dictionary.__setitem__(self, key, value)
