"""What peers can make a process hold is bounded: messages, memory of all connections together, reasons of losses."""

from __future__ import annotations

import contextlib
import socket
import struct

import rosetta_jit as rj
from rosetta_jit.transports import loop as loops
from rosetta_jit.transports.base import Message, Source
from rosetta_jit.transports.calls import Server
from rosetta_jit.transports.stream import Stream
from tests.transports.free import free_port, until


def test_a_full_queue_drops_the_oldest_and_counts():
    told = []
    address = f"tcp:{free_port()}"
    with rj.subscribe(address, queue=2, lost=lambda *what: told.append(what)) as source, rj.publish(address) as sink:
        for number in range(5):
            sink.send(bytes([number]))
        until(lambda: source.messages == 5)
        assert [source.take(1).data, source.take(1).data] == [b"\3", b"\4"]
        assert source.lost == {"queue full": 3}
        assert told == [("queue full", 1)] * 3


def test_queues_hold_few_large_messages(monkeypatch):
    for module in ("base", "calls"):
        monkeypatch.setattr(f"rosetta_jit.transports.{module}.MAX_QUEUE_BYTES", 5)
    source, server = Source("nothing", None, None), Server("nothing", lambda _: None)
    refused = []
    for each in (b"12", b"34", b"5", b"67", b"123456789"):
        source.arrived(Message(each, "a"))
        server.asked(Message(each, "a"), lambda _, error: refused.append(error))
    assert (source.take(0).data, source.take(0), dict(source.lost)) == (b"123456789", None, {"queue full": 4})
    source.arrived(Message(b"12345", "a"))
    assert source.take(0).data == b"12345"
    assert refused == ["too many questions wait"] * 2


def test_a_length_above_the_limit_ends_the_connection_and_takes_no_memory():
    port = free_port()
    with rj.subscribe(f"tcp:{port}?max_message=1k") as source, socket.create_connection(("127.0.0.1", port)) as bad:
        bad.sendall(b"\xff\xff\xff\xff")
        assert bad.recv(1) == b""
        until(lambda: source.lost)
        assert source.lost == {"a message of 4294967295 bytes, more than max_message=1024": 1}


def test_all_peers_together_take_bounded_memory(monkeypatch):
    monkeypatch.setattr("rosetta_jit.transports.stream.MAX_HELD_BYTES", 8 << 20)
    port = free_port()
    with rj.subscribe(f"tcp:{port}") as source:
        peers = [socket.create_connection(("127.0.0.1", port)) for _ in range(4)]
        for each in peers:
            each.settimeout(0.5)
            with contextlib.suppress(OSError):
                each.sendall(struct.pack("<I", 32 << 20) + bytes(3 << 20))
        until(lambda: source.lost)
        assert set(source.lost) == {"large messages of all peers together take too much memory"}
        for each in peers:
            each.close()
        until(lambda: not source.connections)
        with rj.publish(f"tcp:{port}") as sink:
            sink.send(bytes(1 << 20))
            assert len(source.take(5).data) == 1 << 20


def test_what_waits_for_all_peers_together_takes_bounded_memory(monkeypatch):
    monkeypatch.setattr(loops, "MAX_SENDING_BYTES", 12 << 20)
    port, before = free_port(), loops.loop().sending_bytes
    with rj.publish(f"tcp:{port}?listen=yes&wait=no&linger=0") as sink:
        with contextlib.ExitStack() as stack:
            for _ in range(6):
                stack.enter_context(socket.create_connection(("127.0.0.1", port)))
            until(lambda: sink.connections == 6)
            for _ in range(16):
                sink.send(bytes(1 << 20))
            assert 11 << 20 < loops.loop().sending_bytes - before <= 12 << 20
            assert sink.lost["the peer is too slow"] > 10
        until(lambda: not sink.connections)
        assert loops.loop().sending_bytes == before


def test_nothing_follows_half_a_message_that_takes_too_much_memory(monkeypatch):
    """What follows would be taken for its other half."""
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    got, taken = bytearray(), []

    def work():
        stream = Stream(ours, lambda _: iter(()), lambda *_: None)
        monkeypatch.setattr(loops, "MAX_SENDING_BYTES", loops.loop().sending_bytes)
        taken.append(stream.send(b"x" * (8 << 20)))
        got.extend(theirs.recv(8 << 20))
        taken.append(stream.send(b"next"))

    loops.loop().run(work)
    assert taken == [False, False]
    assert 0 < len(got) < 8 << 20
    theirs.setblocking(True)
    while piece := theirs.recv(1 << 20):
        got.extend(piece)
    assert set(got) == {ord("x")}
    theirs.close()


def test_reasons_are_few_short_and_printable():
    source = Source("here", None, None)
    for number in range(100):
        source.lose(f"\x1b[31m{number}" + "x" * 1000)
    assert len(source.lost) == 51
    assert source.lost["other reasons"] == 50
    assert all(each.isprintable() and len(each) <= 403 for each in source.lost)


def test_a_peer_that_is_wrong_in_ever_new_ways_hides_no_other_reasons():
    source = Source("here", None, None)
    for number in range(1000):
        source.lose(f"a message of {number} bytes, more than max_message=1")
        source.lose(f"another md5 sum: {number}")
    source.lose("queue full")
    assert source.lost["queue full"] == 1
    assert (source.lost["a message of …"], source.lost["another md5 sum: …"]) == (996, 996)
    assert len(source.lost) == 11
