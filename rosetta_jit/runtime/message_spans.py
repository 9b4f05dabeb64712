"""The begins and ends of many messages in one buffer."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np

from rosetta_jit.runtime.memory import address_of, has_references, no_message
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class MessageSpans:
    """Message ``first + i`` is bytes ``begins[i]`` to ``ends[i]``; between messages there may be other bytes.

    Attributes
    ----------
    begins, ends : ndarray of int64, shape (n,)
        Contiguous in memory, because compiled code reads them. They are not checked against any buffer.
    apart : int
        How many bytes ``ends`` lies behind ``begins``, where both are of one array; 0 where that is not known.
    first : int
        The number of the first message.
    """

    begins: NDArray[np.int64]
    ends: NDArray[np.int64]
    apart: int = 0
    first: int = 0

    @classmethod
    def of(cls, offsets: NDArray[np.int64]) -> Self:
        """From offsets of shape (n + 1,), of messages that lie one behind the other, or begins and ends of shape (2, n).

        Raises
        ------
        ValueError
            They are not int64, or of another shape.
        """
        found = np.ascontiguousarray(offsets)
        if found.dtype == np.int64 and found.ndim == 1 and found.size:
            return cls(found[:-1], found[1:], 8)
        if found.dtype == np.int64 and found.ndim == 2 and len(found) == 2:
            return cls(found[0], found[1], found.strides[0])
        raise ValueError(
            "offsets are an int64 array of one dimension, one longer than there are messages, or of two rows: begins and ends of messages"
        )

    def __len__(self) -> int:
        return len(self.begins)

    @property
    def addresses(self) -> tuple[int, int]:
        """The addresses of begins and ends, for compiled code: where those of message 0 would lie."""
        before, begins = self.begins.itemsize * self.first, _address_of(self.begins)
        return begins - before, (begins + self.apart if self.apart else _address_of(self.ends)) - before

    def span(self, number: int) -> tuple[int, int]:
        """The first byte of a message, and the one behind its last."""
        return int(self.begins[number - self.first]), int(self.ends[number - self.first])

    def are_in(self, number: int, size: int) -> bool:
        """Whether a message lies in a buffer of so many bytes."""
        begin, end = self.span(number)
        return 0 <= begin <= end <= size

    def broken(self, number: int, size: int) -> ValueError:
        """The error of a message that does not lie in a buffer of so many bytes."""
        begin, end = self.span(number)
        return ValueError(f"offsets {begin} and {end} of message {number} fall, or leave the buffer of {size} bytes")


def _address_of(numbers: NDArray[np.int64]) -> int:
    return address_of(numbers) if numbers.size and numbers.flags.writeable else numbers.ctypes.data


def laid_out(messages: Any, offsets: NDArray[np.int64] | None) -> tuple[bytes | memoryview, MessageSpans]:
    """Messages in one buffer, and where each of them lies in it.

    Raises
    ------
    TypeError
        There are no offsets, and the messages are one buffer; there are, and they are several; or one of them has no bytes.
    BufferError
        One of them is an array of references to objects.
    ValueError
        The offsets are of another type or shape.
    """
    if offsets is None:
        messages, offsets = together(messages)
    elif not _is_buffer(messages):
        raise TypeError(
            f"offsets are places in one buffer, and not in a {type(messages).__name__}; the batch that is to be filled is `into=…`"
        )
    return source_of(messages), MessageSpans.of(offsets)


def together(messages: Any) -> tuple[bytes, NDArray[np.int64]]:
    """Messages one behind the other, and where each begins and the last ends. Raises as `laid_out`."""
    if not isinstance(messages, list) and (isinstance(messages, str) or not isinstance(messages, Iterable) or _is_buffer(messages)):
        raise _no_messages(messages)
    pieces = list(cast("Iterable[Any]", messages))
    try:
        sizes = [len(each) if type(each) is bytes else _size_of(each) for each in pieces]
    except TypeError:
        number, strange = next((number, each) for number, each in enumerate(pieces) if not _is_buffer(each))
        raise TypeError(f"message {number} is no bytes-like object, but of the type {type(strange).__name__}") from None
    return b"".join(pieces), np.cumsum([0, *sizes], dtype=np.int64)


def _no_messages(messages: Any) -> TypeError:
    if _is_buffer(messages):
        return TypeError("messages in one buffer take offsets, which say where each begins; without them, give a list of messages")
    return TypeError(f"a list of messages is needed, or a buffer and offsets, not {type(messages).__name__}")


def _size_of(message: Any) -> int:
    view = message if type(message) is memoryview else memoryview(message)
    if has_references(view):
        raise no_message(message)
    return view.nbytes


def _is_buffer(value: Any) -> bool:
    """Whether a value has bytes; an array of objects has none, but what refers to them."""
    try:
        return type(value) is bytes or not has_references(memoryview(value))
    except TypeError:
        return False


def source_of(message: Any) -> bytes | memoryview:
    """What has the bytes of a message: asked once, because an object need not give out the same memory twice."""
    return message if isinstance(message, bytes) else memoryview(message)
