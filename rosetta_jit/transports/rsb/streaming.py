"""Events of scopes."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from itertools import count
from time import time_ns
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message, Sink, Source
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.rsb.bus import Participant, buses
from rosetta_jit.transports.rsb.notification import Event, EventId
from rosetta_jit.transports.rsb.scopes import normal, scope_of

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Receive the events of a scope and of all below it."""
    bus = buses().enter(options)
    participant = Participant(scope_of(address), source, lambda event: source.arrived(message_of(event)))
    bus.join(source, participant)

    def close() -> None:
        bus.leave(source, participant)
        buses().leave(bus, options["linger"])

    source.opened(close)


def message_of(event: Event) -> Message:
    """An event as a message."""
    data = event.data if isinstance(event.data, bytes | memoryview) else memoryview(event.data)
    attributes = {
        "id": event.id,
        "create_time": 1000 * event.create_time,
        "method": event.method,
        "causes": event.causes,
        "user_infos": event.user_infos,
        "user_times": event.user_times,
    }
    return Message(data, event.scope, event.schema or None, time_ns(), 1000 * event.send_time or None, attributes)


class Informer:
    """Makes the events of one participant, which it counts."""

    def __init__(self, scope: str, schema: str) -> None:
        self.scope = scope
        self._schema = schema
        self._id = bytearray(os.urandom(16))
        self._id[6], self._id[8] = self._id[6] & 15 | 64, self._id[8] & 63 | 128  # a random UUID, version 4
        self._participant = bytes(self._id)
        self._number = count()

    def event(self, data: bytes | bytearray | memoryview, time: int | None, attributes: Mapping[str, Any] | None, address: str) -> Event:
        """The next event. Attributes are those of messages, and `scope` (below the own), `type`.

        Raises
        ------
        TransportError
            It would be one that ends other peers: without a wire schema, outside the scope, or with user infos beyond ASCII.
        """
        now, event_id = time_ns() // 1000, EventId(self._participant, next(self._number) & 0xFFFFFFFF)
        made = now if time is None else time // 1000
        if attributes is None and self._schema:
            return Event(event_id, self.scope, self._schema, data, made, now)
        said = attributes or {}
        schema = str(said.get("type") or self._schema)
        if not schema or not schema.isascii():
            raise TransportError("type", address, "events need a wire schema: say `type=`; listeners of rsb-cpp end without one")
        scope = normal(str(said.get("scope", self.scope)))
        if scope is None or not scope.startswith(self.scope):
            raise TransportError("refused", address, f"events go to the scope {self.scope} or below it")
        infos: Mapping[str, str] = {str(name): str(text) for name, text in said.get("user_infos", {}).items()}
        times: Mapping[str, int] = {str(name): int(number) for name, number in said.get("user_times", {}).items()}
        method = str(said.get("method", ""))
        if not all(each.isascii() for each in (*infos, *infos.values(), *times, method)):
            raise TransportError("refused", address, "methods, user infos and keys are ASCII: rsb-python closes the connection for others")
        causes: Sequence[EventId] = [EventId(bytes(one), int(two)) for one, two in said.get("causes", ())]
        return Event(event_id, scope, schema, data, made, now, method, causes, infos, times)


class RsbSink(Sink):
    """Sends events; the attributes of a message that came can be given to `send` as they are, but for `id`, which is its own."""

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        self._informer = Informer(scope_of(address), options["type"])
        self._most: int = options["max_message"]
        self._linger: float = options["linger"]
        self._timeout: float = options["timeout"]
        self._closed = False
        self.bus = buses().enter(options)
        self.bus.join(self)

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        if self._closed:
            raise TransportError("closed", self.address, "this sink is closed")
        self.check_size(len(data), self._most)
        event = self._informer.event(data, time, attributes, self.address)
        taken = self.bus.send(event, self, 0 if loop().is_current else self._timeout)
        if taken:
            self.passed(len(data))
        return taken

    def flush(self, timeout: float = 5.0) -> bool:
        return self.bus.flush(timeout)

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            self.bus.leave(self)
            buses().leave(self.bus, self._linger)
