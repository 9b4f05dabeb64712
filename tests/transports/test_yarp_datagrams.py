"""Ports of ours with each other by udp and mcast: how they find each other, and notice the end of one that does not say goodbye."""

from __future__ import annotations

import socket
import threading
import time

import pytest

import rosetta_jit as rj
from rosetta_jit.transports.loop import loop
from rosetta_jit.transports.yarp import port as ports
from rosetta_jit.transports.yarp.admin import ask_port
from rosetta_jit.transports.yarp.names import Contact
from rosetta_jit.transports.yarp.pieces import MISSING, cut
from rosetta_jit.transports.yarp.wire import head_of, hello, int_of
from tests.transports.free import until
from tests.transports.name_server import NameServer

CARRIERS = ["udp", "mcast"]
IMAGE = bytes(range(256)) * 1000


@pytest.fixture
def names():
    server = NameServer()
    yield server
    server.close()


@pytest.fixture
def at(names):
    return lambda name, more="": f"yarp:{name}?server=127.0.0.1:{names.port}{more}"


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.setattr(ports, "SOON_S", 0.05)
    monkeypatch.setattr(ports, "HEARTBEAT_S", 0.1)


@pytest.mark.parametrize("carrier", CARRIERS)
def test_messages_go_from_port_to_port(at, names, carrier):
    with (
        rj.publish(at("/out")) as sink,
        rj.subscribe(at("/out", f"&carrier={carrier}")) as one,
        rj.subscribe(at("/out", f"&carrier={carrier}")) as two,
    ):
        until(lambda: sink.connections == 2 and one.connections and two.connections)
        for data in (b"1", IMAGE, b"2"):
            sink.send(data, time=1_700_000_000_250_000_000)
        assert sink.flush()
        for source in (one, two):
            first, image, last = (source.take(5) for _ in range(3))
            assert (first.data, image.data, last.data, first.sent) == (b"1", IMAGE, b"2", 1_700_000_000_250_000_000)
            assert first.attributes == {"sender": "/out", "carrier": carrier, "envelope": "1 1700000000.25", "sequence": 1}
        two.close()
        until(lambda: sink.connections == 1)
        sink.send(b"3")
        assert one.take(5).data == b"3"
        assert ("224.1.1.1" in {host for host, _ in names.ports.values()}) is (carrier == "mcast")
    assert not names.ports
    assert not sink.lost
    assert not one.lost


@pytest.mark.parametrize("carrier", CARRIERS)
def test_a_port_is_written_to_and_told_goodbye(at, names, carrier):
    with rj.subscribe(at("/in", "&open=yes")) as source:
        with rj.publish(at("/in", f"&open=no&name=/me&carrier={carrier}")) as sink:
            until(lambda: sink.connections)
            assert sink.send(b"hello")
            assert source.take(5).data == b"hello"
            me = Contact("/me", "127.0.0.1", int(names.ports["/me"][1]), "tcp")
            assert ask_port(me, '[list] [out] "/in"', 2).strip() == f'(from "/me") (to "/in") (carrier {carrier}) (connectionless 1)'
        until(lambda: not source.connections)
    assert (sink.lost, source.lost, source.sessions) == ({}, {}, 1)


@pytest.mark.parametrize("carrier", CARRIERS)
def test_a_reader_that_dies_is_noticed_and_found_again(at, names, carrier):
    """By the system, which tells that nobody listens there, or by the name server, which knows where it is now."""
    with rj.publish(at("/in", f"&open=no&carrier={carrier}")) as sink:
        first = rj.subscribe(at("/in", "&open=yes"))
        until(lambda: sink.connections)
        kill(first)
        with rj.subscribe(at("/in", "&open=yes")) as source:
            until(lambda: sink.reconnects and source.connections)
            sink.send(b"again")
            assert source.take(5).data == b"again"


@pytest.mark.parametrize("carrier", CARRIERS)
def test_a_writer_that_dies_is_noticed_and_found_again(at, carrier):
    with rj.subscribe(at("/out", f"&carrier={carrier}")) as source:
        first = rj.publish(at("/out"))
        until(lambda: source.connections)
        kill(first)
        with rj.publish(at("/out")) as sink:
            until(lambda: sink.connections and source.sessions == 2)
            sink.send(b"again")
            assert source.take(5).data == b"again"
        assert source.reconnects == 1


def kill(end):
    """Let a port vanish as its process would: nobody is told."""
    port = next(each for each in closure(end) if isinstance(each, ports.Port))
    port._stopped = True
    port._nudge.set()
    port._thread.join()
    port._listener.close()
    for line in tuple(port._inputs):
        loop().run(line.end)
    for output in tuple(port.outputs.values()):
        output.close(0)
    for group in port._groups.values():
        group.sender.close()


def closure(end):
    return [end.port] if hasattr(end, "port") else [cell.cell_contents for cell in end._close.__closure__]


def say_hello(port, name, carrier="udp", more=b""):
    """Say hello as any program may; gives the port for datagrams."""
    with socket.create_connection(("127.0.0.1", port)) as line:
        line.sendall(hello(carrier, name) + more)
        answer = line.recv(8)
        return int_of(memoryview(answer)) if answer else None


def test_hostile_writers_cost_themselves_alone(at, names, monkeypatch):
    """Strangers' datagrams, writers without number, groups that are none, and pieces of messages that never come to an end."""
    monkeypatch.setattr(ports, "MAX_DATAGRAM_INPUTS", 8)
    with rj.subscribe(at("/in", "&open=yes&max_message=1M")) as source, rj.publish(at("/in", "&open=no")) as good:
        until(lambda: good.connections)
        number = int(names.ports["/in"][1])
        assert say_hello(number, "/w", "mcast", bytes([127, 0, 0, 1, 1, 0])) is None
        assert say_hello(number, "/w", "mcast", bytes([10, 0, 0, 1, 1, 0])) is None
        until(lambda: sum("is no group of mcast" in reason for reason in source.lost) == 2)
        silent = [say_hello(number, f"/silent{each}") for each in range(8)]
        mine = say_hello(number, "/mine")
        assert mine not in silent
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as writer:
            writer.connect(("127.0.0.1", mine))
            pieces = [b"".join(each) for each in cut(head_of(len(IMAGE)), IMAGE)]
            for each in (b"", b"\0" * 8, b"garbage", pieces[0], pieces[2], b"".join(next(cut(head_of(2 << 20), b""))), *pieces[:2]):
                writer.send(each)
            until(lambda: sum(source.lost.values()) >= 6)
        assert say_hello(number, "/mine") != mine  # who begins anew has no second connection
        until(lambda: source.connections == 9)
        assert good.send(b"unharmed")
        assert source.take(5).data == b"unharmed"
        assert source.lost[MISSING] == 1
        assert source.lost["a message of 2097152 bytes, more than max_message=1048576"] == 1
        assert source.lost["too many writers by udp, and this one was silent"] == 1
        assert source.lost["the connection ended in the middle of a message"] == 1


def test_datagrams_of_another_host_are_dropped(at, names):
    with rj.subscribe(at("/in", "&open=yes")) as source, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        place = say_hello(int(names.ports["/in"][1]), "/w")
        stranger.bind(("127.0.0.2", 0))
        stranger.sendto(b"".join(next(cut(head_of(1), b"1"))), ("127.0.0.1", place))
        until(lambda: source.lost)
        assert (source.messages, dict(source.lost)) == (0, {"a datagram from another host than the writer's": 1})


def test_what_the_system_drops_is_counted(at, monkeypatch):
    """A reader that is too slow for the datagrams that come: all of them arrive, or are counted."""
    monkeypatch.setattr("rosetta_jit.transports.datagrams.BUFFER_BYTES", 1 << 16)
    free, count = threading.Event(), 2000
    with rj.subscribe(at("/in", "&open=yes"), lambda _: free.wait(5)) as source, rj.publish(at("/in", "&open=no&carrier=udp")) as sink:
        until(lambda: sink.connections)
        for _ in range(count):
            assert sink.send(bytes(1000))
        free.set()
        until(lambda: source.messages)
        time.sleep(0.1)
        sink.send(b"last")  # with it comes the number of those that were dropped
        until(lambda: source.messages + sum(source.lost.values()) == count + 1)
        assert list(source.lost) == ["the system's receive buffer was full"]


def test_what_one_connection_holds_is_counted_with_the_others(at, names, monkeypatch):
    monkeypatch.setattr("rosetta_jit.transports.yarp.incoming_datagrams.MAX_HELD_BYTES", loop().held_bytes + (1 << 18))
    held = loop().held_bytes
    with rj.subscribe(at("/in", "&open=yes")) as source, rj.publish(at("/in", "&open=no&carrier=udp")) as sink:
        until(lambda: sink.connections)
        sink.send(bytes(1 << 20))
        until(lambda: "large messages of all peers together take too much memory" in source.lost)
    until(lambda: loop().held_bytes <= held)
