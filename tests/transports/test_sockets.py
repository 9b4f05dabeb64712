"""TCP, Unix sockets, UDP and pipes on loopback: what is sent arrives, and what fails is counted and costs nobody else."""

from __future__ import annotations

import contextlib
import os
import socket
import struct
import threading
import time

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import AddressError, TransportError
from rosetta_jit.transports import loop as loops
from rosetta_jit.transports.base import Message, Server, Source
from rosetta_jit.transports.installed import installed
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


def test_a_named_pipe_ends_with_its_writer(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with rj.subscribe(f"pipe:{tmp_path}/pipe") as source:
        with rj.publish(f"pipe:{tmp_path}/pipe") as sink:
            for each in MESSAGES:
                sink.send(each)
        assert [each.data for each in source] == MESSAGES


def test_a_named_pipe_without_a_reader_is_said_and_one_that_comes_back_is_found(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    place = f"pipe:{tmp_path}/pipe"
    with pytest.raises(TransportError, match="nobody reads the pipe"):
        rj.publish(place, timeout=0.05)
    first = rj.subscribe(place)
    with rj.publish(place) as sink:
        assert sink.send(b"1")
        assert first.take(5).data == b"1"
        first.close()
        assert not sink.send(b"2")
        assert (sink.connections, dict(sink.lost)) == (0, {"nobody reads the pipe": 1})
        with rj.subscribe(place) as second:
            assert sink.send(b"3")
            assert second.take(5).data == b"3"
        assert (sink.reconnects, sink.messages) == (1, 2)


def test_a_full_pipe_holds_up_no_sockets(tmp_path):
    """What comes by a socket is sent in the thread that serves all of them."""
    os.mkfifo(tmp_path / "pipe")
    source, other = f"tcp:{free_port()}", f"tcp:{free_port()}"
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    try:
        with (
            rj.publish(f"pipe:{tmp_path}/pipe?linger=0.05") as pipe,
            rj.subscribe(source, lambda message: pipe.send(message.data)) as arrived,
            rj.subscribe(other) as quick,
            rj.publish(source) as robot,
            rj.publish(other) as another,
        ):
            for size in (10, *[1 << 20] * 24, 10):
                robot.send(bytes(size))
            until(lambda: arrived.messages == 26)
            another.send(b"meanwhile")
            assert quick.take(5).data == b"meanwhile"
            read = b""
            while len(read) < 2 << 20:
                with contextlib.suppress(BlockingIOError):
                    read += os.read(reader, 1 << 20)
            assert read[:18] == b"\n\0\0\0" + bytes(10) + struct.pack("<I", 1 << 20)
            assert 5 < pipe.lost["the reader is too slow"] < 12
            too_slow = pipe.lost["the reader is too slow"]
            pipe.close()
            assert 12 <= pipe.lost["closed before it was sent"] <= 25 - too_slow
    finally:
        os.close(reader)


def test_a_file_that_is_cut_says_so(tmp_path):
    (tmp_path / "cut").write_bytes(b"\3\0\0\0abc\5\0\0\0ab")
    with rj.subscribe(f"pipe:{tmp_path}/cut") as source:
        assert [each.data for each in source] == [b"abc"]
        assert source.lost == {"the pipe ended in the middle of a message": 1}


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
    monkeypatch.setattr("rosetta_jit.transports.base.MAX_QUEUE_BYTES", 5)
    source, server = Source("nothing", None, None), Server("nothing", lambda _: None)
    refused = []
    for each in (b"12", b"34", b"5", b"67", b"123456789"):
        source.arrived(Message(each, "a"))
        server.asked(Message(each, "a"), lambda _, error: refused.append(error))
    assert (source.take(0).data, source.take(0), dict(source.lost)) == (b"123456789", None, {"queue full": 4})
    source.arrived(Message(b"12345", "a"))
    assert source.take(0).data == b"12345"
    assert refused == ["too many questions wait"] * 2


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


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("/icub/torso", "an address begins with its transport"),
        ("tpc:9000", "did you mean `tcp:`?"),
        ("tcp:localhost", "expected a host and a port"),
        ("tcp:1:99999", "expected a host and a port"),
        ("tcp:9000?fram=u32", "did you mean `frame`?"),
        ("tcp:9000?frame=u31", "`frame` takes one of `u32`"),
        ("tcp:9000?max_message=-1", "`max_message` takes a number of bytes"),
        ("tcp:9000?queue=1&queue=2", "`queue` is said twice"),
        ("tcp:9000?timeout=nan", "`timeout` takes a number of seconds"),
        ("udp:9000?frame=u32", "there is no option `frame`"),
    ],
)
def test_what_is_wrong_with_an_address_is_said(address, said):
    with pytest.raises(AddressError, match=r"(?s)error\[") as caught:
        rj.subscribe(address)
    assert said in str(caught.value)


def test_an_installed_package_may_offer_a_transport(tmp_path, monkeypatch):
    (tmp_path / "toy_transport.py").write_text(
        "from rosetta_jit.transports.base import Message, Transport\n"
        "def subscribe(address, source, options):\n"
        "    source.arrived(Message(address.rest.encode(), address.rest))\n"
        "    source.ended()\n"
        "TOY = Transport('toy', ('toy',), 'toy:a', subscribe='toy_transport:subscribe')\n"
    )
    described = tmp_path / "toy-1.dist-info"
    described.mkdir()
    (described / "METADATA").write_text("Metadata-Version: 2.1\nName: toy\nVersion: 1\n")
    (described / "entry_points.txt").write_text("[rosetta_jit.transports]\ntoy = toy_transport:TOY\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    installed.cache_clear()
    try:
        with rj.subscribe("toy:hello") as source:
            assert [each.data for each in source] == [b"hello"]
        with pytest.raises(AddressError, match="cannot publish"):
            rj.publish("toy:hello")
    finally:
        installed.cache_clear()


def test_options_of_a_call_go_before_those_of_the_address():
    with pytest.raises(AddressError, match="takes an integer"):
        rj.subscribe("tcp:9000?queue=5", queue="many")
