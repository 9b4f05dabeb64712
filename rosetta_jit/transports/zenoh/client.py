"""Keys of zenoh."""

from __future__ import annotations

from time import time_ns
from typing import TYPE_CHECKING, Any

import zenoh

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message, Sink, Source
from rosetta_jit.transports.zenoh.sessions import key_of, sessions

if TYPE_CHECKING:
    from collections.abc import Mapping

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
            source.lose(f"a message of {len(data)} bytes, more than max_message={most}")
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
    told: dict[str, Any] = {"encoding": encoding}
    if sample.attachment is not None:
        told["attachment"] = sample.attachment.to_bytes()
    sent = None if sample.timestamp is None else int(sample.timestamp.get_time().timestamp() * 1e9)
    return Message(data, str(sample.key_expr), None if encoding == DEFAULT_ENCODING else encoding, time_ns(), sent, told)


def publish(address: Address, options: Mapping[str, Any], lost: Lost | None) -> Sink:
    """Put messages to a key."""
    return ZenohSink(address, options, lost)


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
        if len(data) > self._most:
            raise TransportError("too large", self.address, f"{len(data)} bytes are more than max_message={self._most}")
        told = attributes or {}
        try:
            self._publisher.put(bytes(data), encoding=told.get("encoding"), attachment=told.get("attachment"))  # pyright: ignore[reportUnknownMemberType]
        except zenoh.ZError as error:
            self.lose(f"zenoh: {error}"[:200])
            return False
        self.messages += 1
        self.bytes += len(data)
        return True

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            self._publisher.undeclare()  # pyright: ignore[reportUnknownMemberType]
            sessions().leave(self._options)
