"""Protocols as generators that ask for bytes: `head = yield 8`, `line = yield Until(delimiter, most)`, `yield Frames(length, take, most)`.

A generator knows no socket, so that a test feeds it a captured stream in pieces of any size. The memoryviews that it gets are valid until
it asks again.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import TYPE_CHECKING

from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from struct import Struct

    Machine = Generator["int | Until | Frames", memoryview, None]

LOOK_BYTES = 1024
"""That are looked through at a time for a delimiter: many short lines may have come at once."""

FIRST_BYTES = 1 << 16
"""Of a buffer, which grows as more bytes of a message really come."""


class Between(int):
    """So many bytes; and before the first of them the stream may end, as no message has begun."""

    __slots__ = ()


class Some(int):
    """All bytes that are there, at least one."""

    __slots__ = ()


SOME = Some(1)


@dataclass(frozen=True, slots=True)
class Until:
    """All bytes up to a delimiter, which is part of them; a failure where there are more than ``most``."""

    delimiter: bytes
    most: int
    between: bool = False


@dataclass(frozen=True, slots=True)
class Frames:
    """All messages from here to the end of the stream, each behind its length: a function gets them, and the generator nothing more.

    A message costs one call of ``take``; a generator that asks for length and message takes as long as all else between socket and message.
    Between two messages the stream may end. A message of more than ``most`` bytes is a failure.
    """

    length: Struct
    take: Callable[[memoryview], object]
    most: int


class ProtocolError(Exception):
    """The peer sent what the protocol does not have; it costs the peer its connection."""


def too_large(size: int, most: int) -> ProtocolError:
    """The error for a message above the limit."""
    return ProtocolError(f"a message of {size} bytes, more than max_message={most}")


class Feed:
    """The bytes that came and were not asked for yet, and the generator that asks.

    Attributes
    ----------
    done
        Whether the generator has returned: the connection has come to its end.
    size
        Bytes of memory that it holds.
    """

    __slots__ = ("_buffer", "_end", "_machine", "_searched", "_start", "_want", "done", "size")

    def __init__(self, machine: Machine) -> None:
        self._buffer = memoryview(bytearray(FIRST_BYTES))
        self.size = FIRST_BYTES
        self._start: int = 0
        self._end: int = 0
        self._searched: int = 0
        self._machine = machine
        self.done = False
        self._want: int | Until | Frames = 0
        try:
            self._want = next(machine)
        except StopIteration:
            self.done = True

    def receive(self, read_into: Callable[[memoryview], int]) -> bool:
        """Hand on what a function reads into the memory that it gets; False where that is nothing, as at the end of a stream.

        Raises
        ------
        ProtocolError
            The peer is wrong.
        """
        if self._start == self._end:
            self._start = self._end = self._searched = 0
            count = read_into(self._buffer)
        else:
            if self._end == self.size:
                self._make_room()
            count = read_into(self._buffer[self._end :])
        if not count:
            return False
        if self.done:  # what comes after the end is dropped
            return True
        self._end += count
        if not isinstance(self._want, Frames):
            self._pieces()
            if not isinstance(self._want, Frames):
                return True
        frames, buffer, start, end = self._want, self._buffer, self._start, self._end
        size: int
        head, take = frames.length.size, frames.take
        while end - start >= head and not self.done:
            (size,) = frames.length.unpack_from(buffer, start)
            if size > frames.most:
                raise too_large(size, frames.most)
            start += head
            if end - start < size:
                break
            self._start = stop = start + size
            take(buffer[start:stop])
            start = stop
        return True

    def _pieces(self) -> None:
        """Hand on to the generator what it asks for, as far as that has come."""
        send = self._machine.send
        while not self.done:
            want = self._want
            if isinstance(want, Frames):
                return
            if isinstance(want, int):
                stop = self._start + want
                if stop > self._end:
                    return
                if want is SOME:
                    stop = self._end
            elif not (stop := self._found(want)):
                return
            piece = self._buffer[self._start : stop]
            self._start = self._searched = stop
            try:
                self._want = send(piece)
            except StopIteration:
                self.done = True

    def feed(self, data: bytes | memoryview) -> None:
        """Hand on bytes that lie elsewhere; as `receive`."""
        rest = memoryview(data)

        def read_into(room: memoryview) -> int:
            nonlocal rest
            count = min(len(room), len(rest))
            room[:count] = rest[:count]
            rest = rest[count:]
            return count

        while rest:
            self.receive(read_into)

    @property
    def is_between(self) -> bool:
        """Whether the stream may end here: no message has begun."""
        if self.done:
            return True
        may_end = isinstance(self._want, Between | Frames) or (isinstance(self._want, Until) and self._want.between)
        return may_end and self._start == self._end

    def close(self) -> None:
        """Let the generator end."""
        self.done = True
        self._machine.close()

    def _found(self, want: Until) -> int:
        """The position behind the delimiter; 0 where it has not come yet."""
        size = len(want.delimiter)
        base, end = max(self._start, self._searched - size + 1), min(self._end, self._start + want.most)
        while end - base >= size:
            piece = bytes(self._buffer[base : min(base + LOOK_BYTES, end)])
            at = piece.find(want.delimiter)
            if at >= 0:
                return base + at + size
            base += max(len(piece) - size + 1, 1)
        if self._end - self._start >= want.most:
            raise ProtocolError(f"no end of line within {want.most} bytes")
        self._searched = self._end
        return 0

    def _make_room(self) -> None:
        """Move what is left to the front, of a larger buffer where one message fills this one."""
        left = self._end - self._start
        buffer = self._buffer
        if left > len(buffer) // 2:
            buffer = memoryview(bytearray(max(2 * len(buffer), min(self._wanted(), 4 * len(buffer)))))
            self.size = len(buffer)
        if left:
            buffer[:left] = self._buffer[self._start : self._end]
        self._searched = max(self._searched - self._start, 0)
        self._buffer, self._start, self._end = buffer, 0, left

    def _wanted(self) -> int:
        """Bytes that are to come before anything is handed on, as far as that is known."""
        match self._want:
            case int():
                return self._want
            case Frames(length=length) if self._end - self._start >= length.size:
                return length.size + int(length.unpack_from(self._buffer, self._start)[0])
            case _:
                return 0
