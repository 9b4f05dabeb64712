"""Holders that can be looked at as YARP's Bottle can, beside their fields.

    holder.get(0).asFloat64(), holder.find("left").asString(), holder.toString()

What a holder shows is the bottle that it would be written as. It is made anew for each question: whoever asks much takes ``bottle()`` once.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from rosetta_jit.frameworks.yarp import tree
from rosetta_jit.frameworks.yarp.bottle import read
from rosetta_jit.frameworks.yarp.tags import YARP4, vocab
from rosetta_jit.frameworks.yarp.text import to_text
from rosetta_jit.runtime.holder import PLAIN, Holder, Manners
from rosetta_jit.runtime.holder.serialising import Programs, encoded
from rosetta_jit.startup.dataclass import dataclass

INTEGERS = ("int8", "int16", "int32", "int64")
FLOATS = ("float32", "float64")


@dataclass(frozen=True, slots=True)
class Value:
    """An element of a bottle; ``item`` is None where there is none, as YARP's null value."""

    item: tree.Item | None

    def isNull(self) -> bool:  # noqa: N802 - YARP's names, here and below
        """Whether there is no such element."""
        return self.item is None

    def isInt32(self) -> bool:  # noqa: N802
        """Whether it is an int32."""
        return self._tag() == "int32"

    def isInt64(self) -> bool:  # noqa: N802
        """Whether it is an int64."""
        return self._tag() == "int64"

    def isFloat64(self) -> bool:  # noqa: N802
        """Whether it is a float64."""
        return self._tag() == "float64"

    def isVocab32(self) -> bool:  # noqa: N802
        """Whether it is a vocab."""
        return self._tag() == "vocab32"

    def isString(self) -> bool:  # noqa: N802
        """Whether it is a string."""
        return self._tag() == "string"

    def isBlob(self) -> bool:  # noqa: N802
        """Whether it is a blob."""
        return self._tag() == "blob"

    def isList(self) -> bool:  # noqa: N802
        """Whether it is a list."""
        return isinstance(self.item, tree.List)

    def asInt32(self) -> int:  # noqa: N802
        """An integer, what a float has before its point, 0 for anything else."""
        return int(self.asFloat64()) if self._tag() in FLOATS else self.asInt64()

    def asInt64(self) -> int:  # noqa: N802
        """The same."""
        value = self.item.value if isinstance(self.item, tree.Value) else 0
        return int(value) if isinstance(value, int | float) else 0

    def asFloat64(self) -> float:  # noqa: N802
        """A number, 0 for anything else."""
        value = self.item.value if isinstance(self.item, tree.Value) else 0.0
        return float(value) if isinstance(value, int | float) else 0.0

    def asVocab32(self) -> int:  # noqa: N802
        """A vocab's number; that of a string's letters."""
        if isinstance(self.item, tree.Value) and isinstance(self.item.value, bytes):
            return vocab(self.item.value[:4])
        return self.asInt64()

    def asString(self) -> str:  # noqa: N802
        """A string's text, that of a vocab, nothing for anything else."""
        return self.toString().strip("[]") if self.isVocab32() else _text(self.asBlob()) if self.isString() else ""

    def asBlob(self) -> bytes:  # noqa: N802
        """The bytes of a blob or a string."""
        return self.item.value if isinstance(self.item, tree.Value) and isinstance(self.item.value, bytes) else b""

    def asList(self) -> Bottle | None:  # noqa: N802
        """The list, None for anything else."""
        return Bottle(self.item) if isinstance(self.item, tree.List) else None

    def toString(self) -> str:  # noqa: N802
        """What YARP prints for it."""
        return "" if self.item is None else Bottle(tree.List((self.item,))).toString()

    def _tag(self) -> str:
        return self.item.tag if isinstance(self.item, tree.Value) else ""


@dataclass(frozen=True, slots=True)
class Bottle:
    """A list of values, as YARP shows it."""

    content: tree.List

    def size(self) -> int:
        """How many elements it has."""
        return len(self.content.items)

    def get(self, index: int) -> Value:
        """An element; the null value where there is none."""
        return Value(self.content.items[index] if 0 <= index < self.size() else None)

    def tail(self) -> Bottle:
        """All elements but the first."""
        return Bottle(tree.List(self.content.items[1:], self.content.unit))

    def find(self, key: str) -> Value:
        """The value behind a key, or of a list that begins with it (BottleImpl::findBit)."""
        for index, first, group in self._keys():
            if first == key:
                return self.get(index + 1) if group is None else Bottle(group).get(1)
        return Value(None)

    def findGroup(self, key: str) -> Bottle:  # noqa: N802
        """The list that begins with a key, empty where there is none."""
        return next((Bottle(group) for _, first, group in self._keys() if first == key and group is not None), Bottle(tree.List(())))

    def check(self, key: str) -> bool:
        """Whether a key is there."""
        return any(first == key for _, first, _ in self._keys())

    def toString(self) -> str:  # noqa: N802
        """What YARP prints for it."""
        return _text(to_text(self.content))

    def _keys(self) -> Iterator[tuple[int, str, tree.List | None]]:
        """Of each element its number, the text that it is or begins with, and itself if it is a list."""
        for index, item in enumerate(self.content.items):
            group = item.content if isinstance(item, tree.Dict) else item if isinstance(item, tree.List) else None
            first = Value(item) if group is None else Bottle(group).get(0)
            yield index, first.asString() or first.toString(), group


class BottleMessage(Holder):
    """A message of YARP, with its fields and as a bottle. A field of the name of a method wins."""

    __slots__ = ()

    programs_: ClassVar[Programs | None] = None

    def picture_(self) -> Any:
        from rosetta_jit.frameworks.yarp.pictures import picture

        return picture(self)

    def bottle(self) -> Bottle:
        """The bottle that YARP 4 would write.

        Raises
        ------
        EncodeError
            If the message cannot be written.
        DecodeError
            If what YARP writes for it is no bottle (a point cloud).
        """
        return Bottle(read(encoded(self), YARP4))

    def size(self) -> int:
        """How many elements the bottle has."""
        return self.bottle().size()

    def get(self, index: int) -> Value:
        """An element of the bottle."""
        return self.bottle().get(index)

    def tail(self) -> Bottle:
        """All elements of the bottle but the first."""
        return self.bottle().tail()

    def find(self, key: str) -> Value:
        """The value behind a key of the bottle."""
        return self.bottle().find(key)

    def findGroup(self, key: str) -> Bottle:  # noqa: N802
        """The list of the bottle that begins with a key."""
        return self.bottle().findGroup(key)

    def check(self, key: str) -> bool:
        """Whether the bottle has a key."""
        return self.bottle().check(key)

    def toString(self) -> str:  # noqa: N802
        """What YARP prints for the bottle."""
        return self.bottle().toString()


def _text(octets: bytes) -> str:
    return octets.decode("utf-8", "surrogateescape")


BOTTLE = Manners(
    BottleMessage,
    PLAIN.array_type,
    PLAIN.sequence,
    PLAIN.mapping,
    assigns_whole=True,
    members=PLAIN.members,
    serialising=("yarp", "yarp4"),
    place="rosetta_jit.frameworks.yarp.manners:BOTTLE",
)
"""The manners of messages of YARP."""
