"""A route that runs: what comes from its source is translated and sent in the thread that brought it, as long as nothing waits.

What the target does not take at once waits in the route's queue, which a thread of its own empties; that thread is made when it is first
needed. Nothing is lost without being counted, and said.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Mapping
from time import monotonic, perf_counter_ns
from typing import TYPE_CHECKING

from rosetta_jit.bridge.counting import RouteCounts
from rosetta_jit.errors import MessageError, TransportError
from rosetta_jit.transports.limits import MAX_QUEUE_BYTES

if TYPE_CHECKING:
    from rosetta_jit.bridge.configuration import Route
    from rosetta_jit.bridge.translating import Translator
    from rosetta_jit.transports.base import Bytes, Sink
    from rosetta_jit.transports.calls import Caller

    Say = Callable[[str], object]
    Waiting = tuple[bytes, int, int]

AGAIN_S = 0.002
"""How long the queue's thread waits before it offers a message again; twice as long each time, up to `MOST_S`."""

MOST_S = 0.05
LINGER_S = 5.0
"""How long a route that is closed waits for its target to take what waits."""


class Inlet:
    """An entrance to a route that joins several wires: it takes the messages of one of them."""

    def __init__(self, live: LiveRoute, wire: str) -> None:
        self.live, self.wire = live, wire
        self.lost, self.begin_anew = live.lost, live.begin_anew
        self.keeps = True

    def deliver(self, data: Bytes, time: int) -> None:
        """Take a message from the wire's source."""
        self.live.deliver(data, time, self.wire)


class LiveRoute:
    """One route while it runs.

    Parameters
    ----------
    translate
        What turns messages into those of the target. Where it joins several wires, messages come by an `Inlet` for each of them.
    say
        Takes lines for people.

    Attributes
    ----------
    keeps : bool
        Whether its mappings keep something from one message to the next: then they begin anew with another session of the source.
    problem : str
        Why it does not run; empty while it does.
    """

    wire = ""

    def __init__(self, route: Route, translate: Translator, say: Say) -> None:
        self.route = route
        self.translate = translate
        self.keeps = translate.keeps
        self._program = None if route.rate is not None else translate.program
        self.counts = RouteCounts()
        self.problem = "not open yet"
        self._say = say
        self._sink: Sink | None = None
        self._caller: Caller | None = None
        self._interval_ns = 0 if route.rate is None else int(1e9 / route.rate)
        self._due_ns = 0
        self._waiting: deque[Waiting] = deque()
        self._waiting_bytes = 0
        self._held = 0
        self._changed = threading.Condition()
        self._closed = self._given_up = False
        self._thread: threading.Thread | None = None
        self._sending = threading.Lock()
        self._sender = 0
        self._refusal, self._refused = "", 0

    def open(self, sink: Sink | None, caller: Caller | None) -> None:
        """Begin: the target is there."""
        self._sink, self._caller = sink, caller

    @property
    def target(self) -> Sink | Caller | None:
        """The end to which messages go; None before it is there."""
        return self._sink if self._sink is not None else self._caller

    @property
    def live(self) -> LiveRoute:
        """Itself: see `Inlet`."""
        return self

    @property
    def state(self) -> Mapping[str, float | str]:
        """What its mappings keep from one message to the next."""
        return self.translate.state()

    def begin_anew(self) -> None:
        """Let the next message be the first one for its mappings."""
        if self.translate.reset():
            self._say(f"{self.route.name}: its source came back, and the state of its mapping begins anew")

    @property
    def waiting(self) -> int:
        """Messages that wait for the target; none once it is closed: they are counted as dropped."""
        return 0 if self._given_up else len(self._waiting) + self._held

    def deliver(self, data: Bytes, time: int, wire: str = "") -> None:
        """Take a message from the source, or from that of one of several wires; send what it becomes, or let that wait.

        The time is that when it was sent, or else received, in nanoseconds since 1970.
        """
        begun, counts = perf_counter_ns(), self.counts
        counts.taken += 1
        counts.bytes_in += len(data)
        try:
            made = self.translate(data, wire, self._is_due) if self._program is None else self._program(data)
        except MessageError as error:
            self._failed(error)
            return
        if made is None:
            return
        if self._sink is not None and not self._waiting and not self._held:
            if self._sink.at_once(made):
                counts.passed(len(made), perf_counter_ns() - begun)
                return
            if self._send(made, time, begun):
                return
        self._wait((bytes(made), time, begun))

    def _is_due(self) -> bool:
        """Whether the route's rate lets a message go on now; where it does not, one is counted as dropped."""
        if not self._interval_ns:
            return True
        now = perf_counter_ns()
        if now < self._due_ns:
            self.lost("above its rate")
            return False
        self._due_ns = max(self._due_ns + self._interval_ns, now)
        return True

    def lost(self, reason: str, count: int = 1) -> None:
        """Count messages that do not go on; also what the transport of the target reports."""
        if self._sender == threading.get_ident():
            self._refusal, self._refused = reason, self._refused + count  # of the message that is being sent, which may be sent again
            return
        if line := self.counts.lose(reason, count):
            self._say(f"{self.route.name}: {line}")

    def _failed(self, error: MessageError) -> None:
        cause = f"{error.kind}: {error.detail} - at `{error.path}`" if error.path else f"{error.kind}: {error.detail}"
        if self.counts.fail(cause):
            self._say(f"{self.route.name}: {self.counts.failed[cause] or 'many'} failed: {cause}")

    def _send(self, data: Bytes, time: int, begun: int) -> bool:
        """Offer a message to the target; whether it took it."""
        sink = self._sink
        assert sink is not None
        with self._sending:
            self._sender, self._refused = threading.get_ident(), 0
            try:
                taken = sink.send(data, time=time or None)
            except TransportError as error:
                self._sender = 0
                if not self._given_up:
                    self.lost(f"{error.kind}: {error.detail}")
                return True  # there is nothing to be tried again
            finally:
                self._sender = 0
            if taken and self._refused:  # by some of several peers, to which it is not sent again
                self.lost(self._refusal, self._refused)
        if taken:
            self.counts.passed(len(data), perf_counter_ns() - begun)
        return taken

    # --- the queue -------------------------------------------------------------------------------------------------------

    def _wait(self, item: Waiting) -> None:
        """Let a message wait for the target, or drop one."""
        dropped = 0
        with self._changed:
            if self._thread is None:
                self._thread = threading.Thread(target=self._empty, name=f"queue of {self.route.name}", daemon=True)
                self._thread.start()
            if self.route.full == "block":
                self._changed.wait_for(lambda: self._has_room(item) or self._closed)
            elif self.route.full == "oldest":
                while not self._has_room(item):
                    self._next()
                    dropped += 1
            elif not self._has_room(item):
                dropped = 1
            if not dropped or self.route.full == "oldest":
                self._waiting.append(item)
                self._waiting_bytes += len(item[0])
                self._changed.notify_all()
        if dropped:
            self.lost(f"queue full ({self._refusal})" if self._refusal else "queue full", dropped)

    def _has_room(self, item: Waiting) -> bool:
        is_short = not self._waiting or self._waiting_bytes + len(item[0]) <= MAX_QUEUE_BYTES
        return is_short and len(self._waiting) < self.route.queue

    def _next(self) -> Waiting:
        """Take the oldest message out of the queue."""
        item = self._waiting.popleft()
        self._waiting_bytes -= len(item[0])
        return item

    def _empty(self) -> None:
        """The queue's thread."""
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._waiting or self._closed)
                if not self._waiting:
                    return
                item, self._held = self._next(), 1
                self._changed.notify_all()
            self._offer(item)
            with self._changed:
                self._held = 0
                self._changed.notify_all()

    def _offer(self, item: Waiting) -> None:
        """Send a message, again and again until it is taken."""
        data, time, begun = item
        if self._caller is not None:
            self._ask(self._caller, data, begun)
            return
        pause, since = AGAIN_S, monotonic()
        while not self._send(data, time, begun):
            sink = self._sink
            if sink is not None and sink.connections and monotonic() > since + self.route.timeout_s:
                break  # somebody is there, and does not want this one: others are to have their turn
            with self._changed:
                if self._closed and monotonic() > self._until:
                    break
                self._changed.wait_for(lambda: self._closed, pause)
            pause = min(2 * pause, MOST_S)
        else:
            return
        if not self._given_up:
            self.lost(self._refusal or "not sent in time")

    def _ask(self, caller: Caller, data: bytes, begun: int) -> None:
        try:
            caller(data, timeout=self.route.timeout_s)
        except TransportError as error:
            self.lost(f"{error.kind}: {error.detail}")
        else:
            self.counts.passed(len(data), perf_counter_ns() - begun)

    _until = 0.0

    def close(self, linger_s: float = LINGER_S) -> None:
        """Send what waits, for as long as that, and close the target. The source is closed already."""
        with self._changed:
            self._until = monotonic() + linger_s
            self._closed = True
            self._changed.notify_all()
        if self._thread is not None:
            self._thread.join(linger_s + 1)
        with self._changed:
            left = self.waiting
            self._waiting.clear()
            self._waiting_bytes = 0
            self._given_up = True  # what the thread still holds is counted here
        if left:
            self.lost("not sent before the end", left)
        if self._sink is not None:
            self._sink.flush(max(self._until - monotonic(), 0.1))
            self._sink.close()
        if self._caller is not None:
            self._caller.close()
        self.problem = self.problem or "closed"
