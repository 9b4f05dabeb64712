"""Connected stream sockets in the loop: what comes is fed to a protocol, what is sent waits its turn, and each ends for itself."""

from __future__ import annotations

import socket
import threading
from collections import Counter, deque
from collections.abc import Callable, Iterable
from time import monotonic
from typing import TYPE_CHECKING

from rosetta_jit.transports.feeding import FIRST_BYTES, Feed, ProtocolError
from rosetta_jit.transports.limits import MAX_HELD_BYTES, MAX_WAITING_BYTES
from rosetta_jit.transports.loop import READ, WRITE, Timer, loop

if TYPE_CHECKING:
    from rosetta_jit.transports.end import End
    from rosetta_jit.transports.feeding import Machine

    Bytes = bytes | bytearray | memoryview


class Stream:
    """One connection, in the loop.

    Parameters
    ----------
    sock
        Connected.
    machine
        The generator of the protocol, made for this stream.
    ended
        Is called once in the loop's thread, when the connection is gone: with the stream and why, empty where it ended in order.

    Attributes
    ----------
    peer : str
        The other end's address.
    cut : bool
        Whether it ended in the middle of a message.
    unsent : Counter
        Once it has ended: how often `send` took something that was not sent any more, by who sent it.
    """

    def __init__(
        self,
        sock: socket.socket,
        machine: Callable[[Stream], Machine],
        ended: Callable[[Stream, str], object],
    ) -> None:
        sock.setblocking(False)
        _tune(sock)
        self.socket = sock
        self._receive = sock.recv_into
        self.peer = _name(sock)
        self.cut = False
        self.unsent: Counter[End | None] = Counter()
        self.closed = False
        self._ended = ended
        self._machine = machine
        self._feed: Feed | None = None
        self._waiting: deque[tuple[memoryview, End | None]] = deque()
        self._waiting_bytes = 0
        self._turn = threading.RLock()  # a signal may interrupt a sender, and its handler send, too
        self._room = threading.Condition(self._turn)
        self._finishing = False
        self._paused = False
        self._deadline: Timer | None = None
        self._events = 0
        self._held = 0

    def start(self) -> Stream:
        """Begin to read; in the loop's thread."""
        self._feed = Feed(self._machine(self))
        self._watch()
        return self

    def within(self, seconds: float, why: str) -> None:
        """End it unless `in_time` is called within so many seconds; in the loop's thread."""
        self.in_time()
        self._deadline = loop().later(seconds, lambda: self.end(why))

    def in_time(self) -> None:
        """Stop the timer of `within`: what it waited for has come."""
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def send(self, *parts: Bytes, sender: End | None = None) -> bool:
        """Send parts as one, or let them wait; from any thread. False where too much waits, or it is closed: then nothing is sent.

        Where several ends share the connection, ``sender`` is the one that has to know what is not sent in the end.
        """
        size = sum(map(len, parts))
        with self._turn:  # not the condition, whose block is entered by a function of Python
            if self.closed or self._finishing or (self._waiting and self._waiting_bytes + size > MAX_WAITING_BYTES):
                return False
            sent = 0
            if not self._waiting:
                try:
                    sent = self.socket.sendmsg(parts)
                except BlockingIOError:
                    pass
                except OSError as error:
                    loop().soon(self.end, _why(error))
                    return False
                if sent == size:
                    return True
            if not loop().reserve(size - sent):
                if sent:  # half of it: nothing may follow
                    self._finishing = True
                    loop().soon(self.end, "what waits for all peers together takes too much memory")
                return False
            rest = memoryview(b"".join(parts))[sent:]
            self._waiting.append((rest, sender))
            self._waiting_bytes += len(rest)
        loop().soon(self._watch)
        return True

    def wait(self, seconds: float, *, empty: bool = False) -> bool:
        """Wait for room, or until nothing waits any more; False where that takes longer. Not in the loop's thread."""
        until = monotonic() + seconds
        with self._room:
            while not self.closed and (self._waiting_bytes > (0 if empty else MAX_WAITING_BYTES // 2)):
                if not self._room.wait(until - monotonic()) and monotonic() >= until:
                    return False
        return True

    @property
    def waiting(self) -> int:
        """Bytes that are not sent yet."""
        return self._waiting_bytes

    def pause(self, *, paused: bool) -> None:
        """Stop reading, or go on; in the loop's thread. The peer notices when its own buffers are full."""
        self._paused = paused
        self._watch()

    def finish(self, linger: float) -> None:
        """Send what waits, then close; at the latest after so many seconds. From any thread."""
        self._finishing = True
        loop().soon(self._finish, linger)

    def end(self, why: str = "") -> None:
        """Close now; in the loop's thread."""
        if self.closed:
            return
        with self._room:
            self.closed = True
            self.unsent = Counter(sender for _, sender in self._waiting)
            self._waiting.clear()
            loop().release(self._waiting_bytes)
            self._waiting_bytes = 0
            self._room.notify_all()
        self.in_time()
        loop().unwatch(self.socket.fileno())
        if self._feed is not None:
            self.cut = not self._feed.is_between
            self._feed.close()
        self.socket.close()
        loop().held_bytes -= self._held
        self._ended(self, why)

    def _finish(self, linger: float) -> None:
        """Half-close, and wait for the peer to do the same: a socket that is closed with unread bytes takes back what it sent last."""
        self._finishing = True
        if not linger:
            self.end()
        elif not self.closed:
            loop().later(linger, self.end)
            self._half_close()

    def _half_close(self) -> None:
        if not self._waiting:
            try:
                self.socket.shutdown(socket.SHUT_WR)
            except OSError:
                self.end()

    def _watch(self) -> None:
        if self.closed:
            return
        events = (0 if self._paused else READ) | (WRITE if self._waiting else 0)
        if events != self._events or not self._events:
            self._events = events
            loop().watch(self.socket.fileno(), events, self._ready)

    def _ready(self, events: int) -> None:
        """Called for each message: what it takes, each message takes longer."""
        if events != READ:
            if events & WRITE:
                self._write()
            if not events & ~WRITE or self.closed:
                return
        feed = self._feed
        assert feed is not None
        try:
            if not feed.receive(self._receive):
                self.end()
                return
            if feed.size != self._held and not self.closed:
                self._hold(feed.size)
        except BlockingIOError:
            return
        except ProtocolError as error:
            self.end(str(error))
        except OSError as error:
            self.end(_why(error))
        except Exception:
            self.end("a mistake in rosetta_jit")
            raise
        if feed.done and not self.closed and not self._finishing:
            self._finish(1.0)

    def _hold(self, size: int) -> None:
        """Count what the buffer takes, which has grown."""
        loop().held_bytes += size - self._held
        self._held = size
        if loop().held_bytes > MAX_HELD_BYTES and size > FIRST_BYTES:
            raise ProtocolError("large messages of all peers together take too much memory")

    def _write(self) -> None:
        try:
            with self._room:
                while self._waiting:
                    data, sender = self._waiting[0]
                    sent = self.socket.send(data)
                    self._waiting_bytes -= sent
                    loop().release(sent)
                    if sent < len(data):
                        self._waiting[0] = data[sent:], sender
                        break
                    self._waiting.popleft()
                self._room.notify_all()
        except BlockingIOError:
            pass
        except OSError as error:
            self.end(_why(error))
            return
        if self._finishing:
            self._half_close()
        self._watch()


def finish_all(streams: Iterable[Stream], linger: float) -> None:
    """Close connections once all that waits is sent, at the latest after so many seconds: what waits then is lost. From any thread."""
    until = monotonic() + linger
    for each in tuple(streams):
        if loop().is_current or each.wait(until - monotonic(), empty=True):
            each.finish(linger)
        else:
            loop().run(each.end)


def _why(error: OSError) -> str:
    return error.strerror or str(error)


def _name(sock: socket.socket) -> str:
    try:
        found = sock.getpeername()
    except OSError:
        return "gone"
    return f"{found[0]}:{found[1]}" if isinstance(found, tuple) else str(found or "local")


def _tune(sock: socket.socket) -> None:
    """Send at once; notice peers that vanished without a word within half a minute."""
    if sock.family in (socket.AF_INET, socket.AF_INET6):
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        for option, value in (
            (socket.TCP_KEEPIDLE, 10),
            (socket.TCP_KEEPINTVL, 5),
            (socket.TCP_KEEPCNT, 3),
            (socket.TCP_USER_TIMEOUT, 30_000),
        ):
            sock.setsockopt(socket.IPPROTO_TCP, option, value)
