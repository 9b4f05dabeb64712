"""Messages from and to ports."""

from __future__ import annotations

from collections.abc import Mapping
from time import monotonic
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Sink, Source
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.yarp.names import name_server, port_name
from rosetta_jit.transports.yarp.port import Port, own_name
from rosetta_jit.transports.yarp.stamps import stamp
from rosetta_jit.transports.yarp.wire import head_of

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Read what a port writes, as soon as there is one; or open a port, and read what others write to it."""
    other = port_name(address)
    is_own = options["open"] == "yes"
    name = other if is_own else own_name(options, other)

    def take(message: Any) -> None:
        message.channel = other
        source.arrived(message)

    port = Port(name, name_server(options, address), options, source, take=take, reads="" if is_own else other)
    source.opened(lambda: port.close(options["linger"]))


class YarpSink(Sink):
    """Writes to all readers of a port of its own, or to a port of others as soon as there is one.

    The attribute `envelope` is sent as it is; a time makes a stamp.
    """

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        other = port_name(address)
        is_own = options["open"] != "no"
        name = other if is_own else own_name(options, other)
        self._most: int = options["max_message"]
        self._linger: float = options["linger"]
        self._wait: float = options["timeout"] if options["wait"] else 0.0
        self._is_own = is_own
        self._sequence = 0
        self._closed = False
        self.port = Port(name, name_server(options, address), options, self, writes="" if is_own else other)

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        if self._closed:
            raise TransportError("closed", self.address, "this sink is closed")
        self.check_size(len(data), self._most)
        head = head_of(len(data), envelope=self._envelope(time, attributes))
        outputs = tuple(self.port.outputs.values())
        if not outputs and not self._is_own:
            self.lose("nobody is connected")
            return False
        taken = not outputs  # a port without readers is as usual as a radio without listeners
        for each in outputs:
            if each.write(head, data) or (self._wait and not loop().is_current and each.wait(self._wait) and each.write(head, data)):
                taken = True
            else:
                self.lose("the reader is too slow")
        if taken:
            self.passed(len(data))
        return taken

    def flush(self, timeout: float = 5.0) -> bool:
        until = monotonic() + timeout
        return all(each.wait(max(until - monotonic(), 0), empty=True) for each in tuple(self.port.outputs.values()))

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            self.port.close(self._linger)

    def _envelope(self, time: int | None, attributes: Mapping[str, Any] | None) -> str | None:
        if attributes is not None and "envelope" in attributes:
            text = str(attributes["envelope"])
            return text.replace("\0", "").replace("\n", " ")[:4000]
        if time is None:
            return None
        self._sequence += 1
        return stamp(int(attributes["sequence"]) if attributes and "sequence" in attributes else self._sequence, time)
