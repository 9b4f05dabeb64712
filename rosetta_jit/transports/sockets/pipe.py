"""Messages in frames through pipes: standard input and output (`-`), named pipes, and files."""

from __future__ import annotations

import os
import threading
from time import time_ns
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import Message, Sink, Source
from rosetta_jit.transports.feeding import Feed, ProtocolError
from rosetta_jit.transports.sockets.framing import framed, messages

if TYPE_CHECKING:
    from collections.abc import Mapping

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
    import select
    import stat

    def take(data: memoryview) -> None:
        source.arrived(Message(data, channel, None, time_ns()))

    feed = Feed(messages(options["frame"], take, options["max_message"]))
    poll = select.poll()
    poll.register(number, select.POLLIN)
    poll.register(stopped, select.POLLHUP)
    is_named = stat.S_ISFIFO(os.fstat(number).st_mode) and channel != "-"
    source.connections = 1
    came = False
    try:
        while not any(each == stopped for each, _ in poll.poll(100 if is_named and not came else None)):
            try:
                count = os.readv(number, [feed.room()])
            except BlockingIOError:
                continue
            if count:
                came = True
                feed.filled(count)
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
    """Send through a pipe; opening a named one waits for its reader."""
    return PipeSink(address, options, lost)


class PipeSink(Sink):
    """Writes each message; a full pipe makes the sender wait."""

    def __init__(self, address: Address, options: Mapping[str, Any], lost: Lost | None) -> None:
        super().__init__(str(address), lost)
        self._frame: str = options["frame"]
        self._most: int = options["max_message"]
        self._lock_file = threading.Lock()
        self._broken = False
        try:
            self._file = (
                os.dup(1) if address.rest == "-" else os.open(address.rest, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o666)
            )
        except OSError as error:
            raise _unreachable(address, error) from None
        self.connections = 1

    def send(self, data: bytes | bytearray | memoryview, *, time: int | None = None, attributes: Mapping[str, Any] | None = None) -> bool:
        del time, attributes
        if self._file < 0:
            raise TransportError("closed", self.address, "this sink is closed")
        whole = memoryview(b"".join(framed(self._frame, data, self._most, self.address)))
        try:
            with self._lock_file:
                while whole and not self._broken:
                    whole = whole[os.write(self._file, whole) :]
        except OSError:
            self._broken = True
        if self._broken:
            self.connections = 0
            self.lose("nobody reads the pipe")
            return False
        self.passed(len(data))
        return True

    def close(self) -> None:
        number, self._file = self._file, -1
        if number >= 0:
            os.close(number)


def _unreachable(address: Address, error: OSError) -> TransportError:
    return TransportError("unreachable", str(address), error.strerror or str(error))
