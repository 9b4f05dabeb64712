"""The connections that a port makes to readers: the hello, messages that wait for the acknowledgement of the last one, and the goodbye."""

from __future__ import annotations

import threading
from collections import deque
from typing import TYPE_CHECKING

from rosetta_jit.transports.feeding import Between, ProtocolError
from rosetta_jit.transports.limits import MAX_SKIPPED_BYTES, MAX_WAITING_BYTES
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.yarp.wire import goodbye, hello, int_of

if TYPE_CHECKING:
    from rosetta_jit.transports.feeding import Machine
    from rosetta_jit.transports.stream import Stream


class Output:
    """One connection to a reader.

    Attributes
    ----------
    target
        The reader's port.
    carrier
        ``tcp`` or ``fast_tcp``.
    stream
        Its connection, once there is one.
    """

    def __init__(self, name: str, target: str, carrier: str) -> None:
        self.target = target
        self.carrier = carrier
        self.stream: Stream | None = None
        self._name = name
        self._waiting: deque[bytes] = deque()
        self._bytes = 0
        self._is_free = False
        self._unanswered = 0
        self._changed = threading.Condition()

    def machine(self, stream: Stream) -> Machine:
        """Say hello, then take acknowledgements."""
        stream.within(10.0, "the reader did not answer the hello")
        stream.send(hello(self.carrier, self._name))
        int_of((yield 8))
        stream.in_time()
        while True:
            self._next(stream)
            while self.carrier == "fast_tcp":
                yield Between(1)
            skipped = int_of((yield Between(8)))
            if not 0 <= skipped <= MAX_SKIPPED_BYTES:
                raise ProtocolError("an acknowledgement of impossible length")
            yield skipped

    def write(self, head: bytes, data: bytes | bytearray | memoryview) -> bool:
        """Send a message, or let it wait; False where too much waits."""
        with self._changed:
            stream = self.stream
            if stream is None or stream.closed:
                return False
            if self._is_free and not self._waiting:
                sent = stream.send(head, data)
                self._is_free = not sent or self.carrier == "fast_tcp"
                self._unanswered = not self._is_free
                return sent
            size = len(head) + len(data)
            if (self._waiting and self._bytes + size > MAX_WAITING_BYTES) or not loop().reserve(size):
                return False
            self._waiting.append(b"".join((head, data)))
            self._bytes += size
        return True

    def wait(self, seconds: float, *, empty: bool = False) -> bool:
        """Wait for room, or until all is sent and acknowledged; False where that takes longer."""
        stream = self.stream
        with self._changed:
            most = 0 if empty else MAX_WAITING_BYTES // 2

            def is_done() -> bool:
                gone = self.stream is None or self.stream.closed
                return gone or (self._bytes <= most and not (empty and (self._waiting or self._unanswered)))

            done = self._changed.wait_for(is_done, seconds)
        return done and (stream is None or stream.wait(seconds, empty=empty))

    def close(self, linger: float) -> int:
        """Say goodbye; gives the number of messages that were not sent."""
        with self._changed:
            left, stream = len(self._waiting), self.stream
            self._clear()
        if stream is None:
            return left
        if stream.waiting and not loop().is_current:  # `wait` has waited for it
            loop().run(stream.end)
            return left + stream.unsent.total()
        stream.send(goodbye())
        stream.finish(linger)
        return left

    def gone(self) -> int:
        """The connection is gone; gives the number of messages that waited."""
        with self._changed:
            unsent = 0 if self.stream is None else self.stream.unsent.total()
            left = len(self._waiting) + (self._unanswered or unsent)
            self._clear()
            self._changed.notify_all()
        return left

    def _clear(self) -> None:
        self._waiting.clear()
        loop().release(self._bytes)
        self._bytes = 0

    def _next(self, stream: Stream) -> None:
        """The reader is ready: send what waits, one message where it acknowledges each."""
        with self._changed:
            self._is_free, self._unanswered = True, 0
            while self._waiting and self._is_free:
                self._is_free = self.carrier == "fast_tcp"
                self._unanswered = not self._is_free
                data = self._waiting.popleft()
                self._bytes -= len(data)
                loop().release(len(data))
                if not stream.send(data):  # it counts as unanswered
                    self._unanswered = 1
                    loop().soon(stream.end, "what waits for all peers together takes too much memory")
            self._changed.notify_all()
