"""Messages over TCP or Unix sockets, in frames. Either end may listen; many may connect to who listens."""

from __future__ import annotations

import socket
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Sink, Source
from rosetta_jit.transports.connecting import Dialer, Listener
from rosetta_jit.transports.end import End
from rosetta_jit.transports.limits import MAX_CONNECTIONS
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.sockets.endpoints import targets
from rosetta_jit.transports.sockets.framing import LENGTHS, framed, messages
from rosetta_jit.transports.stream import Stream, finish_all

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost
    from rosetta_jit.transports.feeding import Machine


class Links:
    """The connections of one end, which listens or connects.

    Parameters
    ----------
    counts
        Of the end.
    machine
        What reads of a connection.
    went
        Is called in the loop's thread when a connection goes.
    """

    def __init__(
        self,
        address: Address,
        counts: End,
        machine: Callable[[Stream], Machine],
        *,
        listen: bool,
        went: Callable[[], object] = lambda: None,
    ) -> None:
        self.streams: tuple[Stream, ...] = ()
        self._counts = counts
        self._machine = machine
        self._went = went
        self._was_connected = False
        self._closed = False
        self.listener: Listener | None = None
        self.dialer: Dialer | None = None
        places = targets(address)
        if listen:
            self.listener = Listener(places[0], self._came)
        else:
            self.dialer = Dialer(places, self._came)
            loop().run(self.dialer.start)

    def close(self, linger: float) -> None:
        """Close all, sending what waits first."""
        if self.listener is not None:
            self.listener.close()
        loop().run(self._stop)
        finish_all(self.streams, linger)

    def flush(self, timeout: float) -> bool:
        """Wait until nothing waits to be sent."""
        return all(each.wait(timeout, empty=True) for each in self.streams)

    def _stop(self) -> None:
        self._closed = True
        if self.dialer is not None:
            self.dialer.stop()

    def _came(self, sock: socket.socket) -> None:
        if len(self.streams) >= MAX_CONNECTIONS or self._closed:
            sock.close()
            self._counts.lose("too many connections", 0)
            return
        if self.dialer is not None and self._was_connected:
            self._counts.reconnects += 1
        self._was_connected = True
        stream = Stream(sock, self._machine, self._gone)
        self.streams = *self.streams, stream
        self._counts.connections = len(self.streams)
        stream.start()

    def _gone(self, stream: Stream, why: str) -> None:
        self.streams = tuple(each for each in self.streams if each is not stream)
        self._counts.connections = len(self.streams)
        if stream.unsent:
            self._counts.lose("closed before it was sent" if self._closed else "the peer went away", stream.unsent.total())
        elif stream.cut or why:
            self._counts.lose(why or "the connection ended in the middle of a message")
        if self.dialer is not None and not self._closed:
            self.dialer.lost()
        self._went()


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Receive over all connections."""
    take, frame, most = source.taker(address.rest), options["frame"], options["max_message"]
    if frame == "none":
        raise TransportError("protocol", str(address), "a stream needs frames: `none` is for what is sent, or for udp")
    links = Links(address, source, lambda _: messages(frame, take, most), listen=options["listen"] != "no")
    source.opened(lambda: links.close(0))


class TcpSink(Sink):
    """Sends each message to every connection; where there is none yet, `send` waits for one."""

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        self._frame: str = options["frame"]
        self._most: int = options["max_message"]
        self._length = LENGTHS.get(self._frame, LENGTHS["u64"])
        self._largest = min(self._most, 256**self._length.size - 1) if self._frame in LENGTHS else -1
        """Bytes that a message may have to be sent by `at_once`; once this is closed, none has so few."""
        self._wait = options["timeout"] if options["wait"] else 0
        self._linger: float = options["linger"]
        self._closed = False
        self._links = Links(address, self, _ignore, listen=options["listen"] == "yes")

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        del time, attributes
        if self._closed:
            raise TransportError("closed", self.address, "this sink is closed")
        parts = framed(self._frame, data, self._most, self.address)
        streams = self._links.streams or self._first()
        if not streams:
            self.lose("nobody is connected")
            return False
        taken = False
        for each in streams:
            if each.send(*parts) or (self._wait and not loop().is_current and each.wait(self._wait) and each.send(*parts)):
                taken = True
            else:
                self.lose("the peer is too slow")
        if taken:
            self.passed(len(data))
        return taken

    def at_once(self, data: bytes | bytearray | memoryview) -> bool:
        """Send to the only connection."""
        size, streams = len(data), self._links.streams
        if len(streams) != 1 or size > self._largest or not streams[0].send(self._length.pack(size), data):
            return False
        self.messages += 1
        self.bytes += size
        return True

    def flush(self, timeout: float = 5.0) -> bool:
        return self._links.flush(timeout)

    def close(self) -> None:
        if not self._closed:
            self._closed, self._largest = True, -1
            self._links.close(self._linger)

    def _first(self) -> tuple[Stream, ...]:
        """The first connection, where one comes in time."""
        return () if loop().is_current else waited(self._links, self._wait)


def waited(links: Links, seconds: float) -> tuple[Stream, ...]:
    """The connections, as soon as there is one or so many seconds have passed."""
    from time import monotonic, sleep

    until = monotonic() + seconds
    while not links.streams and monotonic() < until:
        sleep(0.002)
    return links.streams


def _ignore(_: Stream) -> Machine:
    """Read what a receiver sends back, and drop it."""
    from rosetta_jit.transports.feeding import Between

    while True:
        yield Between(1)
