"""Services of iceoryx2: slices of bytes in shared memory, and an event of the same name by which a source is woken."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from importlib import import_module
from threading import Event
from time import time_ns
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message, Sink, Source
from rosetta_jit.transports.limits import MAX_SERVICE_BYTES

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost


class Service:
    """A node, and the two services of a name."""

    def __init__(self, address: Address, options: Mapping[str, Any]) -> None:
        if not address.rest or not address.rest.isprintable() or len(address.rest.encode()) > MAX_SERVICE_BYTES:
            raise address.wrong(f"a name of at most {MAX_SERVICE_BYTES} bytes", "iceoryx:camera/left")
        self.iox: Any = import_module("iceoryx2")
        self.iox.set_log_level(self.iox.LogLevel.Error)
        try:
            self.node: Any = (
                self.iox.NodeBuilder.new().signal_handling_mode(self.iox.SignalHandlingMode.Disabled).create(self.iox.ServiceType.Ipc)
            )
            name = self.iox.ServiceName.new(address.rest)
            builder = self.node.service_builder(name).publish_subscribe(self.iox.Slice[ctypes.c_uint8])
            if options["buffer"]:
                builder = builder.subscriber_max_buffer_size(options["buffer"])
            self.messages: Any = builder.open_or_create()
            self.event: Any = self.node.service_builder(name).event().open_or_create()
        except Exception as error:
            if not type(error).__module__.startswith(("iceoryx2", "_iceoryx2", "builtins")):
                raise
            raise TransportError(
                "unreachable", str(address), f"iceoryx2 cannot open the service: {error or type(error).__name__}"
            ) from None


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Receive what is published to a service, in a thread of its own. The data of a message are in shared memory."""
    service = Service(address, options)
    subscriber = service.messages.subscriber_builder().create()
    listener = service.event.listener_builder().create()
    pause = service.iox.Duration.from_secs_f64(max(options["poll"], 0.001))
    channel, most = address.rest, options["max_message"]
    frombuffer = import_module("numpy").frombuffer

    def run(ends: Event) -> None:
        while not ends.is_set():
            while (sample := subscriber.receive()) is not None:
                data = frombuffer(sample.payload().as_memory_view(), "u1").data  # else its elements have no values in Python
                if len(data) > most:
                    source.lose_large(len(data), most)
                else:
                    source.arrived(Message(data, channel, None, time_ns()))
                sample.delete()
            listener.timed_wait(pause)
        for each in (subscriber, listener):
            each.delete()
        source.connections = 0

    source.connections = 1
    source.read(run)


class IceoryxSink(Sink):
    """Copies each message into shared memory, once, and wakes who waits."""

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        self._most: int = options["max_message"]
        self._frombuffer = import_module("numpy").frombuffer
        self._service: Service | None = Service(address, options)
        iox = self._service.iox
        builder = self._service.messages.publisher_builder().initial_max_slice_len(max(options["first"], 1))
        self._publisher: Any = builder.allocation_strategy(iox.AllocationStrategy.PowerOfTwo).create()
        self._notifier: Any = self._service.event.notifier_builder().create()

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        del time, attributes
        if self._service is None:
            raise TransportError("closed", self.address, "this sink is closed")
        size = len(data)
        self.check_size(size, self._most)
        sample = self._publisher.loan_slice_uninit(size)
        if size:
            there = data if isinstance(data, bytes) else self._frombuffer(data, "u1").ctypes.data
            ctypes.memmove(sample.payload().as_ptr(), there, size)
        self.connections = sample.assume_init().send()
        self._notifier.notify()
        self.passed(size)
        return True

    def close(self) -> None:
        if self._service is not None:
            for each in (self._publisher, self._notifier):
                each.delete()
            self._service = None
