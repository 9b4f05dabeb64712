"""Sockets for datagrams in the loop: what comes is handed on, and what the system dropped because nobody read it in time is counted."""

from __future__ import annotations

import ipaddress
import socket
import struct
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from rosetta_jit.transports.connecting import taken
from rosetta_jit.transports.limits import MAX_DATAGRAM
from rosetta_jit.transports.loop import READ, loop

if TYPE_CHECKING:
    from rosetta_jit.transports.end import End

AT_ONCE = 64
"""Datagrams that are read before another socket has its turn."""

BUFFER_BYTES = 4 << 20
"""What the kernel is asked to keep; it gives less where its limits say so."""

SO_RXQ_OVFL = 40 if sys.platform == "linux" else 0
"""Linux tells with each datagram how many it has dropped so far (socket(7)); the number is that of asm-generic/socket.h."""

_COUNT = struct.Struct("@I")
_ROOM = socket.CMSG_SPACE(_COUNT.size)


def bound(place: tuple[Any, ...], *, family: int = socket.AF_INET, interface: str = "127.0.0.1") -> socket.socket:
    """A socket that gets the datagrams for an address; where that is a group's, it joins it, at one interface.

    Raises
    ------
    TransportError
        The address is taken, or is not one of this machine.
    """
    sock = socket.socket(family, socket.SOCK_DGRAM)
    try:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER_BYTES)
        if ipaddress.ip_address(place[0]).is_multicast:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            _join(sock, place[0], interface)
        sock.bind(place)
    except (OSError, OverflowError) as error:
        sock.close()
        raise taken((family, place), error) from None
    sock.setblocking(False)
    return sock


def sending(family: int, host: str, interface: str) -> socket.socket:
    """A socket that sends datagrams to a host, or to a group by an interface; what is sent over loopback stays there."""
    sock = socket.socket(family, socket.SOCK_DGRAM)
    sock.setblocking(False)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER_BYTES)
    if family == socket.AF_INET and ipaddress.ip_address(host).is_multicast:
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(interface))
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0 if interface.startswith("127.") else 1)
    return sock


class Datagrams:
    """A bound socket in the loop.

    Parameters
    ----------
    take
        Is called with each datagram and its sender's address, in the loop's thread. The memory is valid until it returns.
    counts
        Of the source that it belongs to.
    most
        Larger datagrams are lost.
    gap
        Is called before a datagram where the system says that it has dropped others before it.
    """

    def __init__(
        self,
        sock: socket.socket,
        take: Callable[[memoryview, Any], object],
        counts: End,
        *,
        most: int = MAX_DATAGRAM,
        gap: Callable[[], object] | None = None,
    ) -> None:
        self.socket = sock
        self._take = take
        self._gap = gap
        self._counts = counts
        self._buffer = memoryview(bytearray(min(most, MAX_DATAGRAM) + 1))
        self._overflown = 0
        with suppress(OSError):  # other systems do not tell
            sock.setsockopt(socket.SOL_SOCKET, SO_RXQ_OVFL, 1)

    def start(self) -> None:
        """Begin to read; in the loop's thread."""
        loop().watch(self.socket.fileno(), READ, self._ready)

    def stop(self) -> None:
        """Read no more; in the loop's thread."""
        if self.socket.fileno() >= 0:
            loop().unwatch(self.socket.fileno())
            self.socket.close()

    def drain(self) -> None:
        """Read what has come; in the loop's thread."""
        self._ready(READ)

    def _ready(self, _: int) -> None:
        buffer, counts, take = self._buffer, self._counts, self._take
        for _ in range(AT_ONCE):
            if self.socket.fileno() < 0:
                return
            try:
                size, ancillary, _, sender = self.socket.recvmsg_into((buffer,), _ROOM)
            except BlockingIOError:
                return
            except OSError as error:
                counts.lose(error.strerror or "the socket failed", 0)
                return
            if ancillary:
                self._overflow(ancillary)
            if size == len(buffer):
                counts.lose("a message larger than max_message")
                continue
            take(buffer[:size], sender)

    def _overflow(self, ancillary: list[tuple[int, int, bytes]]) -> None:
        """The system says how many datagrams it has dropped since the socket was made."""
        for level, kind, data in ancillary:
            if (level, kind, len(data)) == (socket.SOL_SOCKET, SO_RXQ_OVFL, _COUNT.size):
                (count,) = _COUNT.unpack(data)
                if missed := (count - self._overflown) & 0xFFFFFFFF:
                    self._overflown = count
                    self._counts.lose("the system's receive buffer was full", missed)
                    if self._gap is not None:
                        self._gap()


def _join(sock: socket.socket, group: str, interface: str) -> None:
    if sock.family == socket.AF_INET6:
        sock.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_JOIN_GROUP, socket.inet_pton(socket.AF_INET6, group) + struct.pack("@I", 0))
    else:
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group) + socket.inet_aton(interface))
