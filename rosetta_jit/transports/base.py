"""What a transport is, and what it gives a user: sources and sinks of raw messages. Its remote procedure calls are in `calls`."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from time import time_ns
from typing import TYPE_CHECKING, Any, cast

from rosetta_jit.startup.dataclass import dataclass, field
from rosetta_jit.startup.garbage import object_at
from rosetta_jit.transports.end import End, not_open
from rosetta_jit.transports.limits import MAX_QUEUE_BYTES
from rosetta_jit.transports.message import Message

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Option

    Bytes = bytes | memoryview
    Deliver = Callable[["Message"], object]
    Lost = Callable[[str, int], object]

QUEUE = 1000
"""Messages that wait for who iterates over a source, where nobody says how many."""


class Source(End):
    """Messages that arrive at an address; a context manager, and an iterable where no callback gets them.

    Iterating ends when the source is closed, or where the channel has an end (a pipe, a file). Messages that nobody takes
    wait, at most ``queue`` of them; then the oldest is dropped, and counted as `queue full`.

    Attributes
    ----------
    plain : callable or None
        Takes the bytes of messages, and the time when they were sent or else received, in place of the callback: for bridges, which need
        nothing else. It may change while messages come.
    """

    plain: Callable[[Bytes, int], object] | None = None

    def __init__(self, address: str, deliver: Deliver | None, lost: Lost | None, *, queue: int = QUEUE) -> None:
        super().__init__(address, lost)
        self._waiting: deque[Message] = deque()
        self._waiting_bytes = 0
        self._most = max(queue, 1)
        self._changed = threading.Condition()
        self._ended = False
        self._close: Callable[[], None] = not_open
        self._deliver = self._put if deliver is None else deliver

    def arrived(self, message: Message) -> None:
        """Count a message, and pass it on; for transports. What the callback raises is reported, and costs this message alone."""
        self.messages += 1
        self.bytes += len(message.data)
        try:
            if self.plain is not None:
                self.plain(message.data, message.sent or message.time)
            else:
                self._deliver(message)
        except Exception as error:  # noqa: BLE001 - the user's code: it must not end the thread that serves all connections
            self._callback_failed(error)

    def taker(self, channel: str, type_: str | None = None, attributes: Mapping[str, Any] | None = None) -> Callable[[Bytes], object]:
        """A function that takes the bytes of messages, which are alike in all else: quicker than `arrived`; for transports."""

        def take(data: Bytes) -> None:
            self.messages += 1
            self.bytes += len(data)
            try:
                if self.plain is not None:
                    self.plain(data, time_ns())
                else:
                    self._deliver(Message(data, channel, type_, time_ns(), None, attributes))
            except Exception as error:  # noqa: BLE001 - as above
                self._callback_failed(error)

        return take

    def _callback_failed(self, error: Exception) -> None:
        self.lose("the callback failed")
        threading.excepthook(threading.ExceptHookArgs((type(error), error, error.__traceback__, threading.current_thread())))

    def opened(self, close: Callable[[], None]) -> Source:
        """Say what closes it; for transports."""
        self._close = close
        return self

    def read(self, run: Callable[[threading.Event], object]) -> Source:
        """Receive in a thread of its own, until the event that it gets is set; for transports."""
        ends = threading.Event()
        thread = threading.Thread(target=run, args=(ends,), name=self.address, daemon=True)

        def close() -> None:
            ends.set()
            if thread is not threading.current_thread():
                thread.join()

        thread.start()
        return self.opened(close)

    def ended(self) -> None:
        """Nothing comes any more; for transports."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()

    def take(self, timeout: float | None = None) -> Message | None:
        """The next message; None after so many seconds without one, or at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._ended, timeout)
            return self._next() if self._waiting else None

    def close(self) -> None:
        """Stop receiving. Messages that wait can still be taken."""
        close, self._close = self._close, not_open
        close()
        self.ended()

    def _put(self, message: Message) -> None:
        message.keep()
        dropped = 0
        with self._changed:
            while len(self._waiting) >= self._most or (self._waiting and self._waiting_bytes + len(message.data) > MAX_QUEUE_BYTES):
                self._next()
                dropped += 1
            self._waiting.append(message)
            self._waiting_bytes += len(message.data)
            self._changed.notify()
        if dropped:
            self.lose("queue full", dropped)

    def _next(self) -> Message:
        """Take the oldest message out of the queue."""
        message = self._waiting.popleft()
        self._waiting_bytes -= len(message.data)
        return message

    def __iter__(self) -> Iterator[Message]:
        while (message := self.take()) is not None:
            yield message


class Sink(End):
    """Where messages are sent; a context manager. Transports derive from it."""

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        """Send one message. It never waits for a peer longer than the transport's options say.

        Parameters
        ----------
        data
            The bytes; they may be changed when the call returns.
        time
            When it was made, in nanoseconds since 1970, for transports that tell it; by default now.
        attributes
            What the transport can tell besides, with the names that its messages have.

        Returns
        -------
        bool
            Whether it was taken. Where it was not, `lost` counts it.

        Raises
        ------
        TransportError
            It is larger than ``max_message``, or the sink is closed.
        """
        raise NotImplementedError

    def at_once(self, data: bytes | bytearray | memoryview) -> bool:
        """Send by the shortest way, to the only peer. False where more is to be done, as `send` does: then nothing was sent or counted."""
        del data
        return False

    def flush(self, timeout: float = 5.0) -> bool:
        """Wait until all that was taken is on its way; False where that takes longer than so many seconds."""
        del timeout
        return True

    def close(self) -> None:
        """Send what was taken, for as long as the option `linger` says, and stop."""


@dataclass(frozen=True, slots=True)
class Transport:
    """One transport; every function, or class of ends, as ``module:name``, imported when first used. Empty where it lacks a direction.

    Attributes
    ----------
    name
        What people call it.
    schemes
        The words that addresses of it begin with.
    example
        An address, for help and errors.
    subscribe
        ``(address, source, options) -> None``: fills the `Source`, and tells it what closes it by `Source.opened`.
    publish
        ``(address, options, lost) -> Sink``.
    call
        ``(address, options) -> Caller``.
    serve
        ``(address, server, options) -> None``, as ``subscribe``.
    names
        ``(address, options) -> list of (channel, type or None)``: which channels there are, for patterns in configurations.
    check
        ``(address) -> object``: raises AddressError where the address names no channel, and opens nothing.
    options
        By name; `COMMON` are added.
    types
        For schemes whose options tell of a type, the framework of such types: ``{"ros1": "ros1"}``.
    asks
        Those of these options by which a subscriber can ask for one type alone.
    extra
        The extra of rosetta_jit that it takes, and the module whose absence tells: ``("zenoh", "zenoh")``.
    """

    name: str
    schemes: tuple[str, ...]
    example: str
    subscribe: str = ""
    publish: str = ""
    call: str = ""
    serve: str = ""
    names: str = ""
    check: str = ""
    options: Mapping[str, Option] = field(default_factory=dict[str, "Option"])
    types: Mapping[str, str] = field(default_factory=dict[str, str])
    asks: tuple[str, ...] = ()
    extra: tuple[str, str] = ("", "")

    def function(self, direction: str) -> Callable[..., Any]:
        """The function for a direction, `subscribe` and so on, or `check`; the caller has seen that there is one."""
        return cast("Callable[..., Any]", object_at(getattr(self, direction)))
