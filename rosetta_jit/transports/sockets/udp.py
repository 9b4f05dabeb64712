"""A message a datagram, to and from one address or a group."""

from __future__ import annotations

import ipaddress
import socket
import struct
from time import time_ns
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message, Sink, Source
from rosetta_jit.transports.connecting import taken
from rosetta_jit.transports.limits import MAX_DATAGRAM
from rosetta_jit.transports.loop import READ, loop
from rosetta_jit.transports.sockets.places import targets

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost

AT_ONCE = 64
"""Datagrams that are read before another socket has its turn."""

BUFFER_BYTES = 4 << 20
"""What the kernel is asked to keep; it gives less where its limits say so."""


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Receive the datagrams for a port; where the address is a group's, join it."""
    family, place = targets(address, socket.SOCK_DGRAM)[0]
    sock = socket.socket(family, socket.SOCK_DGRAM)
    try:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER_BYTES)
        if ipaddress.ip_address(place[0]).is_multicast:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            _join(sock, place[0], options["interface"])
        sock.bind(place)
    except (OSError, OverflowError) as error:
        sock.close()
        raise taken((family, place), error) from None
    sock.setblocking(False)
    receiver = Receiver(sock, address.rest, source, options["max_message"])
    loop().run(receiver.start)
    source.opened(lambda: loop().run(receiver.stop))


class Receiver:
    """A socket for datagrams in the loop."""

    def __init__(self, sock: socket.socket, channel: str, source: Source, most: int) -> None:
        self._socket = sock
        self._channel = channel
        self._source = source
        self._buffer = memoryview(bytearray(min(most, MAX_DATAGRAM) + 1))

    def start(self) -> None:
        """Begin to read."""
        self._source.connections = 1
        loop().watch(self._socket.fileno(), READ, self._ready)

    def stop(self) -> None:
        """Read no more."""
        if self._socket.fileno() >= 0:
            loop().unwatch(self._socket.fileno())
            self._socket.close()
            self._source.connections = 0

    def _ready(self, _: int) -> None:
        buffer, source = self._buffer, self._source
        for _ in range(AT_ONCE):
            if self._socket.fileno() < 0:
                return
            try:
                size, sender = self._socket.recvfrom_into(buffer)
            except BlockingIOError:
                return
            except OSError as error:
                source.lose(error.strerror or "the socket failed", 0)
                return
            if size == len(buffer):
                source.lose("a message larger than max_message")
                continue
            source.arrived(Message(buffer[:size], self._channel, None, time_ns(), None, {"sender": sender}))


def publish(address: Address, options: Mapping[str, Any], lost: Lost | None) -> Sink:
    """Send datagrams to an address or a group."""
    return UdpSink(address, options, lost)


class UdpSink(Sink):
    """Sends each message as one datagram; nobody says whether it arrived."""

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        family, self._place = targets(address, socket.SOCK_DGRAM)[0]
        self._most = min(options["max_message"], MAX_DATAGRAM)
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER_BYTES)
        if family == socket.AF_INET and ipaddress.ip_address(self._place[0]).is_multicast:
            self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(options["interface"]))
            self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0 if options["interface"].startswith("127.") else 1)

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


def _join(sock: socket.socket, group: str, interface: str) -> None:
    if sock.family == socket.AF_INET6:
        sock.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_JOIN_GROUP, socket.inet_pton(socket.AF_INET6, group) + struct.pack("@I", 0))
    else:
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group) + socket.inet_aton(interface))
