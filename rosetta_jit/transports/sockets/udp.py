"""A message a datagram, to and from one address or a group."""

from __future__ import annotations

import socket
from collections.abc import Mapping
from time import time_ns
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message, Sink, Source
from rosetta_jit.transports.datagrams import Datagrams, bound, sending
from rosetta_jit.transports.limits import MAX_DATAGRAM
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.sockets.endpoints import targets

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Receive the datagrams for a port; where the address is a group's, join it."""
    family, place = targets(address, socket.SOCK_DGRAM)[0]
    channel = address.rest

    def take(data: memoryview, sender: Any) -> None:
        source.arrived(Message(data, channel, None, time_ns(), None, {"sender": sender}))

    sock = bound(place, family=family, interface=options["interface"])
    receiver = Datagrams(sock, take, source, most=options["max_message"])
    source.connections = 1
    loop().run(receiver.start)

    def close() -> None:
        loop().run(receiver.stop)
        source.connections = 0

    source.opened(close)


class UdpSink(Sink):
    """Sends each message as one datagram; nobody says whether it arrived."""

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        family, self._place = targets(address, socket.SOCK_DGRAM)[0]
        self._most = min(options["max_message"], MAX_DATAGRAM)
        self._socket = sending(family, self._place[0], options["interface"])

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        del time, attributes
        if len(data) > self._most:
            raise TransportError("too large", self.address, f"{len(data)} bytes; a datagram has at most {self._most}")
        try:
            self._socket.sendto(data, self._place)
        except BlockingIOError:
            self.lose("the system's queue is full")
            return False
        except OSError as error:
            if self._socket.fileno() < 0:
                raise TransportError("closed", self.address, "this sink is closed") from None
            self.lose(error.strerror or "the socket failed")
            return False
        self.passed(len(data))
        return True

    def close(self) -> None:
        self._socket.close()
