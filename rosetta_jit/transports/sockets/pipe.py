"""Messages in frames through pipes: standard input and output (`-`), named pipes, and files."""

from __future__ import annotations

import errno
import os
import select
import stat
import threading
from collections import deque
from collections.abc import Mapping
from time import monotonic, sleep
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Sink, Source
from rosetta_jit.transports.feeding import Feed, ProtocolError
from rosetta_jit.transports.limits import MAX_WAITING_BYTES
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.sockets.framing import framed, messages

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost


def subscribe(address: Address, source: Source, options: Mapping[str, Any]) -> None:
    """Receive what comes through a pipe, in a thread of its own; at its end the source ends."""
    if options["frame"] == "none":
        raise TransportError("protocol", str(address), "a pipe needs frames")
    stopped_read, stopped_write = os.pipe2(os.O_CLOEXEC)
    try:  # a named pipe that nobody writes to is opened at once this way, and read when somebody does
        number = os.dup(0) if address.rest == "-" else os.open(address.rest, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError as error:
        os.close(stopped_read)
        os.close(stopped_write)
        raise _unreachable(address, error) from None
    thread = threading.Thread(target=_read, args=(number, stopped_read, address.rest, source, options), name=str(address), daemon=True)
    thread.start()

    def stop() -> None:
        os.close(stopped_write)
        if thread is not threading.current_thread():
            thread.join()

    source.opened(stop)


def _read(number: int, stopped: int, channel: str, source: Source, options: Mapping[str, Any]) -> None:
    def read_into(room: memoryview) -> int:
        return os.readv(number, [room])

    feed = Feed(messages(options["frame"], source.taker(channel), options["max_message"]))
    poll = select.poll()
    poll.register(number, select.POLLIN)
    poll.register(stopped, select.POLLHUP)
    is_named = stat.S_ISFIFO(os.fstat(number).st_mode) and channel != "-"
    source.connections = 1
    came = False
    try:
        while not any(each == stopped for each, _ in poll.poll(100 if is_named and not came else None)):
            try:
                is_some = feed.receive(read_into)
            except BlockingIOError:
                continue
            if is_some:
                came = True
            elif came or not is_named:  # a named pipe reads as ended until its first writer comes
                break
            else:
                threading.Event().wait(0.01)
        if not feed.is_between:
            source.lose("the pipe ended in the middle of a message")
    except ProtocolError as error:
        source.lose(str(error))
    except OSError as error:
        source.lose(error.strerror or "the pipe failed")
    finally:
        os.close(number)
        os.close(stopped)
        source.connections = 0
        source.ended()


def publish(address: Address, options: Mapping[str, Any], lost: Lost | None) -> Sink:
    """Send through a pipe. A named one is opened when somebody reads it, within the seconds that the option `timeout` says."""
    sink = PipeSink(address, options, lost)
    until = monotonic() + options["timeout"]
    while not sink.reopen():
        if monotonic() > until:
            raise TransportError("unreachable", str(address), "nobody reads the pipe")
        sleep(0.01)
    return sink


class PipeSink(Sink):
    """Writes each message; a full pipe makes the sender wait.

    The thread that serves all sockets of the process must not wait: what a pipe does not take at once from it waits here, for a thread of
    the sink's own. Where the reader of a named pipe goes and another one comes, that one gets the messages from then on.
    """

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        self._place = address
        self._frame: str = options["frame"]
        self._most: int = options["max_message"]
        self._linger: float = options["linger"]
        self._number = -1
        self._never_full = False
        self._closed = False
        self._changed = threading.Condition()
        self._waiting: deque[bytes] = deque()
        self._waiting_bytes = 0
        self._is_writing = False
        self._thread: threading.Thread | None = None

    def reopen(self) -> bool:
        """Open the file, or the pipe if somebody reads it; False where nobody does. It does not wait."""
        try:
            if self._place.rest == "-":
                self._number = os.dup(1)
            else:
                flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC
                self._number = os.open(self._place.rest, flags | os.O_NONBLOCK, 0o666)
                os.set_blocking(self._number, True)
        except OSError as error:
            if error.errno == errno.ENXIO:
                return False
            raise _unreachable(self._place, error) from None
        self._never_full = stat.S_ISREG(os.fstat(self._number).st_mode)
        self.connections = 1
        return True

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        del time, attributes
        whole = b"".join(framed(self._frame, data, self._most, self.address))
        with self._changed:
            if not loop().is_current:
                self._changed.wait_for(lambda: self._closed or self._is_idle())
            if self._closed:
                raise TransportError("closed", self.address, "this sink is closed")
            waits = loop().is_current and not (self._is_idle() and self._has_room(len(whole)))
            taken = waits and self._let_wait(whole)
            self._is_writing |= not waits
        taken = taken if waits else self._write(whole)
        if taken:
            self.passed(len(data))
        return taken

    def flush(self, timeout: float = 5.0) -> bool:
        with self._changed:
            return self._changed.wait_for(self._is_idle, timeout)

    def close(self) -> None:
        with self._changed:
            if not self._closed and not loop().is_current:
                self._changed.wait_for(self._is_idle, self._linger)
            self._closed = True
            left = len(self._waiting) + self._is_writing
            self._waiting.clear()
            self._hang_up()
            self._changed.notify_all()
        if left:
            self.lose("closed before it was sent", left)

    def _is_idle(self) -> bool:
        return not self._waiting and not self._is_writing

    def _has_room(self, size: int) -> bool:
        """Whether so many bytes can be written without waiting."""
        if self._number < 0 or self._never_full:
            return True
        poll = select.poll()
        poll.register(self._number, select.POLLOUT)
        return size <= select.PIPE_BUF and bool(poll.poll(0))

    def _let_wait(self, whole: bytes) -> bool:
        """Leave a message to the sink's own thread; False where too much waits."""
        if self._waiting and self._waiting_bytes + len(whole) > MAX_WAITING_BYTES:
            self.lose("the reader is too slow")
            return False
        if self._thread is None:
            self._thread = threading.Thread(target=self._write_waiting, name=f"writes {self.address}", daemon=True)
            self._thread.start()
        self._waiting.append(whole)
        self._waiting_bytes += len(whole)
        self._changed.notify_all()
        return True

    def _write_waiting(self) -> None:
        """The sink's own thread."""
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closed or (self._waiting and not self._is_writing))
                if self._closed:
                    return
                whole, self._is_writing = self._waiting.popleft(), True
                self._waiting_bytes -= len(whole)
            self._write(whole)

    def _write(self, whole: bytes) -> bool:
        """Write a message; whether it was written. Where it was not, it is counted."""
        rest = memoryview(whole)
        try:
            if self._number < 0 and self.reopen():
                self.reconnects += 1
            while rest and self._number >= 0:
                rest = rest[os.write(self._number, rest) :]
        except (OSError, TransportError):
            with self._changed:
                self._hang_up()
        with self._changed:
            self._is_writing = False
            self._changed.notify_all()
        if rest and not self._closed:  # `close` has counted it
            self.lose("nobody reads the pipe")
        return not rest

    def _hang_up(self) -> None:
        number, self._number = self._number, -1
        self.connections = 0
        if number >= 0:
            os.close(number)


def _unreachable(address: Address, error: OSError) -> TransportError:
    return TransportError("unreachable", str(address), error.strerror or str(error))
