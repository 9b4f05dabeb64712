"""Messages in datagrams: a frame is cut into pieces, and whole again where each piece has come in its turn.

    datagram = u32 CRC-32 of the piece, i32 number of the piece within its message, piece

All little-endian. The pieces of a message, one behind the other, are its frame (`rosetta_jit.transports.yarp.wire`); nearly always there
is one. A message has no number of its own, so that pieces of two messages are told apart by their order alone. Number -1 means nothing:
with it a port of YARP wakes its own reader.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING
from zlib import crc32

from rosetta_jit.transports.feeding import Feed, ProtocolError

if TYPE_CHECKING:
    from rosetta_jit.transports.feeding import Machine

    Bytes = bytes | bytearray | memoryview

HEAD = struct.Struct("<Ii")
MOST = 65_507 - HEAD.size
"""Bytes of a datagram of YARP's: those of UDP less eight that are subtracted twice."""

PIECE = MOST - HEAD.size
NOTHING = -1

STRANGE = "a datagram that is none of YARP's"
DAMAGED = "a datagram with a wrong checksum"
MISSING = "a piece of the message is missing, or came out of order"
TWICE = "a piece that came twice was ignored"


def cut(head: bytes, data: Bytes) -> Iterator[tuple[Bytes, ...]]:
    """The datagrams of a message, as parts that lie one behind the other; ``head`` is all of the frame before its payload."""
    view, first = memoryview(data), PIECE - len(head)
    yield _datagram(0, head, view[:first])
    for number, at in enumerate(range(first, len(view), PIECE), 1):
        yield _datagram(number, view[at : at + PIECE])


def _datagram(number: int, *parts: Bytes) -> tuple[Bytes, ...]:
    checksum = 0
    for each in parts:
        checksum = crc32(each, checksum)
    return HEAD.pack(checksum, number), *parts


class Pieces:
    """Puts the datagrams of one writer together.

    Parameters
    ----------
    machine
        Makes a generator that reads frames, as of a stream. A message that cannot be completed costs this generator, and the next message
        gets a new one.
    lose
        Takes the reason why a message, or a datagram, was dropped.

    Attributes
    ----------
    ended
        Whether the writer has said goodbye.
    """

    def __init__(self, machine: Callable[[], Machine], lose: Callable[[str], object]) -> None:
        self.ended = False
        self._machine = machine
        self._lose = lose
        self._feed = Feed(machine())
        self._next = 0
        self._checksum = 0
        self._is_lost = False

    @property
    def size(self) -> int:
        """Bytes of memory that it holds."""
        return self._feed.size

    @property
    def is_between(self) -> bool:
        """Whether no message has begun, or the one that has is lost already."""
        return self._feed.is_between

    def take(self, datagram: memoryview) -> None:
        """Take one datagram, and hand on the message that is whole now."""
        if len(datagram) < HEAD.size:
            self._lose(STRANGE)
            return
        checksum, number = HEAD.unpack_from(datagram)
        piece = datagram[HEAD.size :]
        if number == NOTHING:
            return
        if crc32(piece) != checksum:
            self._lose(DAMAGED)
        elif self._is_twice(number, checksum):
            self._lose(TWICE)
        elif number == 0 or (number == self._next and not self._feed.is_between):
            if number == 0 and not self._feed.is_between:
                self._give_up(MISSING)
            self._next, self._checksum, self._is_lost = number + 1, checksum, False
            self._put(piece)
        else:
            self._skip(number)

    def gap(self) -> None:
        """Some datagrams were lost here: what comes next may belong to another message, whatever its number is."""
        if not self._feed.is_between:
            self._give_up(MISSING)

    def close(self) -> None:
        """No more comes."""
        self.ended = True
        self._feed.close()

    def _is_twice(self, number: int, checksum: int) -> bool:
        """Whether it is the last piece once more. A message of one piece that comes again looks like a new one."""
        is_last = number == self._next - 1 and checksum == self._checksum and not self._is_lost
        return is_last and (number > 0 or not self._feed.is_between)

    def _put(self, piece: memoryview) -> None:
        try:
            self._feed.feed(piece)
        except ProtocolError as error:
            self._give_up(str(error))
        self.ended = self.ended or self._feed.done

    def _skip(self, number: int) -> None:
        """A piece that does not belong here: the message is lost, and counted once, however many of its pieces are to come."""
        if not self._is_lost or not 0 < number >= self._next:
            self._give_up(MISSING)
        self._next = number + 1

    def _give_up(self, why: str) -> None:
        self._lose(why)
        self._is_lost = True
        self._feed.close()
        self._feed = Feed(self._machine())
