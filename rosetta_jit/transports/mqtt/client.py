"""Topics of an MQTT broker; each source and sink is a client of its own, in a thread of paho."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from time import monotonic, time_ns
from typing import TYPE_CHECKING, Any

import paho.mqtt.client as paho
from paho.mqtt.enums import CallbackAPIVersion

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message, Sink, Source
from rosetta_jit.transports.end import End
from rosetta_jit.transports.limits import MAX_TOPIC_BYTES

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost


class Client:
    """A connection to the broker, which paho makes again when it is lost.

    Raises
    ------
    TransportError
        The broker cannot be reached, or refuses.
    """

    def __init__(self, address: Address, counts: End, options: Mapping[str, Any]) -> None:
        self._counts = counts
        self._connected = threading.Event()
        self._why = "no answer in time"
        self._was_connected = False
        self.paho = paho.Client(CallbackAPIVersion.VERSION2, client_id=options["client_id"], protocol=paho.MQTTv311)
        self.paho.max_queued_messages_set(options["queue"])
        self.paho.reconnect_delay_set(0.1, 2)  # pyright: ignore[reportArgumentType] - it takes fractions
        self.paho.on_connect = self._on_connect
        self.paho.on_disconnect = self._on_disconnect
        if options["username"]:
            self.paho.username_pw_set(options["username"], options["password"] or None)
        if options["tls"]:
            self.paho.tls_set()  # pyright: ignore[reportUnknownMemberType]
        self.subscription: tuple[str, int] | None = None
        self._place = str(address)
        self._host, self._port, self._timeout = options["host"], options["port"], options["timeout"]

    def open(self) -> None:
        """Connect, and begin."""
        try:
            self.paho.connect(self._host, self._port)
        except (OSError, ValueError) as error:
            why = getattr(error, "strerror", None) or error
            raise TransportError("unreachable", self._place, f"no broker answers at {self._host}:{self._port}: {why}") from None
        self.paho.loop_start()
        if not self._connected.wait(self._timeout):
            self.close()
            raise TransportError("refused", self._place, f"the broker does not take this client: {self._why}")

    def close(self) -> None:
        """Disconnect."""
        self.paho.disconnect()
        self.paho.loop_stop()

    def _on_connect(self, *arguments: Any) -> None:
        reason: Any = arguments[3]
        if reason.is_failure:
            self._why = str(reason)
            return
        self._counts.connections = 1
        self._counts.reconnects += self._was_connected
        self._was_connected = True
        if self.subscription is not None:  # a broker that was restarted knows none
            self.paho.subscribe(*self.subscription)
        self._connected.set()

    def _on_disconnect(self, *_: Any) -> None:
        self._counts.connections = 0


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Receive the messages of a topic, or of all that match a filter with `+` and `#`."""
    most = options["max_message"]
    client = Client(address, source, options)
    topic = _topic(address)
    client.subscription = topic, int(options["qos"])

    def take(_: Any, __: Any, found: paho.MQTTMessage) -> None:
        if len(found.payload) > most:
            source.lose_large(len(found.payload), most)
            return
        source.arrived(Message(bytes(found.payload), found.topic, None, time_ns(), None, {"qos": found.qos, "retain": found.retain}))

    client.paho.on_message = take
    client.open()
    source.opened(client.close)


class MqttSink(Sink):
    """Sends to a topic. At most `queue` messages wait for a broker that is slow or gone."""

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        self._topic = _topic(address)
        if any(sign in self._topic for sign in "+#"):
            raise address.wrong("one topic, without `+` and `#`", "mqtt:robot/arm/joints")
        self._qos, self._retain = int(options["qos"]), options["retain"]
        self._most, self._queue, self._linger = options["max_message"], options["queue"], options["linger"]
        self._waiting: set[int] = set()
        self._changed = threading.Condition()
        self._closed = False
        self._client = Client(address, self, options)
        self._client.paho.on_publish = self._sent
        self._client.open()

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        del time
        if self._closed:
            raise TransportError("closed", self.address, "this sink is closed")
        self.check_size(len(data), self._most)
        retain = bool(attributes.get("retain", self._retain)) if attributes else self._retain
        if len(self._waiting) >= self._queue:
            self.lose("the broker is too slow")
            return False
        info = self._client.paho.publish(self._topic, bytes(data), self._qos, retain)  # not under our lock: it takes paho's
        if info.rc == paho.MQTT_ERR_QUEUE_SIZE or (info.rc == paho.MQTT_ERR_NO_CONN and not self._qos):
            self.lose("the broker is too slow" if info.rc == paho.MQTT_ERR_QUEUE_SIZE else "the broker is not connected")
            return False
        with self._changed:
            if info.rc == paho.MQTT_ERR_NO_CONN or not info.is_published():
                self._waiting.add(info.mid)
        if info.rc == paho.MQTT_ERR_SUCCESS and info.is_published():  # meanwhile
            self._sent(None, None, info.mid)
        self.passed(len(data))
        return True

    def flush(self, timeout: float = 5.0) -> bool:
        with self._changed:
            return self._changed.wait_for(lambda: not self._waiting, timeout)

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            until = monotonic() + self._linger
            self.flush(max(until - monotonic(), 0))
            if left := len(self._waiting):
                self.lose("closed before it was sent", left)
            self._client.close()

    def _sent(self, *arguments: Any) -> None:
        with self._changed:
            self._waiting.discard(arguments[2])
            self._changed.notify_all()


def _topic(address: Address) -> str:
    if not address.rest or "\0" in address.rest or len(address.rest.encode()) > MAX_TOPIC_BYTES:
        raise address.wrong("a topic", "mqtt:robot/arm/joints")
    return address.rest
