"""Channels of LCM; each source has a thread that waits for the next message."""

from __future__ import annotations

import os
from collections.abc import Mapping
from importlib import import_module
from threading import Event
from time import time_ns
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message, Sink, Source
from rosetta_jit.transports.limits import MAX_CHANNEL_BYTES

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost

DEFAULT_URL = "udpm://239.255.76.67:7667?ttl=0"
LOOK_MS = 100
"""How often the thread looks whether its source was closed."""


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Receive the messages of a channel, or of all whose names match a regular expression."""
    most = options["max_message"]
    client = _client(address, options)

    def take(channel: str, data: bytes) -> None:
        if len(data) > most:
            source.lose_large(len(data), most)
            return
        attributes = {"fingerprint": int.from_bytes(data[:8], "big")} if len(data) >= 8 else None
        source.arrived(Message(data, channel, None, time_ns(), None, attributes))

    def run(ends: Event) -> None:
        while not ends.is_set():
            try:
                client.handle_timeout(LOOK_MS)
            except OSError as error:
                source.lose(error.strerror or "LCM failed", 0)
                break
        source.connections = 0
        source.ended()

    client.subscribe(_channel(address, MAX_CHANNEL_BYTES * 4), take)
    source.connections = 1
    source.read(run)


class LcmSink(Sink):
    """Sends to a channel; nobody says whether it arrived."""

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        self._channel = _channel(address, MAX_CHANNEL_BYTES)
        self._most: int = options["max_message"]
        self._client: Any = _client(address, options)
        self.connections = 1

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        del time, attributes
        if self._client is None:
            raise TransportError("closed", self.address, "this sink is closed")
        self.check_size(len(data), self._most)
        try:
            self._client.publish(self._channel, bytes(data))
        except OSError as error:
            self.lose(error.strerror or "LCM cannot send")
            return False
        self.passed(len(data))
        return True

    def close(self) -> None:
        self._client = None
        self.connections = 0


def _client(address: Address, options: Mapping[str, Any]) -> Any:
    url = options["url"] or os.environ.get("LCM_DEFAULT_URL") or DEFAULT_URL
    try:
        return import_module("lcm").LCM(url)  # it has no types
    except (RuntimeError, ValueError, OSError) as error:
        raise TransportError("unreachable", str(address), f"LCM cannot open {url}: {error}") from None


def _channel(address: Address, most: int) -> str:
    if not address.rest or not address.rest.isprintable() or len(address.rest.encode()) > most:
        raise address.wrong(f"a channel of at most {MAX_CHANNEL_BYTES} bytes", "lcm:POSE")
    return address.rest
