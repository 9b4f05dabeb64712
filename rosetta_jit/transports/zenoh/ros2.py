"""ROS 2 over zenoh, as rmw_zenoh does it.

    key        = <domain>/<topic>/<type>/<hash>
    attachment = i64 sequence number, i64 source time (ns), u8 length (16), id of the publisher; older ones name each before it
    liveliness = @ros2_lv/<domain>/<session>/<node>/<entity>/<kind>/<enclave>/<namespace>/<node name>/<topic>/<type>/<hash>/<qos>

In liveliness tokens slashes stand as `%`; kinds are NN (node), MP (publisher), MS (subscriber). All numbers little-endian.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Mapping
from itertools import count
from time import time_ns
from typing import TYPE_CHECKING, Any

import zenoh

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message, Sink, Source
from rosetta_jit.transports.ros2_names import mangled, plain, topic_of
from rosetta_jit.transports.zenoh.client import put
from rosetta_jit.transports.zenoh.sessions import sessions

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost

GID_BYTES = 16
QOS = "::,10:,:,:,,"
"""Reliable, volatile, the last ten: the default of ROS 2."""

_ATTACHMENT = struct.Struct("<qqB16s")
_KEYS = (b"\x0fsequence_number", b"\x10source_timestamp", b"\x0asource_gid")
_ENTITIES = count(10)


def attachment_of(data: bytes) -> dict[str, Any]:
    """Sequence number, time and sender of a message, from its attachment; nothing where the attachment is not rmw_zenoh's."""
    first, second, third = _KEYS
    if data.startswith(first):  # the form with names
        at = len(first)
        ends = at + 8 + len(second) + 8 + len(third) + 1 + GID_BYTES
        if len(data) != ends or data[at + 8 : at + 8 + len(second)] != second:
            return {}
        data = data[at : at + 8] + data[at + 8 + len(second) : at + 16 + len(second)] + data[-1 - GID_BYTES :]
    if len(data) != _ATTACHMENT.size:
        return {}
    sequence, sent, size, gid = _ATTACHMENT.unpack(data)
    return {"sequence": sequence, "sent": sent, "gid": gid.hex()} if size == GID_BYTES else {}


class Entity:
    """The tokens by which `ros2 topic list` and `ros2 node list` see a publisher or a subscriber."""

    def __init__(self, session: zenoh.Session, options: Mapping[str, Any], kind: str, topic: str, type_: str) -> None:
        node = options["node"].strip("/") or "rosetta_jit"
        base = f"@ros2_lv/{options['domain']}/{session.zid()}/0"
        hash_ = "TypeHashNotSupported" if options["hash"] == "*" else options["hash"]
        about = f"%/%/{node}"
        self._tokens = [
            session.liveliness().declare_token(f"{base}/0/NN/{about}"),
            session.liveliness().declare_token(
                f"{base}/{next(_ENTITIES)}/{kind}/{about}/{topic.replace('/', '%')}/{type_}/{hash_}/{QOS}",
            ),
        ]

    def close(self) -> None:
        """Nobody shall see it any more."""
        for each in self._tokens:
            each.undeclare()  # pyright: ignore[reportUnknownMemberType]


def _key(topic: str, type_: str, options: Mapping[str, Any]) -> str:
    return f"{options['domain']}{topic}/{type_}/{options['hash']}"


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Receive the messages of a topic, as CDR."""
    topic, most = topic_of(address), options["max_message"]
    type_ = "*" if options["type"] == "*" else mangled(options["type"], address)

    def take(sample: zenoh.Sample) -> None:
        data = sample.payload.to_bytes()
        if sample.kind != zenoh.SampleKind.PUT:
            return
        if len(data) > most:
            source.lose_large(len(data), most)
            return
        found, hash_ = str(sample.key_expr).split("/")[-2:]
        attributes = attachment_of(sample.attachment.to_bytes()) if sample.attachment is not None else {}
        sent = attributes.pop("sent", None)
        source.arrived(Message(data, topic, plain(found), time_ns(), sent, {**attributes, "hash": hash_}))

    session = sessions().enter(options, address)
    subscriber = session.declare_subscriber(_key(topic, type_, options), take)
    entity = None if type_ == "*" else Entity(session, options, "MS", topic, type_)
    source.connections = 1

    def close() -> None:
        subscriber.undeclare()  # pyright: ignore[reportUnknownMemberType]
        if entity is not None:
            entity.close()
        source.connections = 0
        sessions().leave(options)

    source.opened(close)


class Ros2Sink(Sink):
    """Publishes to a topic, with the attachment that rmw_zenoh demands."""

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        topic = topic_of(address)
        if "*" in (options["type"], options["hash"]):
            raise TransportError(
                "type", str(address), "a publisher of ROS 2 says its type and its hash: `type=std_msgs/msg/String&hash=RIHS01_…`"
            )
        type_ = mangled(options["type"], address)
        self._most: int = options["max_message"]
        self._options = options
        self._gid = os.urandom(GID_BYTES)
        self._number = count(1)
        self._session = sessions().enter(options, address)
        self._publisher = self._session.declare_publisher(_key(topic, type_, options), congestion_control=zenoh.CongestionControl.BLOCK)
        self._entity = Entity(self._session, options, "MP", topic, type_)
        self._closed = False

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        del attributes
        if self._closed:
            raise TransportError("closed", self.address, "this sink is closed")
        self.check_size(len(data), self._most)
        attachment = _ATTACHMENT.pack(next(self._number), time_ns() if time is None else time, GID_BYTES, self._gid)
        return put(self, self._publisher, data, attachment=attachment)

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            self._entity.close()
            self._publisher.undeclare()  # pyright: ignore[reportUnknownMemberType]
            sessions().leave(self._options)


def topics(address: Address, options: Mapping[str, Any]) -> list[tuple[str, str | None]]:
    """The topics that somebody publishes, by their liveliness tokens."""
    session = sessions().enter(options, address)
    found: dict[str, str | None] = {}
    try:
        for reply in session.liveliness().get(f"@ros2_lv/{options['domain']}/**", timeout=options["timeout"]):
            parts = str(reply.ok.key_expr).split("/") if reply.ok is not None else []
            if len(parts) == 13 and parts[5] == "MP":
                found[parts[9].replace("%", "/")] = plain(parts[10])
    finally:
        sessions().leave(options)
    return sorted((name, type_) for name, type_ in found.items() if name.startswith(address.rest))
