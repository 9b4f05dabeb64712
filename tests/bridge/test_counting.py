"""What a bridge says of its routes: causes, latencies, the table, and metrics for Prometheus."""

from __future__ import annotations

import socket
import time
import urllib.request

import pytest

import rosetta_jit as rj
from rosetta_jit.bridge import metrics as asking
from rosetta_jit.bridge.counting import WINDOW_S, Latencies, RouteCounts
from rosetta_jit.bridge.limits import MAX_CAUSES
from rosetta_jit.bridge.metrics import MetricsServer, text
from rosetta_jit.bridge.table import rows
from rosetta_jit.transports import http_server
from tests.bridge.routes import route
from tests.transports.free import free_port, until


def test_causes_are_bounded():
    counts = RouteCounts()
    for number in range(10_000):
        counts.fail(f"cause {number}")
    assert len(counts.failed) == MAX_CAUSES + 1
    assert sum(counts.failed.values()) == 10_000


def test_latencies():
    latencies = Latencies()
    assert latencies.quantile(0.5) is None
    for number in [*range(1, 1000), 10**15]:
        latencies.add(number)
    for part in (0.1, 0.5, 0.9):
        assert latencies.quantile(part) == pytest.approx(1000 * part, rel=0.13)
    assert latencies.quantile(1.0) == pytest.approx(10**15, rel=0.13)
    assert (latencies.total, latencies.total_ns) == (1000, 499_500 + 10**15)


def test_latencies_are_those_of_the_last_minutes():
    latencies, begun = Latencies(), time.monotonic()
    latencies.add(10**6)
    latencies.forget(begun + 1)
    assert latencies.quantile(0.5) is not None
    latencies.forget(begun + WINDOW_S + 1)
    latencies.add(10**3)
    assert latencies.quantile(0.99) == pytest.approx(10**6, rel=0.13)
    latencies.forget(begun + 2 * WINDOW_S + 2)
    assert latencies.quantile(0.99) == pytest.approx(10**3, rel=0.13)
    latencies.forget(begun + 4 * WINDOW_S + 3)  # nothing came, and nobody looked
    assert latencies.quantile(0.99) is None
    assert latencies.total == 2


def test_the_table_and_the_metrics(run):
    source, target = free_port(), free_port()
    with rj.subscribe(f"tcp:{target}") as there:
        bridge, _ = run(route(source, target, 'name = "a \\"b\\"\\u001b[2J"'))
        with rj.publish(f"tcp:{source}") as robot:
            robot.send(b"12345")
            assert there.take(5)
        next(iter(bridge.live.values())).lost("evil\x1b[2J reason\n")
        table = "\n".join(rows(bridge.snapshot()))
        assert "\x1b" not in table
        assert "dropped 1: evil" in table
        metrics = MetricsServer("0", bridge.snapshot)
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{metrics.port}/metrics") as answer:
                found = answer.read().decode()
        finally:
            metrics.close()
        assert found.split("\n")[0].startswith("# HELP")
        assert 'rosetta_jit_bridge_bytes_sent_total{route="a \\"b\\"?[2J"} 5' in found
        assert 'reason="evil?[2J reason?"} 1' in found
        assert 'rosetta_jit_bridge_latency_seconds_count{route="a \\"b\\"?[2J"} 1\n' in found
        assert 'rosetta_jit_bridge_connections{route="a \\"b\\"?[2J",end="target"} 1' in found
        assert 'rosetta_jit_bridge_reconnects_total{route="a \\"b\\"?[2J",end="source"} 0' in found
        assert all(line.startswith("#") or line.count("{") == 1 for line in text(bridge.snapshot()).splitlines())


def test_who_asks_for_metrics_and_says_nothing_holds_up_nobody(monkeypatch):
    monkeypatch.setattr(asking, "MAX_ASKING", 2)
    monkeypatch.setattr(http_server, "ANSWER_S", 0.3)
    metrics = MetricsServer("0", list)
    try:
        with socket.create_connection(("127.0.0.1", metrics.port)), socket.create_connection(("127.0.0.1", metrics.port)):
            with socket.create_connection(("127.0.0.1", metrics.port)) as third:
                assert third.recv(1) == b""
            until(lambda: is_answered(metrics.port))
    finally:
        metrics.close()


def is_answered(port):
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics") as answer:
            return answer.read().startswith(b"# HELP")
    except OSError:
        return False
