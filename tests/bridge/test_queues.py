"""What a route does with messages that its target does not take: they wait, are dropped and counted, and hold up no others."""

from __future__ import annotations

import socket
import time

import pytest

import rosetta_jit as rj
from rosetta_jit.transports.loop import loop
from tests.bridge.routes import route
from tests.transports.free import free_port, until


def test_a_rate(run):
    source, target = free_port(), free_port()
    with rj.subscribe(f"tcp:{target}"):
        bridge, said = run(route(source, target, "rate = 20"))
        with rj.publish(f"tcp:{source}") as robot:
            begun = time.monotonic()
            while time.monotonic() < begun + 0.5:
                robot.send(b"x")
                time.sleep(0.002)
        until(lambda: bridge.snapshot()[0]["taken"] == robot.messages)
        found = bridge.snapshot()[0]
        assert 8 <= found["sent"] <= 13
        assert found["dropped"] == {"above its rate": found["taken"] - found["sent"]}
        assert any("dropped: above its rate" in line for line in said)


class Refuses:
    """A target that takes messages when it is told to."""

    def __init__(self):
        self.takes, self.got, self.lost, self.connections = False, [], None, 0

    def at_once(self, _):
        return False

    def send(self, data, **_):
        if self.takes:
            self.got.append(bytes(data))
        else:
            self.lost("nobody listens", 1)
        return self.takes

    def flush(self, _):
        return True

    def close(self):
        pass


@pytest.mark.parametrize(("full", "kept"), [("oldest", range(5, 9)), ("newest", range(5))])
def test_what_is_dropped_when_the_queue_is_full(run, monkeypatch, full, kept):
    target = Refuses()

    def publish(address, *, lost):
        target.lost = lost
        return target

    monkeypatch.setattr("rosetta_jit.bridge.running.publish", publish)
    source = free_port()
    bridge, said = run(route(source, 1, "queue = 4", f'full = "{full}"'))
    live = next(iter(bridge.live.values()))
    live.deliver(b"\0", 1)
    until(lambda: live._held)  # the queue's thread has it
    for number in range(1, 9):
        live.deliver(bytes([number]), 1)
    assert live.waiting == 5
    assert live.counts.dropped == {"queue full (nobody listens)": 4}
    assert any("1 dropped: queue full" in line for line in said)
    target.takes = True
    until(lambda: len(target.got) == 5)
    assert target.got == [bytes([number]) for number in ([0, *kept] if full == "oldest" else kept)]
    live.deliver(bytes([99]), 1)
    assert target.got[-1] == bytes([99])  # at once: nothing waits


def test_a_queue_holds_few_large_messages(run, monkeypatch):
    monkeypatch.setattr("rosetta_jit.bridge.live.MAX_QUEUE_BYTES", 5)
    bridge, _ = run(route(free_port(), f"{free_port()}?wait=no", "queue = 4"))
    live = next(iter(bridge.live.values()))
    live.deliver(b"\0", 1)
    until(lambda: live._held)
    for each in (b"12", b"34", b"5", b"67", b"123456789"):
        live.deliver(each, 1)
    assert [item[0] for item in live._waiting] == [b"123456789"]
    assert sum(live.counts.dropped.values()) == 4


def test_a_message_that_is_refused_for_ever_holds_up_no_others(run, monkeypatch):
    target = Refuses()
    target.connections, target.send = 1, lambda data, **_: bytes(data) != b"\x05" and not target.got.append(bytes(data))

    def publish(address, *, lost):
        return target

    monkeypatch.setattr("rosetta_jit.bridge.running.publish", publish)
    bridge, _ = run(route(free_port(), 1, "timeout = 0.1"))
    live = next(iter(bridge.live.values()))
    for number in range(4, 8):
        live.deliver(bytes([number]), 1)
    until(lambda: len(target.got) == 3)
    assert target.got == [b"\x04", b"\x06", b"\x07"]
    assert sum(live.counts.dropped.values()) == 1


def test_what_was_taken_is_sent_before_it_stops(run):
    """The target comes when the bridge has been told to stop."""
    source, target = free_port(), free_port()
    bridge, _ = run(route(source, target))
    with rj.publish(f"tcp:{source}") as robot:
        for number in range(50):
            robot.send(bytes([number]))
        until(lambda: bridge.snapshot()[0]["taken"] == 50)
    with rj.subscribe(f"tcp:{target}") as late:
        bridge.stop(5)
        assert [late.take(5).data for _ in range(50)] == [bytes([number]) for number in range(50)]


def test_what_was_not_sent_is_counted(run, monkeypatch):
    target = Refuses()

    def publish(address, *, lost):
        target.lost = lost
        return target

    monkeypatch.setattr("rosetta_jit.bridge.running.publish", publish)
    bridge, said = run(route(free_port(), 1))
    live = next(iter(bridge.live.values()))
    for number in range(3):
        live.deliver(bytes([number]), 1)
    bridge.stop(0.1)
    assert sum(live.counts.dropped.values()) == 3
    assert any("nobody listens" in line for line in said)


def test_a_peer_that_is_too_slow_costs_its_own_messages_and_is_counted(run):
    """One of two takes nothing. What the other one got is sent, and what the first one did not get is dropped."""
    source, target = free_port(), free_port()
    bridge, said = run(f'[[route]]\nsource = "tcp:{source}"\ntarget = "rsb:/big?port={target}&type=bytes&linger=0.1"\n')
    live = next(iter(bridge.live.values()))
    until(lambda: live.target is not None)
    with (
        rj.subscribe(f"rsb:/big?host=localhost&port={target}&role=client", queue=100) as quick,
        socket.create_connection(("127.0.0.1", target)),
    ):
        until(lambda: live.target.connections == 2)
        with rj.publish(f"tcp:{source}") as robot:
            for _ in range(30):
                robot.send(bytes(1 << 20))
                assert quick.take(5)
        until(lambda: bridge.snapshot()[0]["sent"] == 30)
        too_slow = live.counts.dropped["the peer is too slow"]
        assert too_slow > 5
        assert any("1 dropped: the peer is too slow" in line for line in said)
        bridge.stop(0.1)
        assert 10 <= live.counts.dropped["closed before it was sent"] <= 30 - too_slow


def test_many_targets_that_take_nothing_are_closed_side_by_side(run, request):
    held = [socket.socket() for _ in range(8)]  # bound, so that no other process listens there
    for each in held:
        request.addfinalizer(each.close)
        each.bind(("127.0.0.1", 0))
    targets = [each.getsockname()[1] for each in held]
    bridge, _ = run("".join(route(free_port(), each, f'name = "{each}"') for each in targets))
    for each in bridge.live.values():
        loop().soon(each.deliver, b"\0", 1)  # where messages arrive, nobody waits for a target
    until(lambda: all(each.waiting for each in bridge.live.values()))
    begun = time.monotonic()
    bridge.stop(0.5)
    assert time.monotonic() - begun < 3.0
    assert {(sum(each.counts.dropped.values()), each.waiting) for each in bridge.live.values()} == {(1, 0)}


def test_each_message_for_a_target_that_takes_nothing_is_counted_once(run):
    source, target = free_port(), free_port()
    with socket.create_server(("127.0.0.1", target)) as stuck:
        bridge, _ = run(route(source, f"{target}?timeout=0.05&linger=0.05", "queue = 5"))
        live = next(iter(bridge.live.values()))
        peer, _ = stuck.accept()
        with peer, rj.publish(f"tcp:{source}") as robot:
            for _ in range(40):
                robot.send(bytes(1 << 20))
            until(lambda: live.counts.taken == 40)
            bridge.stop(0.1)
            peer.setblocking(False)
            arrived = 0
            while piece := peer.recv(1 << 20):
                arrived += len(piece)
        dropped = live.counts.dropped
        assert live.counts.sent == dropped["closed before it was sent"] + arrived // ((1 << 20) + 4)
        assert live.counts.sent + sum(dropped.values()) - dropped["closed before it was sent"] == 40
        assert dropped["closed before it was sent"] > 4
