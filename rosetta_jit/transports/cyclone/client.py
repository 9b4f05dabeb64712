"""Topics of DDS by Cyclone DDS. Samples pass as they are serialised, so that any type can be read and written by its name alone."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Mapping
from importlib import import_module
from time import time_ns
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message, Sink, Source
from rosetta_jit.transports.processes import per_process
from rosetta_jit.transports.ros2_names import mangled, plain, topic_of

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost

AT_ONCE = 64
"""Samples that are taken before the reader is asked again."""

ENCAPSULATION_BYTES = 4

ON_ONE_INTERFACE = """<CycloneDDS><Domain>
<General><Interfaces><NetworkInterface name={name} multicast="default"/></Interfaces></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>100</MaxAutoParticipantIndex>
<Peers><Peer address="localhost"/></Peers></Discovery>
</Domain></CycloneDDS>"""
"""Participants of one machine find each other without multicast, which loopback often lacks."""

LOOK_NS = 100_000_000
"""How often the thread looks whether its source was closed."""


def _names(address: Address, options: Mapping[str, Any]) -> tuple[str, str]:
    """The topic and the type as DDS has them."""
    if not options["type"]:
        raise TransportError("type", str(address), "DDS matches types by name: say `type=`")
    if address.scheme == "ros2-dds":
        return f"rt{topic_of(address)}", mangled(options["type"], address)
    if not address.rest or not address.rest.isprintable():
        raise address.wrong("a topic of DDS", "dds:Square?type=ShapeType")
    return address.rest, options["type"]


class Domains:
    """Cyclone's settings of the domains of a process: one object a domain, as long as the process lives."""

    def __init__(self) -> None:
        self._open: dict[int, Any] = {}
        self._lock = threading.Lock()

    def enter(self, make: Callable[[int, str], Any], options: Mapping[str, Any]) -> Any:
        """Settings for the interface that options say; who opens a domain first says it. None where Cyclone's own are meant."""
        name, number = options["interface"] or "lo", options["domain"]
        if name == "auto" or (not options["interface"] and os.environ.get("CYCLONEDDS_URI")):
            return None
        with self._lock:
            if number not in self._open:
                self._open[number] = make(number, ON_ONE_INTERFACE.format(name=quoteattr(name)))
            return self._open[number]


domains = per_process(Domains)
"""Those of this process."""


class Endpoint:
    """A participant with one topic whose type is known by its name alone."""

    def __init__(self, address: Address, options: Mapping[str, Any]) -> None:
        core, domain, idl, topic = map(import_module, ("cyclonedds.core", "cyclonedds.domain", "cyclonedds.idl", "cyclonedds.topic"))
        name, self.type = _names(address, options)
        raw: Any = options["struct"] or idl.make_idl_struct("Raw", self.type, {})  # Cyclone checks samples against it: any is one
        policy, depth = core.Policy, options["keep"]
        second = 10**9
        self.qos: Any = core.Qos(
            policy.Reliability.Reliable(max_blocking_time=second) if options["reliable"] else policy.Reliability.BestEffort,
            policy.History.KeepLast(depth) if depth else policy.History.KeepAll,
            policy.Durability.TransientLocal if options["transient"] else policy.Durability.Volatile,
        )
        try:
            self._domain = domains().enter(domain.Domain, options)
            self.participant: Any = domain.DomainParticipant(options["domain"])
            self.topic: Any = topic.Topic(self.participant, name, raw, qos=self.qos)
        except core.DDSException as error:
            raise TransportError("unreachable", str(address), f"Cyclone DDS cannot open the topic: {error}") from None


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Receive the samples of a topic, in a thread of its own; with `ros2-dds`, of a topic of ROS 2."""
    core, sub = map(import_module, ("cyclonedds.core", "cyclonedds.sub"))
    endpoint = Endpoint(address, options)
    seen = [0]

    def lost(_: Any, status: Any) -> None:
        source.lose("lost on the way", max(status.total_count - seen[0], 0))
        seen[0] = status.total_count

    def matched(_: Any, status: Any) -> None:
        source.connections = status.current_count

    def refused(_: Any, status: Any) -> None:
        del status
        source.lose("a writer whose quality of service does not fit", 0)

    calls = {"on_sample_lost": lost, "on_subscription_matched": matched, "on_requested_incompatible_qos": refused}
    reader = sub.DataReader(endpoint.participant, endpoint.topic, qos=endpoint.qos, listener=core.Listener(**calls))
    source.read(lambda ends: _read(reader, endpoint, address.rest, source, options, ends))


def _read(reader: Any, endpoint: Endpoint, channel: str, source: Source, options: Mapping[str, Any], ends: threading.Event) -> None:
    """Take samples; not in Cyclone's own thread, which must not wait for what a callback does."""
    core, raw = map(import_module, ("cyclonedds.core", "cyclonedds._clayer"))
    most, type_ = options["max_message"], plain(endpoint.type)
    mask = core.SampleState.Any | core.ViewState.Any | core.InstanceState.Any
    waiting = core.WaitSet(endpoint.participant)
    waiting.attach(core.ReadCondition(reader, mask))
    while not ends.is_set():
        waiting.wait(LOOK_NS)
        while not ends.is_set() and (samples := _taken(raw.ddspy_take(reader._ref, mask, AT_ONCE))):  # noqa: SLF001 - no public way to bytes
            for data, info in samples:
                if not info.valid_data:
                    continue
                if len(data) > most:
                    source.lose_large(len(data), most)
                else:
                    source.arrived(Message(data, channel, type_, time_ns(), info.source_timestamp, None))
    reader.set_listener(None)
    source.connections = 0
    endpoint.participant = endpoint.topic = None


class DdsSink(Sink):
    """Writes samples to a topic (with `ros2-dds`, of ROS 2), each with the four bytes in front that say how it is serialised."""

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        core, pub, self._raw = map(import_module, ("cyclonedds.core", "cyclonedds.pub", "cyclonedds._clayer"))
        self._most: int = options["max_message"]
        self._has_struct = options["struct"] is not None
        self._endpoint: Endpoint | None = Endpoint(address, options)

        def matched(_: Any, status: Any) -> None:
            self.connections = status.current_count

        listener = core.Listener(on_publication_matched=matched)
        self._writer: Any = pub.DataWriter(self._endpoint.participant, self._endpoint.topic, qos=self._endpoint.qos, listener=listener)

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        del attributes
        if self._writer is None:
            raise TransportError("closed", self.address, "this sink is closed")
        self.check_size(len(data), self._most)
        if len(data) < ENCAPSULATION_BYTES:
            raise TransportError("protocol", self.address, "CDR begins with four bytes that say how it is written")
        if not data[1] & 1 and not self._has_struct:
            raise TransportError(
                "protocol", self.address, "big-endian CDR takes `struct=`: Cyclone DDS swaps it, and has to know the fields"
            )
        padded = bytes(data).ljust(-(-len(data) // 4) * 4, b"\0")
        made = time_ns() if time is None else time
        if self._raw.ddspy_write_ts(self._writer._ref, padded, made) < 0:  # noqa: SLF001 - it has no public way for bytes
            self.lose("readers are too slow, or the sample is not CDR")
            return False
        self.passed(len(data))
        return True

    def close(self) -> None:
        self._writer = self._endpoint = None
        self.connections = 0


def _taken(found: list[Any] | int) -> list[Any]:
    """The samples; a number is an error's."""
    return [] if isinstance(found, int) else found
