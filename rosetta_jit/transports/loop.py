"""The one thread that serves all sockets of a process: it waits for them with epoll, and calls what belongs to each."""

from __future__ import annotations

import heapq
import os
import select
import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from itertools import count
from time import monotonic
from typing import Any

from rosetta_jit.transports.limits import MAX_SENDING_BYTES

READ = select.EPOLLIN
WRITE = select.EPOLLOUT

EVENTS = 64
"""That are taken at a time; memory for them is made each time."""


class Timer:
    """Something that is called later, unless it is cancelled."""

    __slots__ = ("call",)

    def __init__(self, call: Callable[[], object]) -> None:
        self.call: Callable[[], object] | None = call

    def cancel(self) -> None:
        """Do not call it."""
        self.call = None


class Loop:
    """A thread that calls functions when sockets are ready, when moments come, and when other threads ask for it."""

    def __init__(self) -> None:
        self._epoll = select.epoll()
        self._watched: dict[int, Callable[[int], object]] = {}
        self._soon: deque[tuple[Callable[..., object], tuple[Any, ...]]] = deque()
        self._later: list[tuple[float, int, Timer]] = []
        self._number = count()
        self._wake_read, self._wake_write = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
        self._awake = False
        self.held_bytes = 0
        """Of memory, for messages that come; changed in the loop's thread."""
        self.sending_bytes = 0
        """Of memory, for messages that wait for slow peers; changed by `reserve` and `release`."""
        self._sending = threading.Lock()
        self._epoll.register(self._wake_read, READ)
        self._watched[self._wake_read] = self._drain
        self.thread = threading.Thread(target=self._run, name="rosetta_jit transports", daemon=True)
        self.thread.start()

    @property
    def is_current(self) -> bool:
        """Whether the caller is this loop's own thread."""
        return threading.current_thread() is self.thread

    def reserve(self, size: int) -> bool:
        """Take memory for a message that waits for a slow peer; False where all of them have too much. From any thread."""
        with self._sending:
            has_room = self.sending_bytes + size <= MAX_SENDING_BYTES
            self.sending_bytes += size * has_room
        return has_room

    def release(self, size: int) -> None:
        """Give back what `reserve` took. From any thread."""
        with self._sending:
            self.sending_bytes -= size

    def soon(self, function: Callable[..., object], *arguments: Any) -> None:
        """Call a function in the loop's thread; from any thread."""
        self._soon.append((function, arguments))
        if not self._awake and not self.is_current:
            self._awake = True
            with suppress(BlockingIOError):  # a full pipe wakes, too
                os.write(self._wake_write, b"\0")

    def run(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Call a function in the loop's thread, and wait for its value or exception; from any thread."""
        if self.is_current:
            return function(*arguments)
        done = threading.Event()
        outcome: list[Any] = [None, None]

        def work() -> None:
            try:
                outcome[0] = function(*arguments)
            except BaseException as error:  # noqa: BLE001 - raised again in the thread that waits
                outcome[1] = error
            finally:
                done.set()

        self.soon(work)
        done.wait()
        if outcome[1] is not None:
            raise outcome[1]
        return outcome[0]

    def later(self, seconds: float, function: Callable[[], object]) -> Timer:
        """Call a function after so many seconds; in the loop's thread only."""
        timer = Timer(function)
        heapq.heappush(self._later, (monotonic() + seconds, next(self._number), timer))
        return timer

    def watch(self, number: int, events: int, ready: Callable[[int], object]) -> None:
        """Call a function with the events of a file descriptor, whenever there are some; in the loop's thread only."""
        if number in self._watched:
            self._epoll.modify(number, events)
        else:
            self._epoll.register(number, events)
        self._watched[number] = ready

    def unwatch(self, number: int) -> None:
        """Forget a file descriptor, before it is closed; in the loop's thread only."""
        if self._watched.pop(number, None) is not None:
            self._epoll.unregister(number)

    def _drain(self, _: int) -> None:
        os.read(self._wake_read, 4096)

    def _run(self) -> None:
        poll, watched, soon, later = self._epoll.poll, self._watched, self._soon, self._later
        while True:
            for number, events in poll(self._pause() if soon or later else -1, EVENTS):
                ready = watched.get(number)
                if ready is not None:
                    try:
                        ready(events)
                    except Exception as error:  # noqa: BLE001 - as of `_guarded`, whose call takes its time
                        _report(error)
            self._awake = False
            if later:
                self._call_due()
            for _ in range(len(soon)):
                function, arguments = soon.popleft()
                _guarded(function, *arguments)

    def _pause(self) -> float:
        if self._soon:
            return 0
        return max(0.0, self._later[0][0] - monotonic()) if self._later else -1

    def _call_due(self) -> None:
        now = monotonic()
        while self._later and self._later[0][0] <= now:
            timer = heapq.heappop(self._later)[2]
            if timer.call is not None:
                _guarded(timer.call)


def _guarded(function: Callable[..., object], *arguments: Any) -> None:
    """Call a function; what it raises is a mistake of ours, is reported, and ends nothing else."""
    try:
        function(*arguments)
    except Exception as error:  # noqa: BLE001
        _report(error)


def _report(error: Exception) -> None:
    threading.excepthook(threading.ExceptHookArgs((type(error), error, error.__traceback__, threading.current_thread())))


def loop() -> Loop:
    """The loop of this process, started when it is first needed: a fork has one of its own."""
    return _loop_of(os.getpid())


_MAKING = threading.Lock()


@cache
def _loop_of(process: int) -> Loop:
    with _MAKING:  # threads that ask at the same time for the first loop of a process get the same one
        return _made(process)


@cache
def _made(_: int) -> Loop:
    return Loop()
