"""Keys of zenoh."""

from __future__ import annotations

from collections.abc import Mapping
from time import time_ns
from typing import TYPE_CHECKING, Any

import zenoh

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message, Sink, Source
from rosetta_jit.transports.zenoh.sessions import key_of, sessions

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost

DEFAULT_ENCODING = "zenoh/bytes"


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Receive what is put to keys that match an expression."""
    most = options["max_message"]
    key = key_of(address)

    def take(sample: zenoh.Sample) -> None:
        if sample.kind != zenoh.SampleKind.PUT:
            return
        data = sample.payload.to_bytes()
        if len(data) > most:
            source.lose_large(len(data), most)
            return
        source.arrived(message_of(sample, data))

    session = sessions().enter(options, address)
    subscriber = session.declare_subscriber(key, take)
    source.connections = 1

    def close() -> None:
        subscriber.undeclare()  # pyright: ignore[reportUnknownMemberType]
        source.connections = 0
        sessions().leave(options)

    source.opened(close)


def message_of(sample: zenoh.Sample, data: bytes) -> Message:
    """A sample as a message; its type is the encoding that it says, its time of sending that of its timestamp."""
    encoding = str(sample.encoding)
    attributes: dict[str, Any] = {"encoding": encoding}
    if sample.attachment is not None:
        attributes["attachment"] = sample.attachment.to_bytes()
    sent = None if sample.timestamp is None else int(sample.timestamp.get_time().timestamp() * 1e9)
    return Message(data, str(sample.key_expr), None if encoding == DEFAULT_ENCODING else encoding, time_ns(), sent, attributes)


def put(sink: Sink, publisher: Any, data: bytes | bytearray | memoryview, **options: Any) -> bool:
    """Hand a message over to zenoh; counts whether it was taken."""
    try:
        publisher.put(bytes(data), **options)
    except zenoh.ZError as error:
        sink.lose(f"zenoh: {error}"[:200])
        return False
    sink.passed(len(data))
    return True


class ZenohSink(Sink):
    """Puts messages to a key, with the attributes `attachment` (bytes) and `encoding`. A full queue of zenoh makes the sender wait."""

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        key = key_of(address)
        if "*" in str(key):
            raise address.wrong("one key, without `*`", "zenoh:robot/arm/joints")
        self._most: int = options["max_message"]
        self._options = options
        self._session = sessions().enter(options, address)
        self._publisher = self._session.declare_publisher(key, congestion_control=zenoh.CongestionControl.BLOCK)
        self._closed = False

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        del time
        if self._closed:
            raise TransportError("closed", self.address, "this sink is closed")
        self.check_size(len(data), self._most)
        wanted = attributes or {}
        return put(self, self._publisher, data, encoding=wanted.get("encoding"), attachment=wanted.get("attachment"))

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            self._publisher.undeclare()  # pyright: ignore[reportUnknownMemberType]
            sessions().leave(self._options)
