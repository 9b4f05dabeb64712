"""The connections by udp and mcast that a port makes to readers: hello by TCP, messages by datagrams."""

from __future__ import annotations

import ipaddress
import socket
import threading
from collections import deque
from collections.abc import Callable
from time import monotonic
from typing import TYPE_CHECKING, Any

from rosetta_jit.transports.datagrams import sending
from rosetta_jit.transports.feeding import ProtocolError
from rosetta_jit.transports.limits import MAX_WAITING_BYTES
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.yarp.pieces import MOST, cut
from rosetta_jit.transports.yarp.wire import hello, int_of

if TYPE_CHECKING:
    from rosetta_jit.transports.yarp.names import Contact

    Bytes = bytes | bytearray | memoryview

LONG = MOST * 3 // 4
PAUSE_S = 0.001
"""After a datagram longer than `LONG`, as YARP does it: readers' buffers have room for few of them."""


class Sender:
    """Sends messages as datagrams to one place. Those that cannot be sent at once wait, and long ones go with pauses between.

    Parameters
    ----------
    failed
        Is called in the loop's thread where the system says that nobody is there.
    """

    def __init__(self, sock: socket.socket, failed: Callable[[], object]) -> None:
        self._socket = sock
        self._failed = failed
        self._waiting: deque[deque[bytes]] = deque()
        self._bytes = 0
        self._free_s = 0.0
        self._lost = 0
        self._is_closed = False
        self._changed = threading.Condition()

    def write(self, head: bytes, data: Bytes) -> bool:
        """Send a message, or let it wait; False where too much waits."""
        with self._changed:
            if self._is_closed:
                return False
            size = len(head) + len(data)
            if self._waiting and self._bytes + size > MAX_WAITING_BYTES:
                return False
            pieces = cut(head, data)
            if not self._waiting and not (self._free_s and monotonic() < self._free_s):
                first = next(pieces)
                if self._sent(first):
                    if size <= LONG:
                        self._free_s = 0.0
                        return True
                    self._free_s = monotonic() + PAUSE_S
                    rest = deque(map(b"".join, pieces))
                else:
                    rest = deque([b"".join(first), *map(b"".join, pieces)])
            else:
                rest = deque(map(b"".join, pieces))
            if rest:
                self._wait(rest)
        return True

    def wait(self, seconds: float, *, empty: bool) -> bool:
        """See `Output.wait`."""
        most = 0 if empty else MAX_WAITING_BYTES // 2
        with self._changed:
            return self._changed.wait_for(lambda: self._is_closed or self._bytes <= most, seconds)

    def clear(self) -> int:
        """Drop what waits; gives the number of messages that did not arrive as far as is known."""
        with self._changed:
            left, self._lost = len(self._waiting) + self._lost, 0
            self._waiting.clear()
            self._bytes = 0
            self._changed.notify_all()
        return left

    def close(self) -> int:
        """Stop; gives what `clear` gives."""
        left = self.clear()
        with self._changed:
            self._is_closed = True
            self._socket.close()
        return left

    def _wait(self, rest: deque[bytes]) -> None:
        self._waiting.append(rest)
        self._bytes += sum(map(len, rest))
        if len(self._waiting) == 1:
            loop().soon(loop().later, PAUSE_S, self._go_on)

    def _sent(self, parts: tuple[Bytes, ...]) -> bool:
        """Whether the system has taken a datagram. True also where no reader is there any more; then the sender reports the failure."""
        try:
            self._socket.sendmsg(parts)
        except BlockingIOError:
            return False
        except OSError as error:
            self._lost += 1 + isinstance(error, ConnectionRefusedError)  # of the datagram before, and this one, not sent
            self._is_closed = True
            loop().soon(self._failed)
        return True

    def _go_on(self) -> None:
        with self._changed:
            while self._waiting:
                message = self._waiting[0]
                if not self._sent((message[0],)):
                    break
                size = len(message.popleft())
                self._bytes -= size
                if not message:
                    self._waiting.popleft()
                if size > LONG:
                    break
            if self._waiting:
                loop().later(PAUSE_S, self._go_on)
            self._changed.notify_all()


class DatagramOutput:
    """One connection to a reader; used as an `rosetta_jit.transports.yarp.outgoing.Output`.

    All readers by mcast of a port share a sender, that of their `Group`: the first of them sends, and all get it.

    Attributes
    ----------
    target, carrier
        The reader's port, and ``udp`` or ``mcast``.
    contact
        Where that port listens.
    """

    def __init__(self, contact: Contact, to: Sender | Group) -> None:
        self.target, self.contact = contact.name, contact
        self.carrier = "mcast" if isinstance(to, Group) else "udp"
        self._sender, self._members = (to.sender, to.members) if isinstance(to, Group) else (to, [])
        self._members.append(self)

    def write(self, head: bytes, data: Bytes) -> bool:
        """Send a message, or let it wait; False where too much waits."""
        return self._members[:1] != [self] or self._sender.write(head, data)

    def wait(self, seconds: float, *, empty: bool = False) -> bool:
        """Wait for room, or until all is sent; False where that takes longer."""
        return self._sender.wait(seconds, empty=empty)

    def close(self, linger: float = 0.0) -> int:
        """Stop; gives the number of messages that were not sent, and that no other reader of the group waits for."""
        del linger
        if self in self._members:
            self._members.remove(self)
        if self._members:
            return 0
        return self._sender.clear() if self.carrier == "mcast" else self._sender.close()

    def gone(self) -> int:
        """Do the same as `close`."""
        return self.close()


class Group:
    """What all readers by mcast of a port share."""

    def __init__(self, contact: Contact, interface: str) -> None:
        self.contact = contact
        self.members: list[DatagramOutput] = []
        sock = sending(socket.AF_INET, contact.host, interface)
        sock.connect((contact.host, contact.port))
        self.sender = Sender(sock, _nobody)

    @property
    def place(self) -> bytes:
        """Address and port of the group, as they are written behind the hello."""
        return ipaddress.ip_address(self.contact.host).packed + self.contact.port.to_bytes(2, "big")


def greeted_by_udp(line: socket.socket, name: str, failed: Callable[[], object]) -> Sender:
    """Say hello by a connection, and get the place to send to.

    Raises
    ------
    OSError, ProtocolError
        The reader does not answer, or something else.
    """
    line.sendall(hello("udp", name))
    answer = b""
    while len(answer) < 8:
        piece = line.recv(8 - len(answer))
        if not piece:
            raise ProtocolError("the reader did not answer the hello")
        answer += piece
    number = int_of(memoryview(answer))
    if not 0 < number < 65536:
        raise ProtocolError(f"the reader answered the hello by {number}, which is no port")
    host = line.getpeername()[0]
    sock = sending(line.family, host, "")
    sock.connect((host, number))
    return Sender(sock, failed)


def greeted_by_mcast(line: socket.socket, name: str, group: Group) -> None:
    """Say hello by a connection, and wait until the reader has joined the group: then it closes.

    Raises
    ------
    OSError
        It does not.
    """
    line.sendall(hello("mcast", name) + group.place)
    line.shutdown(socket.SHUT_WR)
    while line.recv(4096):
        pass


def _nobody(*_: Any) -> None:
    """A group may be empty."""
