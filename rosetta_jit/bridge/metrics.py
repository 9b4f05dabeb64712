"""Counts of a bridge in the text format of Prometheus, over HTTP."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, cast

from rosetta_jit.bridge.limits import MAX_ASKING
from rosetta_jit.errors import TransportError
from rosetta_jit.transports.http_server import Handler, QuestionServer

if TYPE_CHECKING:
    Snapshot = Callable[[], list[dict[str, Any]]]

PREFIX = "rosetta_jit_bridge"
TOTALS = {
    "taken": ("messages_taken_total", "Messages that came."),
    "sent": ("messages_sent_total", "Messages that went."),
    "bytes_in": ("bytes_taken_total", "Bytes that came."),
    "bytes_out": ("bytes_sent_total", "Bytes that went."),
}
REASONS = {
    "dropped": ("messages_dropped_total", "reason", "Messages that did not go on."),
    "failed": ("messages_failed_total", "cause", "Messages that could not be translated."),
}
CONTENT = "text/plain; version=0.0.4; charset=utf-8"


def text(snapshot: list[dict[str, Any]]) -> str:
    """The exposition of all routes."""
    return "\n".join(_lines(snapshot)) + "\n"


def _lines(snapshot: list[dict[str, Any]]) -> Iterator[str]:
    for key, (name, help_) in TOTALS.items():
        yield from _head(name, help_, "counter")
        yield from (f"{PREFIX}_{name}{{{_label('route', each['route'])}}} {each[key]}" for each in snapshot)
    for key, (name, label, help_) in REASONS.items():
        yield from _head(name, help_, "counter")
        for each in snapshot:
            counts: Counter[str] = Counter()
            for reason, count in each[key].items():
                counts[_label(label, reason)] += count  # two reasons may differ in what no label shows
            yield from (f"{PREFIX}_{name}{{{_label('route', each['route'])},{shown}}} {count}" for shown, count in counts.items())
    yield from _head("reconnects_total", "Connections that were made again.", "counter")
    yield from _of_ends(snapshot, "reconnects_total", "reconnects")
    yield from _head("connections", "Peers that are connected.", "gauge")
    yield from _of_ends(snapshot, "connections", "connections")
    yield from _head("latency_seconds", "From arrival to what the target took; quantiles of the last one to two minutes.", "summary")
    for each in snapshot:
        for part, key in (("0.5", "p50_us"), ("0.99", "p99_us")):
            if each[key] is not None:
                yield f'{PREFIX}_latency_seconds{{{_label("route", each["route"])},quantile="{part}"}} {each[key] / 1e6:.9f}'
        for part, key in (("sum", "latencies_s"), ("count", "latencies")):
            yield f"{PREFIX}_latency_seconds_{part}{{{_label('route', each['route'])}}} {each[key]}"
    yield from _head("state", "What a mapping keeps from one message to the next.", "gauge")
    for each in snapshot:
        for variable, now in each["state"].items():
            yield f"{PREFIX}_state{{{_label('route', each['route'])},{_label('variable', variable)}}} {float(now)!r}"
    for name, help_, value in (("waiting", "Messages in the queue.", "waiting"), ("up", "Whether the route runs.", "")):
        yield from _head(name, help_, "gauge")
        yield from (
            f"{PREFIX}_{name}{{{_label('route', each['route'])}}} {each[value] if value else int(not each['problem'])}" for each in snapshot
        )


def _of_ends(snapshot: list[dict[str, Any]], name: str, key: str) -> Iterator[str]:
    for each in snapshot:
        for end, count in each[key].items():
            yield f"{PREFIX}_{name}{{{_label('route', each['route'])},{_label('end', end)}}} {count}"


def _head(name: str, help_: str, kind: str) -> Iterator[str]:
    yield f"# HELP {PREFIX}_{name} {help_}"
    yield f"# TYPE {PREFIX}_{name} {kind}"


def _label(name: str, value: str) -> str:
    """Names from the network may hold anything."""
    shown = "".join(each if each.isprintable() else "?" for each in value[:300])
    return '{}="{}"'.format(name, shown.replace("\\", r"\\").replace('"', r"\""))


class MetricsServer:
    """Answers `/metrics` until it is closed.

    Parameters
    ----------
    place
        ``host:port``, or a port, at which only this machine can ask.

    Raises
    ------
    TransportError
        The place is taken, or is none.
    """

    def __init__(self, place: str, snapshot: Snapshot) -> None:
        host, _, port = place.rpartition(":")
        try:
            self._server = _Server((host or "127.0.0.1", int(port)), _Handler, MAX_ASKING)
        except (OSError, ValueError, OverflowError) as error:
            raise TransportError("taken", place, f"metrics cannot be served there: {error}") from None
        self._server.snapshot = snapshot
        self.port: int = self._server.server_address[1]
        self._thread = threading.Thread(target=self._server.serve_forever, name="metrics", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop answering."""
        self._server.shutdown()
        self._server.server_close()


class _Server(QuestionServer):
    snapshot: Snapshot


class _Handler(Handler):
    def do_GET(self) -> None:  # noqa: N802 - http.server's name
        """Answer one question."""
        if self.path.partition("?")[0] not in ("/", "/metrics"):
            self.send_error(404)
            return
        self.answer(CONTENT, text(cast("_Server", self.server).snapshot()).encode())
