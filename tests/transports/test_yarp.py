"""Ports of ours with each other, by a small name server: connections come, go and come back, and bad peers cost themselves alone."""

from __future__ import annotations

import socket
import struct
import time

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import AddressError, TransportError
from rosetta_jit.transports.opening import names as names_at
from rosetta_jit.transports.yarp.admin import ask_port
from rosetta_jit.transports.yarp.bottles import from_text, to_text
from rosetta_jit.transports.yarp.names import Contact, configured
from rosetta_jit.transports.yarp.wire import hello
from tests.transports.free import free_port, until
from tests.transports.name_server import NameServer

BOTTLE = from_text("1 2.5 hello (1 2 3)", "yarp3")


@pytest.fixture
def names():
    server = NameServer()
    yield server
    server.close()


@pytest.fixture
def at(names):
    return lambda name, more="": f"yarp:{name}?server=127.0.0.1:{names.port}{more}"


def test_messages_go_from_port_to_port(at, names):
    with rj.publish(at("/out")) as sink, rj.subscribe(at("/out")) as source:
        until(lambda: sink.connections)
        sink.send(BOTTLE)
        sink.send(BOTTLE, time=1_700_000_000_250_000_000)
        sink.send(b"", attributes={"envelope": "free text"})
        one, two, three = (source.take(5) for _ in range(3))
        assert (one.data, one.channel, one.type, one.sent, one.attributes) == (
            BOTTLE,
            "/out",
            None,
            None,
            {"sender": "/out", "carrier": "tcp"},
        )
        assert (two.sent, two.attributes["sequence"], two.attributes["envelope"]) == (1_700_000_000_250_000_000, 1, "1 1700000000.25")
        assert (three.data, three.attributes["envelope"]) == (b"", "free text")
        assert ("/out", None) in names_at(at("/"))
        assert sink.flush()
    assert not names.ports
    assert not sink.lost
    assert not source.lost


@pytest.mark.parametrize("carrier", ["tcp", "fast_tcp"])
def test_a_port_may_be_written_to(at, carrier):
    with rj.subscribe(at("/in", "&open=yes")) as source, rj.publish(at("/in", f"&open=no&name=/me&carrier={carrier}")) as sink:
        until(lambda: sink.connections)
        for number in range(500):
            assert sink.send(struct.pack("<i", number) * 100)
        got = [source.take(5) for _ in range(500)]
        assert [struct.unpack_from("<i", each.data)[0] for each in got] == list(range(500))
        assert got[0].attributes == {"sender": "/me", "carrier": carrier}


def test_a_subscription_waits_for_its_port(at):
    with rj.subscribe(at("/late")) as source:
        time.sleep(0.1)
        for number in range(2):  # and the port may go and come back
            with rj.publish(at("/late")) as sink:
                until(lambda: sink.connections)
                sink.send(bytes([number]))
                assert source.take(5).data == bytes([number])
            until(lambda: not source.connections)
        assert source.reconnects == 1


def test_a_name_server_may_restart(at, names, monkeypatch):
    monkeypatch.setattr("rosetta_jit.transports.yarp.port.HEARTBEAT_S", 0.05)
    with rj.publish(at("/stays")) as sink, rj.subscribe(at("/stays")) as source:
        until(lambda: sink.connections)
        names.close()
        sink.send(b"meanwhile")
        assert source.take(5).data == b"meanwhile"
        again = NameServer(names.port)
        until(lambda: "/stays" in again.ports)
        again.close()
        names.server.server_close()


def test_without_a_name_server_it_is_said_or_waited_for(names):
    port = free_port()
    with pytest.raises(TransportError, match="name server does not answer"):
        rj.publish(f"yarp:/a?server=127.0.0.1:{port}")
    with rj.publish(f"yarp:/a?server=127.0.0.1:{port}&patient=yes"):
        late = NameServer(port)
        until(lambda: "/a" in late.ports)
    late.close()


def test_a_name_that_is_taken_is_said_and_one_left_behind_is_not(at, names):
    with rj.publish(at("/mine")), pytest.raises(TransportError) as caught:
        rj.publish(at("/mine"))
    assert caught.value.kind == "taken"
    names.ports["/mine"] = "127.0.0.1", str(free_port())
    with rj.publish(at("/mine")):
        pass


def test_questions_are_answered(at):
    with (
        rj.serve(at("/server"), lambda message: from_text(f"got ({to_text(message.data, 'yarp3')})", "yarp3")),
        rj.call(at("/server")) as ask,
    ):
        for question in ("1 2 3", "[set] [poss] (0.0 10.5)", ""):
            assert to_text(ask(from_text(question, "yarp3")).data, "yarp3") == f"got ({question})"


def test_an_answer_that_fails_is_an_empty_bottle(at):
    """Without one, YARP's programs would wait for ever."""
    with rj.serve(at("/server"), lambda _: 1 // 0) as server, rj.call(at("/server")) as ask:
        assert to_text(ask(BOTTLE).data, "yarp3") == ""
        assert server.lost == {"the answer failed": 1}


def test_an_answer_that_comes_late_is_nobodys(at):
    with (
        rj.serve(at("/server"), lambda message: (time.sleep(0.3) if message.data == b"slow" else None, BOTTLE)[1]),
        rj.call(at("/server")) as ask,
    ):
        with pytest.raises(TransportError, match="no answer came in time"):
            ask(b"slow", timeout=0.05)
        assert ask(b"quick").data == BOTTLE
        assert ask.reconnects == 1


def test_a_server_that_is_not_there_is_said(at):
    with rj.call(at("/nobody")) as ask, pytest.raises(TransportError, match="knows no such port"):
        ask(BOTTLE)


def contact(names, name):
    return Contact(name, "127.0.0.1", int(names.ports[name][1]), "tcp")


def test_a_port_obeys_its_administration(at, names):
    with rj.publish(at("/out")) as sink, rj.subscribe(at("/in", "&open=yes")) as source:
        out, into = contact(names, "/out"), contact(names, "/in")
        assert ask_port(out, "[ver]", 2) == "[ver] 1 2 3"
        assert ask_port(out, '[list] [out] "/in"', 2) == ""
        assert ask_port(out, '[add] "tcp://in"', 2) == '0 "Added connection from /out to tcp://in"'
        assert ask_port(out, '[list] [out] "/in"', 2) == '(from "/out") (to "/in") (carrier tcp)'
        until(lambda: source.connections)
        assert ask_port(into, "[list] [in]", 2) == '"/out"'
        assert ask_port(into, '[list] [in] "/out"', 2) == '(from "/out") (to "/in") (carrier tcp)'
        assert ask_port(out, '[del] "/in"', 2) == '0 "Removed connection from /out to /in"'
        until(lambda: not source.connections and not sink.connections)
        assert ask_port(out, '[del] "/in"', 2).startswith("-1 ")
        for wrong in ('[add] "/nope"', '[add] "shmem://in"', '[add] "tcp:/no such\tport"', "[add] tcp://in\x07"):
            assert ask_port(out, wrong, 2).startswith("-1 ")
        assert ask_port(into, '[add] "/out"', 2).startswith("-1 ")
        assert ask_port(out, "[fly]", 2).startswith("[fail]")


def test_bad_peers_cost_themselves_alone(at, names):
    with rj.subscribe(at("/in", "&open=yes&max_message=1k")) as source, rj.publish(at("/in", "&open=no")) as good:
        until(lambda: good.connections)
        where = ("127.0.0.1", int(names.ports["/in"][1]))
        for garbage in (b"\xff" * 100, b"GET / HTTP/1.0\r\n\r\n", hello("tcp", "/bad") + b"\0" * 64, b"CONNECT " + b"x" * 5000):
            with socket.create_connection(where) as bad:
                bad.sendall(garbage)
                bad.shutdown(socket.SHUT_WR)
                while bad.recv(4096):
                    pass
        with socket.create_connection(where) as bad:  # dies in the middle of a message
            bad.sendall(hello("tcp", "/bad") + b"YA\n\0\0\0RP\2\1")
            bad.recv(8)
        until(lambda: len(source.lost) == 3)
        good.send(BOTTLE)
        assert source.take(5).data == BOTTLE
        assert set(source.lost) == {
            "the stream is out of step: no YARP number where one belongs",
            "no end of line within 1000 bytes",
            "the connection ended in the middle of a message",
        }


def test_a_connection_that_says_nothing_is_closed(at, names, monkeypatch):
    monkeypatch.setattr("rosetta_jit.transports.yarp.incoming.HELLO_S", 0.05)
    with rj.subscribe(at("/in", "&open=yes")) as source, socket.create_connection(("127.0.0.1", int(names.ports["/in"][1]))) as silent:
        silent.settimeout(5)
        assert silent.recv(1) == b""
        until(lambda: source.lost == {"a connection that said nothing": 1})


def test_a_hundred_writers_at_once(at, names):
    with rj.subscribe(at("/in", "&open=yes")) as source:
        where = ("127.0.0.1", int(names.ports["/in"][1]))
        peers = [socket.create_connection(where) for _ in range(100)]
        for number, each in enumerate(peers):
            each.sendall(hello("fast_tcp", f"/w{number}"))
        until(lambda: source.connections == 100)
        for each in peers:
            each.close()
        until(lambda: not source.connections)


def test_a_slow_reader_loses_its_own_messages_with_a_counter(at, names):
    slow = socket.create_server(("127.0.0.1", 0))
    names.ports["/slow"] = "127.0.0.1", str(slow.getsockname()[1])
    with slow, rj.publish(at("/out", "&linger=0")) as sink, rj.subscribe(at("/out", "&queue=100")) as quick:
        assert ask_port(contact(names, "/out"), '[add] "tcp://slow"', 2).startswith("0 ")
        until(lambda: sink.connections == 2)
        for _ in range(30):
            assert sink.send(bytes(1 << 20))
            assert len(quick.take(5).data) == 1 << 20
        assert sink.lost == {"the reader is too slow": 15}


def test_a_reader_that_dies_with_messages_on_the_way_is_counted(at, names):
    dying = socket.create_server(("127.0.0.1", 0))
    names.ports["/dying"] = "127.0.0.1", str(dying.getsockname()[1])
    with dying, rj.publish(at("/dying", "&open=no")) as sink:
        peer, _ = dying.accept()
        peer.sendall(b"YA\1\0\0\0RP")
        until(lambda: sink.connections)
        for _ in range(3):
            sink.send(BOTTLE)
        peer.close()
        until(lambda: sink.lost)
        assert sink.lost["the reader went away"] == 3


@pytest.mark.parametrize("carrier", ["tcp", "fast_tcp"])
def test_what_waits_for_a_reader_when_the_port_closes_is_counted(at, names, carrier):
    stuck = socket.create_server(("127.0.0.1", 0))
    names.ports["/stuck"] = "127.0.0.1", str(stuck.getsockname()[1])
    with stuck, rj.publish(at("/stuck", f"&open=no&carrier={carrier}&linger=0.05")) as sink:
        peer, _ = stuck.accept()
        with peer:
            peer.sendall(b"YA\1\0\0\0RP")
            until(lambda: sink.connections)
            taken = sum(sink.send(bytes(1 << 20)) for _ in range(24))
            sink.close()
            assert 4 <= sink.lost["closed before it was sent"] <= taken


@pytest.mark.parametrize("wrong", ["icub", "/a b", '/a"b', "/a\nunregister /b", "/" + "x" * 300])
def test_names_that_ports_do_not_have(wrong):
    with pytest.raises(AddressError, match="a port's name"):
        rj.subscribe(f"yarp:{wrong}")


def test_the_users_configuration_is_read(tmp_path, monkeypatch):
    monkeypatch.setenv("YARP_CONFIG_HOME", str(tmp_path))
    assert configured() == ("127.0.0.1", 10000)
    (tmp_path / "yarp.conf").write_text("10.0.0.1 10010 yarp\n")
    assert configured() == ("10.0.0.1", 10010)
    (tmp_path / "yarp_namespace.conf").write_text("name /root\n")
    (tmp_path / "root.conf").write_text("garbage")
    assert configured() == ("127.0.0.1", 10000)
