"""Remote procedure calls between ports: a message with a wish for a reply, which comes as bytes without a length."""

from __future__ import annotations

import socket
import threading
from collections.abc import Mapping
from time import monotonic, sleep, time_ns
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message
from rosetta_jit.transports.calls import Caller, Pending, Server
from rosetta_jit.transports.conversation import connected
from rosetta_jit.transports.feeding import SOME, ProtocolError
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.stream import Stream
from rosetta_jit.transports.yarp.bottles import WIDTHS, length_of
from rosetta_jit.transports.yarp.names import Contact, name_server, port_name
from rosetta_jit.transports.yarp.port import Port, own_name
from rosetta_jit.transports.yarp.wire import ACK, head_of, hello, int_of

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.feeding import Machine

RETRY_S = 0.05


def serve(address: Address, server: Server, options: Mapping[str, Any]) -> None:
    """Open a port that answers; YARP has no errors: who asks gets an empty bottle where the answer fails."""
    port = Port(port_name(address), name_server(options, address), options, server, take=_not_asked, asked=server.asked)
    server.opened(lambda: port.close(options["linger"]))


def _not_asked(_: Message) -> None:
    """Messages that want no reply are none of a server's business."""


class YarpCaller(Caller):
    """Asks one port, one question after the other; connects again when the connection is gone."""

    def __init__(self, address: Address, options: Mapping[str, Any]) -> None:
        super().__init__(address, options)
        self._target = port_name(address)
        self._names = name_server(options, address)
        self._name = options["name"] or own_name({"name": ""}, self._target).lstrip("/")  # without a slash: it is not registered
        self._turn = threading.Lock()
        self._stream: Stream | None = None
        self._pending: Pending | None = None
        self._closed = False

    def ask(self, data: bytes | bytearray | memoryview, until: float, attributes: Mapping[str, Any]) -> Message:
        with self._turn:
            stream = self._connected(until)
            pending = self._pending = Pending()
            if not stream.send(head_of(len(data), reply=True, envelope=attributes.get("envelope")), data):
                raise TransportError("closed", self.address, "the connection is gone")
            self.passed(len(data))
            try:
                return pending.wait(until, self.address)
            except TransportError as error:
                if error.kind == "timeout":  # a late reply would be taken for that of the next question
                    loop().run(stream.end)
                raise
            finally:
                self._pending = None

    def close(self) -> None:
        self._closed = True
        stream = self._stream
        if stream is not None:
            stream.finish(0.5)

    def _connected(self, until: float) -> Stream:
        if self._closed:
            raise TransportError("closed", self.address, "this caller is closed")
        if self._stream is not None and not self._stream.closed:
            return self._stream
        contact = self._names.query(self._target)
        if contact is None:
            raise TransportError("unknown", self.address, "the name server knows no such port")
        sock = self._connect(contact, until)
        if self._stream is not None:
            self.reconnects += 1
        self._stream = Stream(sock, self._machine, self._gone)
        self.connections = 1
        loop().run(self._stream.start)
        return self._stream

    def _connect(self, contact: Contact, until: float) -> socket.socket:
        """Connect; a port that was registered just now may not listen yet."""
        while True:
            try:
                return connected(contact.host, contact.port, max(until - monotonic(), 0.01))
            except OSError as error:
                if monotonic() + RETRY_S >= until or not isinstance(error, ConnectionRefusedError):
                    raise TransportError("unreachable", self.address, f"the port does not answer: {error.strerror or error}") from None
            sleep(RETRY_S)

    def _machine(self, stream: Stream) -> Machine:
        stream.send(hello("tcp", self._name))
        int_of((yield 8))
        while True:
            got = b""
            while not (got.endswith(ACK) and is_reply(got[: -len(ACK)])):
                got += bytes((yield SOME))
                if len(got) > self._most + len(ACK):
                    raise ProtocolError(f"a reply of more than max_message={self._most}")
            if self._pending is None:
                raise ProtocolError("a reply to no question")
            self._pending.answer(Message(got[: -len(ACK)], self._target, None, time_ns()))

    def _gone(self, _: Stream, why: str) -> None:
        self.connections = 0
        if self._pending is not None:
            self._pending.fail(TransportError("closed", self.address, why or "the connection ended before the reply came"))


def is_reply(data: bytes) -> bool:
    """Whether bytes are a whole reply: none, or one bottle of either dialect."""
    return not data or any(length_of(data, dialect) == len(data) for dialect in WIDTHS)
