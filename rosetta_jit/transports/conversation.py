"""Short conversations with a peer, in a thread that waits: a whole conversation takes bounded time, however slowly the peer sends."""

from __future__ import annotations

import errno
import socket
from time import monotonic
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer


def connected(host: str, port: int, seconds: float) -> socket.socket:
    """A connected socket. The host may be one that a peer named.

    Raises
    ------
    OSError
        Nothing answers there in time, or no host has such a name.
    """
    try:
        return socket.create_connection((host, port), seconds)
    except (ValueError, OverflowError):  # no text that the encoding of hosts has
        raise OSError(errno.EHOSTUNREACH, "no such host") from None


class Conversation(socket.socket):
    """A connected socket that receives until a moment, and then raises `TimeoutError`: a peer that sends byte by byte gains no time."""

    until = float("inf")

    @classmethod
    def over(cls, sock: socket.socket, seconds: float) -> Self:
        """A conversation over a connected socket, which it takes over: the given object is closed."""
        made = cls(fileno=sock.detach())
        made.until = monotonic() + seconds
        made.settimeout(seconds)
        return made

    def recv(self, size: int, flags: int = 0, /) -> bytes:
        self._hurry()
        return super().recv(size, flags)

    def recv_into(self, buffer: WriteableBuffer, nbytes: int = 0, flags: int = 0) -> int:
        self._hurry()
        return super().recv_into(buffer, nbytes, flags)

    def _hurry(self) -> None:
        left = self.until - monotonic()
        if left <= 0:
            raise TimeoutError(errno.ETIMEDOUT, "no answer in time")
        self.settimeout(left)


def conversation(host: str, port: int, seconds: float) -> Conversation:
    """Connect, for a conversation of at most so many seconds. Raises as `connected`."""
    until = monotonic() + seconds
    return Conversation.over(connected(host, port, seconds), max(until - monotonic(), 0.001))
