"""Services: a connection a caller, which stays for further questions."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Mapping
from time import monotonic, time_ns
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message
from rosetta_jit.transports.calls import Caller, Pending, Server
from rosetta_jit.transports.conversation import connected
from rosetta_jit.transports.feeding import Between, ProtocolError
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.ros1.node import Node, graph_name, nodes, refuse
from rosetta_jit.transports.ros1.streaming import service_place
from rosetta_jit.transports.ros1.tcpros import LENGTH, disagreement, header, messages, read_header
from rosetta_jit.transports.stream import Stream

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.feeding import Machine

WORKED, FAILED = b"\1", b"\0"


class RosCaller(Caller):
    """Asks a service, one question after the other."""

    def __init__(self, address: Address, options: Mapping[str, Any]) -> None:
        super().__init__(address, options)
        self._service = graph_name(address)
        self._node = nodes().enter(options)
        self._wanted = {
            "callerid": self._node.name,
            "service": self._service,
            "md5sum": options["md5"],
            "type": options["type"],
            "persistent": "1",
        }
        self._turn = threading.Lock()
        self._greeted = threading.Event()
        self._stream: Stream | None = None
        self._pending: Pending | None = None
        self._closed = False

    def ask(self, data: bytes | bytearray | memoryview, until: float, attributes: Mapping[str, Any]) -> Message:
        del attributes
        with self._turn:
            pending = self._pending = Pending()
            stream = self._connected(until)
            try:
                if not stream.send(LENGTH.pack(len(data)), data):
                    pending.fail(TransportError("closed", self.address, "the connection is gone"))
                self.passed(len(data))
                return pending.wait(until, self.address)
            except TransportError as error:
                if error.kind == "timeout":  # a late answer would be taken for that of the next question
                    loop().run(stream.end)
                raise
            finally:
                self._pending = None

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            if self._stream is not None:
                self._stream.finish(0.5)
            nodes().leave(self._node)

    def _connected(self, until: float) -> Stream:
        if self._closed:
            raise TransportError("closed", self.address, "this caller is closed")
        if self._stream is not None and not self._stream.closed:
            return self._stream
        try:
            place = service_place(str(self._node.ask("lookupService", self._service)))
        except TransportError as error:
            if error.kind == "refused":
                raise TransportError("unknown", self.address, "the master knows no such service") from None
            raise
        try:
            sock = connected(*place, max(until - monotonic(), 0.01))
        except OSError as error:
            raise TransportError("unreachable", self.address, f"the service does not answer: {error.strerror or error}") from None
        self.reconnects += self._stream is not None
        self._stream = Stream(sock, self._machine, self._gone)
        self.connections = 1
        self._greeted.clear()
        loop().run(self._stream.start)
        self._greeted.wait(max(until - monotonic(), 0))  # rospy loses what comes before it has answered the header
        return self._stream

    def _machine(self, stream: Stream) -> Machine:
        stream.send(header(self._wanted))
        fields = yield from read_header()
        if "error" in fields:
            raise ProtocolError(f"the service refuses: {fields['error'][:300]}")
        if wrong := disagreement(self._wanted, fields):
            raise ProtocolError(wrong)
        attributes = {"callerid": fields.get("callerid", ""), "md5": fields.get("md5sum", "")}
        self._greeted.set()
        while True:
            worked = bytes((yield Between(1))) == WORKED
            (size,) = LENGTH.unpack((yield 4))
            if size > self._most:
                raise ProtocolError(f"an answer of {size} bytes, more than max_message={self._most}")
            data = yield size
            pending, self._pending = self._pending, None
            if pending is None:
                raise ProtocolError("an answer to no question")
            if worked:
                pending.answer(Message(data, self._service, fields.get("response_type"), time_ns(), None, attributes))
            else:
                text = bytes(data).decode("utf-8", "replace")[:2000]
                pending.fail(TransportError("refused", self.address, f"the service failed: {text}"))

    def _gone(self, _: Stream, why: str) -> None:
        self.connections = 0
        pending = self._pending
        if pending is not None:
            kind = "type" if "another " in why else "closed"
            pending.fail(TransportError(kind, self.address, why or "the connection ended before the answer came"))
        self._greeted.set()


def serve(address: Address, server: Server, options: Mapping[str, Any]) -> None:
    """Answer the calls of a service; a caller whose call fails gets the error's text."""
    node = nodes().enter(options)
    service = Service(node, graph_name(address), server, options)
    try:
        node.add(service, patient=options["patient"])
    except TransportError:
        nodes().leave(node)
        raise

    def close() -> None:
        node.remove(service)
        service.close()
        nodes().leave(node)

    server.opened(close)


class Service:
    """A service of a node, and the callers that are connected now."""

    kind = "service"

    def __init__(self, node: Node, name: str, server: Server, options: Mapping[str, Any]) -> None:
        self.name, self.type = name, options["type"]
        self._node, self._server, self._most = node, server, options["max_message"]
        self._streams: set[Stream] = set()
        host = f"[{node.host}]" if ":" in node.host else node.host
        self._uri = f"rosrpc://{host}:{node.port}"
        type_ = "" if self.type == "*" else self.type
        self._own_header = {
            "callerid": node.name,
            "md5sum": options["md5"],
            "type": self.type,
            "request_type": f"{type_}Request" if type_ else "*",
            "response_type": f"{type_}Response" if type_ else "*",
        }

    def register(self) -> None:
        """Tell the master."""
        self._node.ask("registerService", self.name, self._uri, self._node.uri)

    def unregister(self) -> None:
        """Tell the master."""
        self._node.ask("unregisterService", self.name, self._uri)

    def publishers(self, uris: list[str]) -> None:
        """A service has none."""

    def talk(self, stream: Stream, fields: Mapping[str, str]) -> Machine:
        """Answer a caller's header, and then its questions."""
        if wrong := disagreement(self._own_header, fields):
            raise refuse(stream, wrong)
        stream.send(header(self._own_header))
        if fields.get("probe") == "1":  # who looks whether the service is there
            return
        self._streams.add(stream)
        self._server.connections = len(self._streams)
        stays, attributes = fields.get("persistent") == "1", {"callerid": fields.get("callerid", "")}

        def reply(answer: bytes | None, error: str | None) -> None:
            data = error.encode() if error is not None else answer or b""
            stream.send(FAILED if error is not None else WORKED, LENGTH.pack(len(data)), data)
            if not stays:
                stream.finish(1.0)

        def take(data: memoryview) -> None:
            self._server.asked(Message(data, self.name, self._own_header["request_type"], time_ns(), None, attributes), reply)

        yield from messages(take, self._most)

    def left(self, stream: Stream, why: str) -> None:
        """A caller is gone."""
        self._streams.discard(stream)
        self._server.connections = len(self._streams)
        if why:
            self._server.lose(why, 0)

    def close(self) -> None:
        """End all connections, when what was answered is sent."""
        for each in deque(self._streams):
            each.finish(1.0)
