"""How connections come about: listening, connecting, and connecting again with growing pauses."""

from __future__ import annotations

import errno
import os
import socket
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.loop import READ, WRITE, loop

if TYPE_CHECKING:
    Target = tuple[int, Any]
    """A family of sockets, and an address in it."""

FIRST_PAUSE_S = 0.05
LAST_PAUSE_S = 2.0
"""Between two attempts to connect: twice as long after each that fails."""

CONNECT_S = 5.0
"""How long one attempt may take."""


def resolve(host: str, port: int, kind: int = socket.SOCK_STREAM) -> list[Target]:
    """The addresses of a host, those of IPv4 first; may take a while.

    Raises
    ------
    TransportError
        Nobody knows the host.
    """
    try:
        found = socket.getaddrinfo(host, port, type=kind)
    except (OSError, UnicodeError) as error:
        raise TransportError("unreachable", f"{host}:{port}", getattr(error, "strerror", None) or "no such host") from None
    return sorted({(each[0], each[4]) for each in found}, key=lambda each: (each[0] != socket.AF_INET, str(each[1])))


class Listener:
    """A listening socket in the loop; each connection is handed to ``accepted``, in the loop's thread.

    Raises
    ------
    TransportError
        The address is taken, or is not one of this machine.
    """

    def __init__(
        self, target: Target, accepted: Callable[[socket.socket], object], *, refused: Callable[[], object] = lambda: None
    ) -> None:
        self._accepted = accepted
        self._refused = refused
        self.open: set[int] = set()
        self._path = target[1] if target[0] == socket.AF_UNIX else ""
        self.socket = socket.socket(target[0], socket.SOCK_STREAM)
        try:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            self.socket.bind(target[1])
            self.socket.listen(256)
        except (OSError, OverflowError) as error:
            self.socket.close()
            raise taken(target, error) from None
        self.socket.setblocking(False)
        loop().run(self._watch)

    @property
    def port(self) -> int:
        """The port that it got."""
        return int(self.socket.getsockname()[1])

    def close(self) -> None:
        """Listen no more; connections stay."""
        loop().run(self._close)

    def _close(self) -> None:
        if self.socket.fileno() >= 0:
            loop().unwatch(self.socket.fileno())
            self.socket.close()
            if self._path:
                Path(self._path).unlink(missing_ok=True)

    def _watch(self) -> None:
        if self.socket.fileno() >= 0:
            loop().watch(self.socket.fileno(), READ, self._ready)

    def _ready(self, _: int) -> None:
        for _ in range(64):
            try:
                sock, _ = self.socket.accept()
            except BlockingIOError:
                return
            except OSError as error:
                if error.errno in (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.ENOBUFS):  # try again when something was closed
                    loop().unwatch(self.socket.fileno())
                    loop().later(0.2, self._watch)
                    return
                continue
            self._accepted(sock)


def taken(target: Target, error: Exception) -> TransportError:
    """The error for an address at which one cannot listen."""
    number = getattr(error, "errno", None)
    where = str(target[1]) if target[0] == socket.AF_UNIX else f"{target[1][0]}:{target[1][1]}"
    if number == errno.EADDRINUSE:
        return TransportError("taken", where, "another program listens there")
    return TransportError("unreachable", where, f"cannot listen there: {getattr(error, 'strerror', None) or error}")


class Dialer:
    """Connects to the first of some targets that answers; all in the loop's thread.

    Parameters
    ----------
    targets
        Tried in turn.
    connected
        Is called with each connected socket, which then belongs to it.
    failed
        Is called with what each round of attempts failed by. Another round follows, after a pause.
    """

    def __init__(
        self,
        targets: list[Target],
        connected: Callable[[socket.socket], object],
        failed: Callable[[str], object] = lambda _: None,
    ) -> None:
        self._targets = targets
        self._connected = connected
        self._failed = failed
        self._pause = FIRST_PAUSE_S
        self._socket: socket.socket | None = None
        self._stopped = False

    def start(self) -> None:
        """Begin to try."""
        if not self._stopped and self._socket is None:
            self._try(0, "no address")

    def lost(self) -> None:
        """The connection is gone: try again, after a pause."""
        if not self._stopped:
            loop().later(self._pause, self.start)

    def stop(self) -> None:
        """Try no more."""
        self._stopped = True
        self._drop()

    def _try(self, index: int, why: str) -> None:
        if self._stopped:
            return
        if index == len(self._targets):
            self._failed(why)
            loop().later(self._pause, self.start)
            self._pause = min(2 * self._pause, LAST_PAUSE_S)
            return
        family, address = self._targets[index]
        sock = self._socket = socket.socket(family, socket.SOCK_STREAM)
        sock.setblocking(False)
        timer = loop().later(CONNECT_S, lambda: done(0, late=True))

        def done(_: int, *, late: bool = False) -> None:
            if self._socket is not sock:
                return
            number = errno.ETIMEDOUT if late else sock.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
            timer.cancel()
            loop().unwatch(sock.fileno())
            self._settle(index, number)

        number = sock.connect_ex(address)
        if number in (0, errno.EINPROGRESS):
            loop().watch(sock.fileno(), WRITE, done)
        else:
            timer.cancel()
            self._settle(index, number)

    def _settle(self, index: int, number: int) -> None:
        if number:
            self._drop()
            self._try(index + 1, os.strerror(number))
            return
        sock, self._socket = self._socket, None
        assert sock is not None
        if sock.family != socket.AF_UNIX and sock.getsockname() == sock.getpeername():  # a port of ours that happens to be the target's
            sock.close()
            self._try(index + 1, "nothing listens there")
            return
        self._pause = FIRST_PAUSE_S
        self._connected(sock)

    def _drop(self) -> None:
        sock, self._socket = self._socket, None
        if sock is not None:
            loop().unwatch(sock.fileno())
            sock.close()
