"""Remote procedure calls: a request on the scope of a method, and a reply there whose cause is the request."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message
from rosetta_jit.transports.calls import Caller, Pending, Server
from rosetta_jit.transports.rsb.bus import Participant, buses
from rosetta_jit.transports.rsb.notification import Event, EventId
from rosetta_jit.transports.rsb.scopes import scope_of
from rosetta_jit.transports.rsb.streaming import Informer, message_of

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address

REQUEST, REPLY = "REQUEST", "REPLY"
ERROR = "rsb:error?"
VOID = "void"
TEXT = "utf-8-string"


class RsbCaller(Caller):
    """Sends requests; any number may be on their way."""

    def __init__(self, address: Address, options: Mapping[str, Any]) -> None:
        super().__init__(address, options)
        scope = scope_of(address)
        self._informer = Informer(scope, options["type"] or VOID)
        self._pending: dict[EventId, Pending] = {}
        self._lock = threading.Lock()
        self._bus = buses().enter(options)
        self._participant = Participant(scope, self, self._take)
        self._bus.join(self, self._participant)
        self._closed = False

    def ask(self, data: bytes | bytearray | memoryview, until: float, attributes: Mapping[str, Any]) -> Message:
        if self._closed:
            raise TransportError("closed", self.address, "this caller is closed")
        event = self._informer.event(data, None, {**attributes, "method": REQUEST}, self.address)
        pending = Pending()
        with self._lock:
            self._pending[event.id] = pending
        try:
            self._bus.send(event, self)
            self.passed(len(data))
            return pending.wait(until, self.address)
        finally:
            with self._lock:
                self._pending.pop(event.id, None)

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            for each in tuple(self._pending.values()):
                each.fail(TransportError("closed", self.address, "this caller was closed"))
            self._bus.leave(self, self._participant)
            buses().leave(self._bus, 0.5)

    def _take(self, event: Event) -> None:
        if event.method != REPLY or not event.causes:
            return
        pending = self._pending.get(event.causes[0])  # other peers look at the first cause only, too
        if pending is None:
            return
        if ERROR in event.user_infos:
            text = str(bytes(event.data), "utf-8", "replace")[:2000]
            pending.fail(TransportError("refused", self.address, f"the server failed: {text}"))
        else:
            pending.answer(message_of(event))


def serve(address: Address, server: Server, options: Mapping[str, Any]) -> None:
    """Answer the requests of one method; an answer of None is `void`, one that fails an error with its text."""
    scope = scope_of(address)
    informer = Informer(scope, options["type"] or VOID)
    bus = buses().enter(options)

    def take(event: Event) -> None:
        if event.method == REQUEST and event.scope == scope:
            request = event.id
            server.asked(message_of(event), lambda answer, error: send(request, answer, error))

    def send(request: EventId, answer: bytes | None, error: str | None) -> None:
        attributes: dict[str, Any] = {"method": REPLY, "causes": [request]}
        if error is not None:
            attributes |= {"user_infos": {ERROR: "1"}, "type": TEXT}
            answer = error.encode()
        elif answer is None:
            attributes["type"] = VOID
        bus.send(informer.event(answer or b"", None, attributes, server.address), server)

    participant = Participant(scope, server, take)
    bus.join(server, participant)

    def close() -> None:
        bus.leave(server, participant)
        buses().leave(bus, options["linger"])

    server.opened(close)
