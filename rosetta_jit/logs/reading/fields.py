"""Fields of a record, one after the other; ValueError where it ends too early."""

from __future__ import annotations

from collections.abc import Iterator
from struct import Struct
from typing import Any

U16, U32, U64 = Struct("<H"), Struct("<I"), Struct("<Q")


class Fields:
    """A place in the bytes of a record."""

    def __init__(self, data: bytes | memoryview, at: int = 0) -> None:
        self._data, self.at = memoryview(data), at

    @property
    def left(self) -> int:
        """How many bytes are left."""
        return len(self._data) - self.at

    def bytes(self, size: int) -> bytes:
        """So many bytes."""
        return bytes(self.view(size))

    def view(self, size: int) -> memoryview:
        """The same, not copied."""
        if not 0 <= size <= len(self._data) - self.at:
            raise ValueError(f"{size} bytes are promised, and {self.left} are left")
        self.at += size
        return self._data[self.at - size : self.at]

    def some(self, form: Struct) -> tuple[Any, ...]:
        """Several values of fixed size."""
        return form.unpack(self.view(form.size))

    def u16(self) -> int:
        return self.some(U16)[0]

    def u32(self) -> int:
        return self.some(U32)[0]

    def u64(self) -> int:
        return self.some(U64)[0]

    def text(self) -> str:
        """A length of 32 bits and that many bytes of UTF-8; a byte that is none becomes a replacement character."""
        return self.bytes(self.u32()).decode("utf-8", "replace")

    def inner(self) -> Fields:
        """A length of 32 bits, and the fields in that many bytes."""
        return Fields(self.view(self.u32()))

    def rest(self) -> memoryview:
        """All that is left."""
        return self.view(self.left)

    def while_left(self) -> Iterator[Fields]:
        """Itself, again and again until nothing is left."""
        while self.left:
            yield self
