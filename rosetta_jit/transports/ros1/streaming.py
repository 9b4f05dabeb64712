"""Topics: publications and subscriptions of a node."""

from __future__ import annotations

from collections.abc import Mapping
from time import monotonic
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Sink, Source
from rosetta_jit.transports.conversation import connected
from rosetta_jit.transports.feeding import Between
from rosetta_jit.transports.limits import MAX_CONNECTIONS
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.ros1.node import Node, graph_name, nodes, refuse, uris_in
from rosetta_jit.transports.ros1.tcpros import LENGTH, disagreement, header, messages, read_header
from rosetta_jit.transports.ros1.xmlrpc import ask
from rosetta_jit.transports.stream import Stream, finish_all

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost
    from rosetta_jit.transports.feeding import Machine

CONNECT_S = 3.0
AGAIN_S = 0.5
_BETWEEN = Between(1)


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Receive what all publishers of a topic send."""
    topic, node = graph_name(address), nodes().enter(options)
    subscription = Subscription(node, topic, source, options)
    try:
        node.add(subscription, patient=options["patient"])
    except TransportError:
        nodes().leave(node)
        raise

    def close() -> None:
        node.remove(subscription)
        subscription.close()
        nodes().leave(node)

    source.opened(close)


def topics(address: Address, options: Mapping[str, Any]) -> list[tuple[str, str | None]]:
    """The topics that the master knows, with their types."""
    node = nodes().enter(options)
    try:
        found: Any = node.ask("getTopicTypes")
        return [(str(name), str(type_)) for name, type_ in sorted(found) if name.startswith(address.rest)]
    except (ValueError, TypeError, AttributeError):
        raise TransportError("protocol", node.master, "what answers there is no master of ROS 1") from None
    finally:
        nodes().leave(node)


class Subscription:
    """The connections to the publishers of one topic: made when the master names them, and again when they are lost."""

    kind = "subscriber"

    def __init__(self, node: Node, topic: str, source: Source, options: Mapping[str, Any]) -> None:
        self.name, self.type = topic, options["type"]
        self._node, self._source, self._most = node, source, options["max_message"]
        self._wanted = {"callerid": node.name, "topic": topic, "type": self.type, "md5sum": options["md5"], "tcp_nodelay": "1"}
        self._uris: set[str] = set()
        self._streams: dict[str, Stream] = {}
        self._seen: set[str] = set()
        self._closed = False

    def register(self) -> None:
        """Tell the master, which names the publishers."""
        self.publishers(uris_in(self._node.ask("registerSubscriber", self.name, self.type, self._node.uri)))

    def unregister(self) -> None:
        """Tell the master."""
        self._node.ask("unregisterSubscriber", self.name, self._node.uri)

    def publishers(self, uris: list[str]) -> None:
        """These there are now. Connections to others end by themselves, when their publisher does."""
        self._uris = set(uris)
        for uri in uris:
            self._node.soon(lambda uri=uri: self._connect(uri))

    def talk(self, stream: Stream, fields: Mapping[str, str]) -> Machine:
        """Nobody connects to a subscriber."""
        del fields
        raise refuse(stream, "a subscriber")

    def left(self, stream: Stream, why: str) -> None:
        """Nothing to do: others do not connect to a subscription."""

    def close(self) -> None:
        """End all connections."""
        self._closed = True
        for each in tuple(self._streams.values()):
            each.finish(0.1)

    def _connect(self, uri: str) -> None:
        """Ask a publisher where it listens, and connect; in the node's thread."""
        if self._closed or uri in self._streams or uri not in self._uris:
            return
        try:
            place = ask(uri, "requestTopic", self._node.name, self.name, [["TCPROS"]])
            match place:
                case ["TCPROS", str(host), int(port)] if 0 < port < 65536:
                    sock = connected(host, port, CONNECT_S)
                case _:
                    self._source.lose("a publisher that does not speak TCPROS", 0)
                    return
        except (TransportError, OSError):
            self._later(uri)
            return
        stream = Stream(sock, self._machine, lambda _, why: self._gone(uri, why))
        self._streams[uri] = stream
        loop().run(stream.start)

    def _later(self, uri: str) -> None:
        loop().run(lambda: loop().later(AGAIN_S, lambda: self._node.soon(lambda: self._connect(uri))))

    def _machine(self, stream: Stream) -> Machine:
        stream.within(CONNECT_S, "a publisher that said nothing")
        stream.send(header(self._wanted))
        fields = yield from read_header()
        stream.in_time()
        if "error" in fields:
            raise refuse(stream, f"the publisher refuses: {fields['error'][:300]}")
        if wrong := disagreement(self._wanted, fields):
            raise refuse(stream, wrong)
        source = self._source
        attributes = {
            "callerid": fields.get("callerid", ""),
            "md5": fields.get("md5sum", ""),
            "definition": fields.get("message_definition", ""),
            "latching": fields.get("latching") == "1",
        }
        publisher = fields.get("callerid", "")
        source.reconnects += publisher in self._seen
        if len(self._seen) < MAX_CONNECTIONS:
            self._seen.add(publisher)
        source.connections = len(self._streams)
        yield from messages(source.taker(self.name, fields.get("type"), attributes), self._most)

    def _gone(self, uri: str, why: str) -> None:
        stream = self._streams.pop(uri, None)
        self._source.connections = len(self._streams)
        if self._closed:
            return
        if why or (stream is not None and stream.cut):
            refused = why.startswith(("another ", "the publisher refuses"))
            self._source.lose(why or "the connection ended in the middle of a message", 0 if refused else 1)
            if refused:
                return
        loop().later(AGAIN_S, lambda: self._node.soon(lambda: self._connect(uri)))


class RosSink(Sink):
    """Sends to all subscribers of a topic; the last message again to later ones, where it is latched."""

    kind = "publisher"

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        self.name, self.type = graph_name(address), options["type"]
        if "*" in (self.type, options["md5"]):
            raise TransportError(
                "type", str(address), "a publisher of ROS 1 says its type: `type=std_msgs/String&md5=992ce8a1687cec8c8bd883ec73ca41d1`"
            )
        self._most, self._linger, self._timeout = options["max_message"], options["linger"], options["timeout"]
        self._latched: bytes | None = None
        self._latch: bool = options["latch"]
        self._streams: set[Stream] = set()
        self._closed = False
        self._node = nodes().enter(options)
        self._own_header = {
            "callerid": self._node.name,
            "topic": self.name,
            "type": self.type,
            "md5sum": options["md5"],
            "latching": "1" if self._latch else "0",
            "message_definition": options["definition"],
        }
        try:
            self._node.add(self, patient=options["patient"])
        except TransportError:
            nodes().leave(self._node)
            raise

    def register(self) -> None:
        """Tell the master, which tells the subscribers."""
        self._node.ask("registerPublisher", self.name, self.type, self._node.uri)

    def unregister(self) -> None:
        """Tell the master."""
        self._node.ask("unregisterPublisher", self.name, self._node.uri)

    def publishers(self, uris: list[str]) -> None:
        """Other publishers are no concern of this one."""

    def talk(self, stream: Stream, fields: Mapping[str, str]) -> Machine:
        """Answer a subscriber's header, and send from then on."""
        if wrong := disagreement(self._own_header, fields):
            raise refuse(stream, wrong)
        stream.send(header(self._own_header))
        if self._latched is not None:
            stream.send(LENGTH.pack(len(self._latched)), self._latched)
        self._streams.add(stream)
        self.connections = len(self._streams)
        while True:
            yield _BETWEEN

    def left(self, stream: Stream, why: str) -> None:
        """A subscriber is gone."""
        self._streams.discard(stream)
        self.connections = len(self._streams)
        if stream.unsent:
            self.lose("closed before it was sent" if self._closed else "the subscriber went away", stream.unsent.total())
        elif why:
            self.lose(why, 0)

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        del time, attributes
        if self._closed:
            raise TransportError("closed", self.address, "this sink is closed")
        self.check_size(len(data), self._most)
        if self._latch:
            self._latched = bytes(data)
        head, streams = LENGTH.pack(len(data)), tuple(self._streams)
        taken = not streams
        for each in streams:
            if each.send(head, data):
                taken = True
            else:
                self.lose("the subscriber is too slow")
        if taken:
            self.passed(len(data))
        return taken

    def at_once(self, data: bytes | bytearray | memoryview) -> bool:
        """Send to the only subscriber, where nothing is kept for later ones."""
        size, streams = len(data), tuple(self._streams)
        if len(streams) != 1 or self._latch or size > self._most or self._closed or not streams[0].send(LENGTH.pack(size), data):
            return False
        self.messages += 1
        self.bytes += size
        return True

    def flush(self, timeout: float = 5.0) -> bool:
        until = monotonic() + timeout
        return all(each.wait(max(until - monotonic(), 0), empty=True) for each in tuple(self._streams))

    def close(self) -> None:
        if self._closed:
            return
        self._closed = True
        self._node.remove(self)
        finish_all(self._streams, self._linger)
        nodes().leave(self._node)


def service_place(uri: str) -> tuple[str, int]:
    """Host and port of a service's URI, `rosrpc://host:port`.

    Raises
    ------
    TransportError
        It is none.
    """
    try:
        place = urlsplit(uri)
        if place.scheme == "rosrpc" and place.hostname and place.port:
            return place.hostname, place.port
    except ValueError:
        pass
    raise TransportError("protocol", uri[:200], "the master names a service that is at no place")
