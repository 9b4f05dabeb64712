"""Remote procedure calls over TCP or Unix sockets: a frame is a question, the next frame back is its answer."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Mapping
from time import monotonic, time_ns
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message
from rosetta_jit.transports.calls import Caller, Pending, Server
from rosetta_jit.transports.sockets.framing import framed, messages
from rosetta_jit.transports.sockets.tcp import Links, waited
from rosetta_jit.transports.stream import Stream

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.feeding import Machine


class TcpCaller(Caller):
    """Sends questions over one connection; answers come in their order."""

    def __init__(self, address: Address, options: Mapping[str, Any]) -> None:
        super().__init__(address, options)
        self._channel = address.rest
        self._frame: str = options["frame"]
        self._pending: deque[Pending] = deque()
        self._order = threading.Lock()
        self._links = Links(address, self, self._machine, listen=options["listen"] == "yes", went=self._lost)

    def ask(self, data: bytes | bytearray | memoryview, until: float, attributes: Mapping[str, Any]) -> Message:
        del attributes
        parts = framed(self._frame, data, self._most, self.address)
        pending = Pending()
        with self._order:
            stream = next(iter(waited(self._links, until - monotonic())), None)
            if stream is None:
                raise TransportError("unreachable", self.address, "nobody answers there")
            self._pending.append(pending)
            if not stream.send(*parts):
                self._pending.remove(pending)
                raise TransportError("closed", self.address, "the connection is gone, or too slow")
        self.passed(len(data))
        try:
            return pending.wait(until, self.address)
        except TransportError as error:
            if error.kind == "timeout":  # a late answer would be taken for that of the next question
                stream.finish(0)
            raise

    def close(self) -> None:
        self._links.close(0)
        self._lost()

    def _machine(self, stream: Stream) -> Machine:
        def take(data: memoryview) -> None:
            if self._pending:
                self._pending.popleft().answer(Message(data, self._channel, None, time_ns()))
            else:
                stream.finish(0)

        return messages(self._frame, take, self._most)

    def _lost(self) -> None:
        while self._pending:
            self._pending.popleft().fail(TransportError("closed", self.address, "the connection ended before the answer came"))


def serve(address: Address, server: Server, options: Mapping[str, Any]) -> None:
    """Answer who connects. A question whose answer fails ends its connection: frames have no other way to say so."""
    frame, most, channel = options["frame"], options["max_message"], address.rest

    def machine(stream: Stream) -> Machine:
        def reply(answer: bytes | None, error: str | None) -> None:
            if error is not None:
                stream.finish(0)
            else:
                stream.send(*framed(frame, answer or b"", most, server.address))

        return messages(frame, lambda data: server.asked(Message(data, channel, None, time_ns(), None, {"peer": stream.peer}), reply), most)

    links = Links(address, server, machine, listen=options["listen"] != "no")
    server.opened(lambda: links.close(options["linger"]))
