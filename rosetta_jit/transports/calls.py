"""Remote procedure calls over transports: callers, which ask and wait for the answer, and servers, which answer."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Mapping
from time import monotonic
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import TransportError
from rosetta_jit.transports.base import QUEUE
from rosetta_jit.transports.end import End, not_open
from rosetta_jit.transports.limits import MAX_QUEUE_BYTES
from rosetta_jit.transports.message import Message

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address
    from rosetta_jit.transports.base import Lost

    Answer = Callable[["Message"], "bytes | bytearray | memoryview | None"]

ANSWER_FAILED = "the answer failed"
"""Why a question is lost where the function that answers raised."""


class Caller(End):
    """The asking end of remote procedure calls; a context manager. Transports derive from it."""

    def __init__(self, address: Address, options: Mapping[str, Any]) -> None:
        super().__init__(str(address))
        self._most: int = options["max_message"]
        self._timeout: float = options["timeout"]

    def __call__(
        self, data: bytes | bytearray | memoryview, *, timeout: float | None = None, attributes: Mapping[str, Any] | None = None
    ) -> Message:
        """Ask, and wait for the answer; not in a callback of a source, whose thread receives the answer.

        Raises
        ------
        TransportError
            Nothing came within ``timeout`` seconds (default: the option `timeout`), or the peer said that it failed.
        """
        until = monotonic() + (self._timeout if timeout is None else timeout)
        self.check_size(len(data), self._most)
        return self.ask(data, until, attributes or {})

    def ask(self, data: bytes | bytearray | memoryview, until: float, attributes: Mapping[str, Any]) -> Message:
        """Send a question, and wait for its answer until a moment of the monotonic clock; for transports."""
        raise NotImplementedError

    def close(self) -> None:
        """Stop; who waits for an answer gets an error."""


class Server(End):
    """The answering end; a context manager. Answers are worked out in a thread of its own, one after the other.

    At most ``queue`` questions wait; further ones are refused, and counted.
    """

    def __init__(self, address: str, answer: Answer, lost: Lost | None = None, *, queue: int = QUEUE) -> None:
        super().__init__(address, lost)
        self._answer = answer
        self._most = max(queue, 1)
        self._questions: deque[tuple[Message, Callable[[bytes | None, str | None], object]]] = deque()
        self._question_bytes = 0
        self._changed = threading.Condition()
        self._closed = False
        self._close: Callable[[], None] = not_open
        self._thread = threading.Thread(target=self._run, name=f"answers {address}", daemon=True)

    def asked(self, message: Message, reply: Callable[[bytes | None, str | None], object]) -> bool:
        """Take a question; ``reply`` gets the answer, or None and an error's text. For transports."""
        message.keep()
        with self._changed:
            has_room = not self._questions or self._question_bytes + len(message.data) <= MAX_QUEUE_BYTES
            taken = len(self._questions) < self._most and has_room and not self._closed
            if taken:
                self._question_bytes += len(message.data)
                self._questions.append((message, reply))
                self._changed.notify()
        if not taken:
            self.lose("queue full")
            reply(None, "too many questions wait")
        return taken

    def opened(self, close: Callable[[], None]) -> Server:
        """Say what closes it, and begin to answer; for transports."""
        self._close = close
        self._thread.start()
        return self

    def close(self) -> None:
        """Answer what was asked so far, and stop."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join(5)
        close, self._close = self._close, not_open
        close()

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._questions or self._closed)
                if not self._questions:
                    return
                message, reply = self._questions.popleft()
                self._question_bytes -= len(message.data)
            self.passed(len(message.data))
            try:
                answer = self._answer(message)
            except Exception as error:  # noqa: BLE001 - the user's code: the peer gets to know
                self.lose(ANSWER_FAILED)
                reply(None, f"{type(error).__name__}: {error}")
            else:
                reply(None if answer is None else bytes(answer), None)


class Pending:
    """The place where an answer is waited for."""

    __slots__ = ("_done", "_error", "_message")

    def __init__(self) -> None:
        self._done = threading.Event()
        self._message: Message | None = None
        self._error: TransportError | None = None

    def answer(self, message: Message) -> None:
        """Keep the answer, which has come, and wake the thread that waits for it."""
        self._message = message.keep()
        self._done.set()

    def fail(self, error: TransportError) -> None:
        """Keep the reason why no answer will come; the first one counts."""
        if not self._done.is_set():
            self._error = error
            self._done.set()

    def wait(self, until: float, address: str) -> Message:
        """The answer, at the latest at a moment of the monotonic clock.

        Raises
        ------
        TransportError
            It did not come, or the peer failed.
        """
        self._done.wait(max(0.0, until - monotonic()))
        if self._error is not None:
            raise self._error
        if self._message is None:
            raise TransportError("timeout", address, "no answer came in time")
        return self._message
