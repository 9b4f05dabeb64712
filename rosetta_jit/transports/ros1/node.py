"""A node: what the master and other nodes know of this process, and the connections for its topics and services."""

from __future__ import annotations

import os
import re
import socket
import threading
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from itertools import count
from typing import TYPE_CHECKING, Any, Protocol, cast

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.connecting import Listener, resolve
from rosetta_jit.transports.feeding import ProtocolError
from rosetta_jit.transports.limits import MAX_CONNECTIONS, MAX_TASKS
from rosetta_jit.transports.processes import per_process
from rosetta_jit.transports.ros1.tcpros import header, read_header
from rosetta_jit.transports.ros1.xmlrpc import Answering, ask
from rosetta_jit.transports.stream import Stream

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.feeding import Machine

HEARTBEAT_S = 3.0
"""How often a node looks whether the master still knows it."""

SOON_S = 0.5
HEADER_S = 10.0
NAME = re.compile(r"/[A-Za-z][A-Za-z0-9_]*(/[A-Za-z0-9_]+)*")
_NUMBERS = count(1)


class Part(Protocol):
    """A publication, a subscription or a service of the node.

    `kind` and `name` say what it is; `register` and `unregister` tell the master; `talk` speaks with who connects for it.
    """

    kind: str
    name: str
    type: str

    def register(self) -> None: ...
    def unregister(self) -> None: ...
    def talk(self, stream: Stream, fields: Mapping[str, str]) -> Machine: ...
    def left(self, stream: Stream, why: str) -> None: ...
    def publishers(self, uris: list[str]) -> None: ...


class Node:
    """One node, for all that a process publishes, subscribes and serves at one master."""

    def __init__(self, master: str, host: str, name: str) -> None:
        self.master, self.host, self.name = master, host, name
        self.users = 0
        self._parts: list[Part] = []
        self._waiting: list[Part] = []
        self._tasks: deque[Callable[[], object]] = deque()
        self._nudge = threading.Event()
        self._stopped = False
        self._talking: dict[Stream, Part | None] = {}
        self._listener = Listener(resolve(host, 0)[0], self._accepted)
        self.port = self._listener.port
        self._answering = Answering(host, self._methods())
        shown = f"[{host}]" if ":" in host else host
        self.uri = f"http://{shown}:{self._answering.port}/"
        self._thread = threading.Thread(target=self._control, name=f"ros1 {name}", daemon=True)
        self._thread.start()

    def ask(self, method: str, *arguments: object) -> Any:
        """Call a method of the master, with the node's name as the first argument, and return its answer."""
        return ask(self.master, method, self.name, *arguments)

    def add(self, part: Part, *, patient: bool) -> None:
        """Register a part; later, where there is no master yet and it is patient.

        Raises
        ------
        TransportError
            There is no master, or it refuses; or this node publishes, or serves, the same already.
        """
        if part.kind != "subscriber" and self._part(part.kind, part.name) is not None:
            raise TransportError("taken", part.name, f"this node is its {part.kind} already: say another `name`")
        self._parts.append(part)
        try:
            part.register()
        except TransportError:
            if not patient:
                self._parts.remove(part)
                raise
            self._waiting.append(part)
            self._nudge.set()

    def remove(self, part: Part) -> None:
        """Unregister a part, and end its connections."""
        if part in self._parts:
            self._parts.remove(part)
            if self._part(part.kind, part.name) is None:
                with suppress(TransportError):
                    part.unregister()

    def soon(self, task: Callable[[], object]) -> None:
        """Do something that asks others, in the node's own thread."""
        if len(self._tasks) < MAX_TASKS:
            self._tasks.append(task)
        self._nudge.set()

    def close(self) -> None:
        """End the node."""
        self._stopped = True
        self._nudge.set()
        if self._thread is not threading.current_thread():
            self._thread.join(5)
        self._answering.close()
        self._listener.close()
        for stream in tuple(self._talking):
            stream.finish(0.5)

    def _control(self) -> None:
        while not self._stopped:
            self._nudge.wait(SOON_S if self._waiting else HEARTBEAT_S)
            was_nudged = self._nudge.is_set()
            self._nudge.clear()
            while self._tasks and not self._stopped:
                with suppress(TransportError):
                    self._tasks.popleft()()
            if not was_nudged and self._parts and not self._stopped:
                self._keep_registered()

    def _keep_registered(self) -> None:
        """A master that was started again knows nobody."""
        try:
            is_known = ask(self.master, "lookupNode", self.name, self.name) == self.uri
        except TransportError as error:
            if error.kind != "refused":
                return
            is_known = False
        again = self._waiting if is_known else list(self._parts)
        self._waiting = []
        for part in again:
            try:
                part.register()
            except TransportError:
                self._waiting.append(part)

    def _accepted(self, sock: socket.socket) -> None:
        if len(self._talking) >= MAX_CONNECTIONS or self._stopped:
            sock.close()
            return
        stream = Stream(sock, self._machine, self._gone)
        self._talking[stream] = None
        stream.start()

    def _machine(self, stream: Stream) -> Machine:
        stream.within(HEADER_S, "a connection that said nothing")
        fields = yield from read_header()
        stream.in_time()
        part = self._part("publisher", fields["topic"]) if "topic" in fields else self._part("service", fields.get("service", ""))
        if part is None:
            stream.send(header({"error": f"{self.name} has no such topic or service"}))
            return
        self._talking[stream] = part
        yield from part.talk(stream, fields)

    def _gone(self, stream: Stream, why: str) -> None:
        part = self._talking.pop(stream, None)
        if part is not None:
            part.left(stream, why)

    def _part(self, kind: str, name: str) -> Part | None:
        return next((each for each in self._parts if (each.kind, each.name) == (kind, name)), None)

    def _methods(self) -> dict[str, Callable[..., object]]:
        """The methods that other nodes may call, by name."""

        def of(kind: str) -> list[list[str]]:
            return [[each.name, each.type] for each in self._parts if each.kind == kind]

        nothing: list[Any] = []
        return {
            "requestTopic": self._request_topic,
            "publisherUpdate": self._publisher_update,
            "paramUpdate": lambda *_: [1, "", 0],
            "getPid": lambda *_: [1, "", os.getpid()],
            "getMasterUri": lambda *_: [1, "", self.master],
            "getName": lambda *_: [1, "", self.name],
            "getPublications": lambda *_: [1, "", of("publisher")],
            "getSubscriptions": lambda *_: [1, "", of("subscriber")],
            "getBusStats": lambda *_: [1, "", [nothing, nothing, nothing]],
            "getBusInfo": lambda *_: [1, "", nothing],
        }

    def _request_topic(self, _: str, topic: str, protocols: list[Any]) -> list[Any]:
        if self._part("publisher", topic) is None:
            return [-1, f"{self.name} does not publish that", 0]
        if not any(each and each[0] == "TCPROS" for each in protocols):
            return [0, "this node speaks TCPROS", 0]
        return [1, f"ready on {self.host}:{self.port}", ["TCPROS", self.host, self.port]]

    def _publisher_update(self, _: str, topic: str, uris: object) -> list[Any]:
        for part in tuple(self._parts):
            if (part.kind, part.name) == ("subscriber", topic):
                part.publishers(uris_in(uris))
        return [1, "", 0]


class Nodes:
    """The nodes of a process: one a master and a name."""

    def __init__(self) -> None:
        self._open: dict[tuple[str, str, str], Node] = {}
        self._lock = threading.Lock()

    def enter(self, options: Mapping[str, Any]) -> Node:
        """The node that options mean; `leave` it as often as it was entered."""
        master = options["master"] or os.environ.get("ROS_MASTER_URI") or "http://127.0.0.1:11311"
        host = options["host"] or os.environ.get("ROS_IP") or os.environ.get("ROS_HOSTNAME") or "127.0.0.1"
        with self._lock:
            place = master, host, options["name"]
            node = self._open.get(place)
            if node is None:
                node = self._open[place] = Node(master, host, options["name"] or f"/rosetta_jit_{os.getpid()}_{next(_NUMBERS)}")
            node.users += 1
            return node

    def leave(self, node: Node) -> None:
        """Close it when nobody uses it any more."""
        with self._lock:
            node.users -= 1
            if not node.users:
                self._open = {place: each for place, each in self._open.items() if each is not node}
        if not node.users:
            node.close()


nodes = per_process(Nodes)
"""Those of this process."""


def uris_in(value: object) -> list[str]:
    """The URIs of a topic's publishers, as the master names them."""
    uris = cast("list[object]", value) if isinstance(value, list) else []
    return [each for each in uris[:MAX_CONNECTIONS] if isinstance(each, str)]


def graph_name(address: Address) -> str:
    """The topic or service that an address names.

    Raises
    ------
    AddressError
        It is no name of ROS 1.
    """
    if not NAME.fullmatch(address.rest):
        raise address.wrong("a name of ROS 1: `/`, then letters, digits and `_` between slashes", "ros1:/robot/imu")
    return address.rest


def refuse(stream: Stream, why: str) -> ProtocolError:
    """Tell a peer why it is refused; the error ends its connection."""
    stream.send(header({"error": why}))
    return ProtocolError(why)
