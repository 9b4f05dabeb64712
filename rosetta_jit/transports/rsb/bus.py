"""The bus: one connection of this process to it, or its server. Each event goes to everybody, and each picks what its scopes want.

    stream = 4 zero bytes of the server, then frames both ways
    frame  = u32 length (little-endian), a Notification

A frame is written at once: rsb-python closes a connection where the four bytes of a length come in two pieces.
"""

from __future__ import annotations

import socket
import struct
import threading
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.connecting import Dialer, Listener, resolve
from rosetta_jit.transports.feeding import Between, ProtocolError
from rosetta_jit.transports.limits import MAX_CONNECTIONS
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.processes import per_process
from rosetta_jit.transports.rsb.notification import Event, NoEventError, decode, encode, scope_in
from rosetta_jit.transports.rsb.scopes import above, normal
from rosetta_jit.transports.stream import Stream, finish_all

if TYPE_CHECKING:
    from rosetta_jit.transports.end import End
    from rosetta_jit.transports.feeding import Machine

HANDSHAKE = bytes(4)
HANDSHAKE_S = 10.0
_LENGTH = struct.Struct("<I")
_BETWEEN = Between(4)


def frames(take: Callable[[memoryview], object], most: int, *, is_client: bool, ready: Callable[[], object]) -> Machine:
    """Read the notifications of one connection, for ever; a frame of length 0 ends it, as RSB's Common Lisp asks for its end by one."""
    if is_client and bytes((yield 4)) != HANDSHAKE:
        raise ProtocolError("what answers there is no bus of RSB: another handshake")
    ready()
    while True:
        (size,) = _LENGTH.unpack((yield _BETWEEN))
        if size > most:
            raise ProtocolError(f"a message of {size} bytes, more than max_message={most}")
        if not size:
            return
        take((yield size))


class Participant:
    """A listener on a scope. It gets the events in the loop's thread; those that this process sends, in the sender's thread."""

    def __init__(self, scope: str, counts: End, take: Callable[[Event], object]) -> None:
        self.scope = scope
        self.counts = counts
        self.take = take


class Bus:
    """The bus at a host and a port, as this process has it, for all its participants together."""

    def __init__(self, host: str, port: int, options: Mapping[str, Any]) -> None:
        self.place = f"{host}:{port}"
        self.users = 0
        self.most: int = options["max_message"]
        self._role: str = options["role"]
        self._targets = resolve(host, port)
        self._streams: set[Stream] = set()
        self._listening: dict[str, list[Participant]] = {}
        self._everyone: list[End] = []
        self._listener: Listener | None = None
        self._dialer: Dialer | None = None
        self._ready = threading.Event()
        self._closed = False
        self._was_connected = False
        self._why = "no answer in time"
        self._open()
        if not options["patient"] and not self._ready.wait(options["timeout"]):
            self.close(0)
            raise TransportError("unreachable", self.place, f"no bus of RSB answers there: {self._why}")

    @property
    def is_server(self) -> bool:
        """Whether this process serves the bus."""
        return self._listener is not None

    def join(self, counts: End, participant: Participant | None = None) -> None:
        """Begin to take part."""

        def work() -> None:
            self._everyone.append(counts)
            if participant is not None:
                self._listening = {**self._listening, participant.scope: [*self._listening.get(participant.scope, ()), participant]}
            self._count()

        loop().run(work)

    def leave(self, counts: End, participant: Participant | None = None) -> None:
        """Take part no more."""

        def work() -> None:
            self._everyone = [each for each in self._everyone if each is not counts]
            if participant is not None:
                rest = [each for each in self._listening.get(participant.scope, ()) if each is not participant]
                self._listening = {**self._listening, participant.scope: rest}

        loop().run(work)

    def send(self, event: Event, counts: End, wait: float = 0.0) -> bool:
        """Send an event to all others, and to the listeners of this process; whether any of them took it, or the bus has no others."""
        parts = encode(event)
        head = _LENGTH.pack(sum(map(len, parts)))
        streams = tuple(self._streams)
        taken = not streams and self.is_server
        for each in streams:
            if each.send(head, *parts, sender=counts) or (wait and each.wait(wait) and each.send(head, *parts, sender=counts)):
                taken = True
            else:
                counts.lose("the peer is too slow")
        if not taken and not streams:
            counts.lose("the bus is not connected")
        if any(self._listening.get(each) for each in above(event.scope)):  # of this process
            loop().soon(self._deliver, event._replace(data=bytes(event.data)))
        return taken

    def flush(self, timeout: float) -> bool:
        """Wait until nothing waits to be sent."""
        return all(each.wait(timeout, empty=True) for each in tuple(self._streams))

    def close(self, linger: float) -> None:
        """Half-close all connections, as RSB's peers do, and close them when the other ends do the same."""
        if self._listener is not None:
            self._listener.close()

        def work() -> None:
            self._closed = True
            if self._dialer is not None:
                self._dialer.stop()

        loop().run(work)
        finish_all(self._streams, linger)

    def _open(self) -> None:
        if self._role != "client":
            try:
                self._listener = Listener(self._targets[0], self._came)
                self._ready.set()
            except TransportError as error:
                if self._role == "server":
                    raise
                self._why = error.detail
            else:
                return
        if self._dialer is None:
            self._dialer = Dialer(self._targets, self._came, self._failed)
            loop().run(self._dialer.start)

    def _failed(self, why: str) -> None:
        self._why = why
        if self._role == "auto" and not self._closed and self._listener is None:  # who served it is gone: perhaps it is our turn
            try:
                self._listener = Listener(self._targets[0], self._came)
            except TransportError:
                return
            assert self._dialer is not None
            self._dialer.stop()
            self._dialer = None
            self._ready.set()

    def _came(self, sock: socket.socket) -> None:
        if self._closed or len(self._streams) >= MAX_CONNECTIONS:
            sock.close()
            return
        is_client = self._listener is None
        stream = Stream(sock, lambda line: self._machine(line, is_client=is_client), self._gone)
        if is_client:
            stream.within(HANDSHAKE_S, "no handshake came")
        stream.start()

    def _machine(self, stream: Stream, *, is_client: bool) -> Machine:
        def ready() -> None:
            stream.in_time()
            if not is_client:
                stream.send(HANDSHAKE)
            self._streams.add(stream)
            if is_client and self._was_connected:
                for each in self._everyone:
                    each.reconnects += 1
            self._was_connected = True
            self._ready.set()
            self._count()

        return frames(lambda data: self._took(stream, data), self.most, is_client=is_client, ready=ready)

    def _took(self, stream: Stream, data: memoryview) -> None:
        """Pass an event on, as it is, where this is the server; and to who listens here. One that would end other peers goes nowhere."""
        relays = self._listener is not None and len(self._streams) > 1
        if not relays and not self._listening:
            return
        try:
            scope = _scope(data)
            if not relays and not any(self._listening.get(each) for each in above(scope)):
                return
            event = _with_schema(decode(data)) if relays else decode(data)
        except NoEventError as error:
            self._lose(f"no event of RSB: {error}")
            return
        if relays:
            self._relay(stream, bytes(data))
        self._deliver(event._replace(scope=scope))

    def _relay(self, source: Stream, data: bytes) -> None:
        """Send an event to all connections but the one by which it came."""
        head = _LENGTH.pack(len(data))
        for each in self._streams:
            if each is not source and not each.send(head, data):
                self._lose("the peer is too slow")

    def _deliver(self, event: Event) -> None:
        listening = self._listening
        if listening:
            for scope in above(event.scope):
                for each in listening.get(scope, ()):
                    each.take(event)

    def _gone(self, stream: Stream, why: str) -> None:
        known = stream in self._streams
        self._streams.discard(stream)
        self._count()
        self._why = why or self._why
        reason = "closed before it was sent" if self._closed else "the peer went away"
        for sender, count in stream.unsent.items():
            for each in self._everyone if sender is None else (sender,):  # nobody here sent what is only passed on
                each.lose(reason, count)
        if (why and not stream.unsent) or (known and stream.cut):
            self._lose(why or "the connection ended in the middle of a message")
        if self._dialer is not None and not self._closed:
            self._dialer.lost()

    def _lose(self, reason: str) -> None:
        for each in self._everyone:
            each.lose(reason)

    def _count(self) -> None:
        for each in self._everyone:
            each.connections = len(self._streams)


def _scope(data: memoryview) -> str:
    scope = normal(scope_in(data))
    if scope is None:
        raise NoEventError("a scope that is none")
    return scope


def _with_schema(event: Event) -> Event:
    if not event.schema:
        raise NoEventError("an event without a wire schema")
    return event


class Buses:
    """The buses of a process: participants at one place share one."""

    def __init__(self) -> None:
        self._open: dict[tuple[str, int], Bus] = {}
        self._lock = threading.Lock()

    def enter(self, options: Mapping[str, Any]) -> Bus:
        """The bus that options mean; `leave` it as often as it was entered."""
        place = options["host"], options["port"]
        with self._lock:
            bus = self._open.get(place)
            if bus is None:
                bus = self._open[place] = Bus(*place, options)
            bus.users += 1
            bus.most = max(bus.most, options["max_message"])
            return bus

    def leave(self, bus: Bus, linger: float) -> None:
        """Close it when nobody uses it any more."""
        with self._lock:
            bus.users -= 1
            if not bus.users:
                self._open = {place: each for place, each in self._open.items() if each is not bus}
                bus.close(linger)


buses = per_process(Buses)
"""Those of this process."""
