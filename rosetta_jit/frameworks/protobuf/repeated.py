"""Repeated fields of anything but numbers, and maps, with protobuf's manners."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, cast

from rosetta_jit.frameworks.protobuf.number_array import iterable
from rosetta_jit.runtime.holder import Holder, holder_class
from rosetta_jit.runtime.holder.classes import HolderFamily
from rosetta_jit.runtime.holder.dictionary import Dictionary
from rosetta_jit.runtime.holder.message import Message, View
from rosetta_jit.runtime.holder.record import Entry, Items, Record
from rosetta_jit.runtime.holder.sequence import Sequence


class RepeatedStrings(Sequence):
    """A repeated field of strings or bytes."""

    __slots__ = ()

    def extend(self, values: Iterable[Any]) -> None:
        super().extend(iterable(values))

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
        super().extend([self._checked(each) for each in iterable(values)])

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
