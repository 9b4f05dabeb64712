"""Writers that send to a port by udp and mcast: their hello and goodbye come by TCP, their messages as datagrams."""

from __future__ import annotations

import ipaddress
import socket
from collections.abc import Callable
from time import monotonic

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.datagrams import Datagrams, bound
from rosetta_jit.transports.end import End
from rosetta_jit.transports.feeding import FIRST_BYTES, ProtocolError
from rosetta_jit.transports.limits import MAX_HELD_BYTES
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.yarp.incoming import Owner, messages
from rosetta_jit.transports.yarp.pieces import Pieces


class DatagramInput:
    """The datagrams of one writer, until it says goodbye; all in the loop's thread.

    Parameters
    ----------
    sock
        Bound, as `receiving` makes it.
    writer
        Its name, the carrier, and its address: datagrams of others are dropped.
    ended
        Is called once, with this input and with why it ended.

    Attributes
    ----------
    heard : float
        When the last datagram came, by the monotonic clock.
    cut : bool
        Whether it ended in the middle of a message.
    """

    def __init__(
        self,
        port: Owner,
        counts: End,
        sock: socket.socket,
        writer: tuple[str, str, str],
        ended: Callable[[DatagramInput, str], object],
    ) -> None:
        sender, carrier, self._host = writer
        self.heard = monotonic()
        self.cut = False
        self._counts, self._ended = counts, ended
        self._pieces = Pieces(lambda: messages(port, None, sender, carrier), counts.lose)
        self._held = 0
        self._datagrams = Datagrams(sock, self._take, counts, gap=self._pieces.gap)
        self._datagrams.start()

    @property
    def number(self) -> int:
        """The port of UDP."""
        return int(self._datagrams.socket.getsockname()[1])

    def finish(self, linger: float) -> None:
        """Read what has come, and close; from any thread."""
        del linger
        loop().soon(self._finish)

    def end(self, why: str = "") -> None:
        """Close now."""
        if self._datagrams.socket.fileno() < 0:
            return
        self._datagrams.stop()
        self.cut = not self._pieces.is_between
        self._pieces.close()
        loop().held_bytes -= self._held
        self._ended(self, why)

    def _finish(self) -> None:
        self._datagrams.drain()
        self.end()

    def _take(self, datagram: memoryview, sender: tuple[str, int]) -> None:
        if sender[0] != self._host:
            self._counts.lose("a datagram from another host than the writer's")
            return
        self.heard = monotonic()
        self._pieces.take(datagram)
        if self._pieces.size != self._held:
            loop().held_bytes += self._pieces.size - self._held
            self._held = self._pieces.size
            if loop().held_bytes > MAX_HELD_BYTES and self._held > FIRST_BYTES:
                self.end("large messages of all peers together take too much memory")
        if self._pieces.ended:
            self.end()


def receiving(line: socket.socket, group: tuple[str, int] | None) -> socket.socket:
    """A socket for what the peer of a connection will send: to a port of its own, or to a group, where this connection arrived.

    Raises
    ------
    ProtocolError
        The group is none, or cannot be joined.
    """
    here = line.getsockname()[0]
    try:
        if group is None:
            return bound((here, 0), family=line.family)
        if not ipaddress.ip_address(group[0]).is_multicast or not group[1] or line.family != socket.AF_INET:
            raise ProtocolError(f"{group[0]}:{group[1]} is no group of mcast")
        return bound(group, interface=here)
    except TransportError as error:
        raise ProtocolError(error.detail) from None
