"""TCP, Unix sockets and UDP on loopback: what is sent arrives, and what fails is counted and costs nobody else."""

from __future__ import annotations

import socket
import struct
import threading
import time

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import TransportError
from rosetta_jit.transports import loop as loops
from rosetta_jit.transports.stream import Stream
from tests.transports.free import free_port, until

MESSAGES = [b"", b"a", bytes(range(256)), b"x" * 300_000, b"end"]


@pytest.mark.parametrize("frame", ["u32", "u32be", "u64", "u64be", "varint"])
def test_messages_arrive_over_tcp_as_they_were_sent(frame):
    address = f"tcp:{free_port()}?frame={frame}"
    with rj.subscribe(address) as source, rj.publish(address) as sink:
        assert all(sink.send(each) for each in MESSAGES)
        got = [source.take(5) for _ in MESSAGES]
        assert [each.data for each in got] == MESSAGES
        assert (source.messages, source.bytes, source.lost) == (5, sum(map(len, MESSAGES)), {})
        assert abs(got[0].time - time.time_ns()) < 10 * 10**9


def test_the_sender_may_listen_and_many_may_receive(tmp_path):
    address = f"unix:{tmp_path}/robot.socket"
    with rj.publish(address, listen="yes") as sink, rj.subscribe(address, listen="no") as one, rj.subscribe(address, listen="no") as two:
        until(lambda: sink.connections == 2)
        sink.send(b"both")
        assert one.take(5).data == two.take(5).data == b"both"


def test_lines_end_with_a_newline():
    address = f"tcp:{free_port()}?frame=line"
    with rj.subscribe(address) as source, rj.publish(address) as sink:
        sink.send(b"one")
        sink.send(b"")
        assert [source.take(5).data, source.take(5).data] == [b"one", b""]
        with pytest.raises(TransportError, match="no newline"):
            sink.send(b"a\nb")


def test_datagrams_have_a_limit():
    address = f"udp:{free_port()}"
    with rj.subscribe(address, max_message=1000) as source, rj.publish(address) as sink:
        sink.send(b"x" * 1001)
        sink.send(b"y" * 1000)
        assert source.take(5).data == b"y" * 1000
        assert source.lost == {"a message larger than max_message": 1}
        with pytest.raises(TransportError, match="too large"):
            sink.send(bytes(65_508))


def test_threads_that_ask_for_the_first_loop_at_the_same_time_get_the_same_one(monkeypatch):
    made = []

    class Slow:
        def __init__(self):
            time.sleep(0.02)
            made.append(self)

    monkeypatch.setattr(loops, "Loop", Slow)
    got, threads = [], [threading.Thread(target=lambda: got.append(loops._loop_of(-1))) for _ in range(8)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert len(made) == 1
    assert got == made * 8


def test_datagrams_that_the_system_drops_are_counted(monkeypatch):
    monkeypatch.setattr("rosetta_jit.transports.datagrams.BUFFER_BYTES", 1 << 16)
    port, free = free_port(), threading.Event()
    with rj.subscribe(f"udp:{port}", lambda _: free.wait(5)) as source, rj.publish(f"udp:{port}") as sink:
        for _ in range(1000):
            sink.send(bytes(1000))
        free.set()
        until(lambda: source.messages)
        time.sleep(0.1)
        sink.send(b"the next one that arrives says how many did not")
        until(lambda: source.messages + source.lost["the system's receive buffer was full"] == 1001)


def test_groups_stay_on_loopback():
    address = f"udp:239.255.76.67:{free_port()}"
    with rj.subscribe(address) as one, rj.subscribe(address) as two, rj.publish(address) as sink:
        sink.send(b"all")
        assert one.take(5).data == two.take(5).data == b"all"


def test_a_peer_that_dies_in_the_middle_costs_its_own_message():
    port = free_port()
    with rj.subscribe(f"tcp:{port}") as source:
        with socket.create_connection(("127.0.0.1", port)) as bad, rj.publish(f"tcp:{port}") as good:
            bad.sendall(struct.pack("<I", 100) + b"half")
            good.send(b"whole")
            assert source.take(5).data == b"whole"
            bad.close()
            until(lambda: source.lost)
            good.send(b"still")
            assert source.take(5).data == b"still"
        assert source.lost == {"the connection ended in the middle of a message": 1}


def test_peers_that_vanish_are_noticed():
    """Half-open connections: the kernel asks after a silence, and gives up on what is not acknowledged, within half a minute."""
    one, two = socket.create_server(("127.0.0.1", 0)), socket.socket()
    two.connect(one.getsockname())
    stream = Stream(two, lambda _: iter(()), lambda *_: None)
    option = stream.socket.getsockopt
    assert option(socket.SOL_SOCKET, socket.SO_KEEPALIVE) == 1
    assert option(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE) + 3 * option(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL) <= 30
    assert option(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT) <= 30_000
    one.close()
    two.close()


def test_a_slow_reader_makes_the_sender_wait_or_drop():
    port = free_port()
    with socket.create_server(("127.0.0.1", port)) as server, rj.publish(f"tcp:{port}?wait=no&linger=0") as sink:
        peer, _ = server.accept()
        with peer:
            until(lambda: sink.connections)
            began = time.monotonic()
            taken = sum(sink.send(bytes(1 << 20)) for _ in range(40))
            assert time.monotonic() - began < 3
            assert 16 <= taken < 40
            assert sink.lost == {"the peer is too slow": 40 - taken}
        until(lambda: not sink.connections)
        assert 10 <= sink.lost["the peer went away"] <= taken  # what waited for it


def test_what_waits_when_the_sender_closes_is_counted():
    port = free_port()
    with socket.create_server(("127.0.0.1", port)) as server, rj.publish(f"tcp:{port}?wait=no&linger=0.05") as sink:
        until(lambda: sink.connections)
        taken = sum(sink.send(bytes(1 << 20)) for _ in range(24))
        sink.close()
        assert 4 <= sink.lost["closed before it was sent"] <= taken
        server.accept()[0].close()


def test_what_has_one_peer_goes_the_shortest_way():
    port = free_port()
    with rj.publish(f"tcp:{port}?listen=yes&frame=u16&max_message=1M") as sink:
        assert not sink.at_once(b"nobody")
        with rj.subscribe(f"tcp:{port}?listen=no&frame=u16") as one:
            until(lambda: sink.connections)
            assert sink.at_once(b"a")
            assert sink.at_once(bytes(65535))
            assert not sink.at_once(bytes(65536))  # such a length has no place in the frame
            assert [len(one.take(5).data) for _ in range(2)] == [1, 65535]
            assert (sink.messages, sink.bytes, dict(sink.lost)) == (2, 65536, {})
            with rj.subscribe(f"tcp:{port}?listen=no&frame=u16"):
                until(lambda: sink.connections == 2)
                assert not sink.at_once(b"both")
    assert not sink.at_once(b"closed")


@pytest.mark.parametrize("frame", ["line", "varint"])
def test_what_has_no_length_of_fixed_size_goes_the_usual_way(frame):
    port = free_port()
    with rj.publish(f"tcp:{port}?listen=yes&frame={frame}") as sink, rj.subscribe(f"tcp:{port}?listen=no&frame={frame}") as source:
        until(lambda: sink.connections)
        assert not sink.at_once(b"abc")
        assert sink.send(b"abc")
        assert source.take(5).data == b"abc"


def test_a_sender_waits_for_a_reader_that_comes_later():
    port = free_port()
    with rj.publish(f"tcp:{port}") as sink:
        threading.Timer(0.2, lambda: sources.append(rj.subscribe(f"tcp:{port}"))).start()
        sources = []
        assert sink.send(b"early")
        with sources[0] as source:
            assert source.take(5).data == b"early"


def test_it_connects_again():
    port = free_port()
    with rj.publish(f"tcp:{port}") as sink:
        with rj.subscribe(f"tcp:{port}") as source:
            sink.send(b"1")
            assert source.take(5).data == b"1"
        until(lambda: not sink.connections)
        with rj.subscribe(f"tcp:{port}") as source:
            sink.send(b"2")
            assert source.take(5).data == b"2"
        assert sink.reconnects == 1


def test_a_hundred_connections_at_once():
    port = free_port()
    with rj.subscribe(f"tcp:{port}") as source:
        peers = [socket.create_connection(("127.0.0.1", port)) for _ in range(100)]
        for number, each in enumerate(peers):
            each.sendall(b"\1\0\0\0" + bytes([number]))
        assert sorted(source.take(5).data[0] for _ in peers) == list(range(100))
        assert source.connections == 100
        for each in peers:
            each.close()
        until(lambda: not source.connections)
        assert not source.lost


def test_a_port_that_is_taken_is_said():
    port = free_port()
    with rj.subscribe(f"tcp:{port}"), pytest.raises(TransportError) as caught:
        rj.subscribe(f"tcp:{port}")
    assert caught.value.kind == "taken"


def test_a_callback_that_raises_costs_one_message(monkeypatch):
    reported = []
    monkeypatch.setattr(threading, "excepthook", lambda what: reported.append(what.exc_type))
    got = []

    def deliver(message):
        if message.data == b"bad":
            raise ValueError
        got.append(bytes(message.data))

    port = free_port()
    with rj.subscribe(f"tcp:{port}", deliver) as source, rj.publish(f"tcp:{port}") as sink:
        for each in (b"1", b"bad", b"2"):
            sink.send(each)
        until(lambda: len(got) == 2)
        assert (got, reported, source.lost) == ([b"1", b"2"], [ValueError], {"the callback failed": 1})


def test_calls_get_their_answers():
    address = f"tcp:{free_port()}"
    with rj.serve(address, lambda message: bytes(message.data)[::-1]), rj.call(address) as ask:
        assert [ask(each).data for each in (b"abc", b"", b"x" * 100_000)] == [b"cba", b"", b"x" * 100_000]


def test_a_call_that_nobody_answers_ends_in_time():
    address = f"tcp:{free_port()}"
    with rj.call(address) as ask, pytest.raises(TransportError, match="nobody answers"):
        ask(b"?", timeout=0.1)
    asked = threading.Event()
    with rj.serve(address, lambda _: asked.wait(1) and None), rj.call(address) as ask:
        with pytest.raises(TransportError, match="no answer came in time"):
            ask(b"?", timeout=0.1)
        asked.set()


def test_an_answer_that_fails_ends_its_connection():
    address = f"tcp:{free_port()}"
    with rj.serve(address, lambda _: 1 // 0) as server, rj.call(address) as ask:
        with pytest.raises(TransportError, match="ended before the answer"):
            ask(b"?")
        assert server.lost == {"the answer failed": 1}
