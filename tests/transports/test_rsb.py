"""The bus on loopback, served and joined; `localhost` and `127.0.0.1` are two buses of one process, which meet over a socket."""

from __future__ import annotations

import json
import socket
import struct
import time
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import AddressError, TransportError
from rosetta_jit.transports.rsb.notification import Event, EventId, decode, encode
from tests.transports.free import free_port, until

LIVE = json.loads((Path(__file__).resolve().parent.parent / "vectors" / "rsb" / "live.json").read_text())
CAPTURES = {each["name"]: each for each in LIVE["captures"]}
PROBES = {each["name"]: each for each in LIVE["probes"]}


@pytest.fixture
def bus():
    """Addresses of who serves the bus, and of who joins it."""
    port = free_port()
    return (
        lambda scope, more="": f"rsb:{scope}?port={port}{more}",
        lambda scope, more="": f"rsb:{scope}?host=localhost&port={port}{more}",
        port,
    )


def join(port):
    """A connection to the bus, as a real client makes one."""
    sock = socket.create_connection(("127.0.0.1", port), 5)
    assert sock.recv(4, socket.MSG_WAITALL) == bytes(4)
    return sock


def read(sock, count):
    frames = []
    for _ in range(count):
        (size,) = struct.unpack("<I", sock.recv(4, socket.MSG_WAITALL))
        frames.append(sock.recv(size, socket.MSG_WAITALL))
    return frames


def test_events_go_both_ways_and_to_scopes_above(bus):
    server, client, _ = bus
    with rj.subscribe(server("/arm"), queue=10) as above, rj.publish(client("/arm/left", "&type=utf-8-string")) as sink:
        with rj.subscribe(client("/arm/left/hand")) as below, rj.publish(server("/arm/left/", "&type=double")) as back:
            sink.send(b"there", time=1_700_000_000_123_456_789, attributes={"user_infos": {"a": "1"}, "user_times": {"t": 5}})
            one = above.take(5)
            assert (one.data, one.channel, one.type, one.attributes["create_time"]) == (
                b"there",
                "/arm/left/",
                "utf-8-string",
                1_700_000_000_123_456_000,
            )
            assert (one.attributes["user_infos"], one.attributes["user_times"], one.attributes["method"]) == ({"a": "1"}, {"t": 5}, "")
            assert abs(one.sent - one.time) < 10**10
            back.send(b"12345678", attributes={"scope": "/arm/left/hand", "causes": [one.attributes["id"]]})
            two = below.take(5)
            assert (two.data, two.type, two.attributes["causes"]) == (b"12345678", "double", [one.attributes["id"]])
            assert above.take(5).data == b"12345678"  # also in the process that sends
        sink.send(b"again")
        assert above.take(5).attributes["id"].sequence == 1
        assert not above.lost
        assert not sink.lost


def test_events_are_passed_on_to_the_others_as_they_are(bus):
    """As rsb-python's server does: to every other connection, and not back."""
    server, _, port = bus
    zero, one = CAPTURES["relay_two_clients.conn0"], CAPTURES["relay_two_clients.conn1"]
    with rj.subscribe(server("/")) as source, join(port) as first, join(port) as second:
        until(lambda: source.connections == 2)
        first.sendall(bytes.fromhex(zero["c2s"]))
        second.sendall(bytes.fromhex(one["c2s"]))
        for sock, wanted in ((first, zero), (second, one)):
            passed = bytes.fromhex(wanted["s2c"])[4:]
            assert sock.recv(len(passed), socket.MSG_WAITALL) == passed
        assert {source.take(5).channel, source.take(5).channel} == {"/relay/a/", "/relay/b/"}
        for sock in (first, second):
            sock.shutdown(socket.SHUT_WR)
            assert sock.recv(1) == b""


def test_events_that_end_other_peers_are_not_passed_on(bus):
    """What rsb-cpp terminates of, or rsb-python closes its connection of: the events behind each of them are passed on."""
    server, _, port = bus
    names = ["no scope", "scope with a space", "scope with an empty component", "no wire schema", "sender id empty", "frame of garbage"]
    with rj.subscribe(server("/none")) as source, join(port) as first, join(port) as second:
        until(lambda: source.connections == 2)
        for name in names:
            first.sendall(bytes.fromhex("".join(PROBES[name]["sent_hex"]) + PROBES[name]["then_sent_hex"]))
        assert [bytes(decode(memoryview(each)).data) for each in read(second, len(names))] == [b"AFTER"] * len(names)
        assert source.lost.total() == len(names)


@pytest.mark.parametrize("name", ["string_s2c", "shutdown_by_server", "uint64_s2c"])
def test_a_client_reads_what_a_real_server_sent(bus, name):
    _, _, port = bus
    stream = bytes.fromhex(CAPTURES[name]["s2c"])
    with socket.create_server(("127.0.0.1", port)) as real, rj.subscribe(f"rsb:/?port={port}&role=client&patient=yes") as source:
        peer, _ = real.accept()
        with peer:
            for at in range(len(stream)):  # a byte a segment, also of the handshake
                peer.sendall(stream[at : at + 1])
            sent = [each for each in CAPTURES[name]["events"] if each["direction"] == "s2c"]
            for each in sent:
                message = source.take(5)
                assert (message.channel, message.type) == (each["scope"], each["wire_schema"])
            peer.shutdown(socket.SHUT_WR)
            assert peer.recv(1) == b""
        assert not source.lost


def test_callers_of_rsb_cpp_get_their_answers(bus):
    server, _, port = bus
    answers = {"/calc/echo": lambda message: message.data, "/calc/fail": lambda _: 1 // 0, "/calc/nothing": lambda _: None}
    requests = bytes.fromhex(CAPTURES["rpc_cpp_caller"]["c2s"])
    with (
        rj.serve(server("/calc/echo", "&type=utf-8-string"), answers["/calc/echo"]),
        rj.serve(server("/calc/fail"), answers["/calc/fail"]),
        rj.serve(server("/calc/nothing"), answers["/calc/nothing"]),
        join(port) as caller,
    ):
        caller.sendall(requests)
        replies = [decode(memoryview(each)) for each in read(caller, 3)]
    asked, rest = [], requests
    while rest:
        size = struct.unpack_from("<I", rest)[0]
        asked.append(decode(memoryview(rest[4 : 4 + size])))
        rest = rest[4 + size :]
    by_cause = {each.causes[0]: each for each in replies}
    assert all(len(each.causes) == 1 and each.method == "REPLY" for each in replies)
    found = {each.scope: by_cause[each.id] for each in asked}
    assert (bytes(found["/calc/echo/"].data), found["/calc/echo/"].schema) == (bytes(asked[0].data), "utf-8-string")
    assert (found["/calc/nothing/"].schema, bytes(found["/calc/nothing/"].data)) == ("void", b"")
    assert found["/calc/fail/"].user_infos == {"rsb:error?": "1"}
    assert b"ZeroDivisionError" in bytes(found["/calc/fail/"].data)


def test_servers_of_rsb_cpp_are_asked(bus):
    """Its three captured replies, with the causes that the requests have now."""
    _, _, port = bus
    stream, replies = bytes.fromhex(CAPTURES["rpc_cpp_server_as_tcp_server"]["s2c"])[4:], {}
    while stream:
        size = struct.unpack_from("<I", stream)[0]
        event = decode(memoryview(stream[4 : 4 + size]))
        if event.method == "REPLY":
            replies[event.scope] = event
        stream = stream[4 + size :]
    with socket.create_server(("127.0.0.1", port)) as real:
        address = f"?port={port}&role=client&patient=yes&type=utf-8-string"
        with rj.call(f"rsb:/calc/echo{address}") as echo, rj.call(f"rsb:/calc/fail{address}") as fail:
            peer, _ = real.accept()
            with peer:
                peer.sendall(bytes(4))
                until(lambda: echo.connections)

                def answered(ask):
                    from threading import Thread

                    outcome = []

                    def work():
                        try:
                            outcome.append(ask(b"hi"))
                        except TransportError as error:
                            outcome.append(error)

                    thread = Thread(target=work)
                    thread.start()
                    request = decode(memoryview(read(peer, 1)[0]))
                    assert request.method == "REQUEST"
                    reply = b"".join(map(bytes, encode(replies[request.scope]._replace(causes=[request.id]))))
                    peer.sendall(struct.pack("<I", len(reply)) + reply)
                    thread.join(5)
                    return outcome[0]

                assert bytes(answered(echo).data) == bytes(replies["/calc/echo/"].data)
                failed = answered(fail)
                assert failed.kind == "refused"
                assert str(replies["/calc/fail/"].data, "utf-8") in failed.detail


def test_a_call_that_nobody_answers_ends_in_time(bus):
    server, client, _ = bus
    with rj.subscribe(server("/")), rj.call(client("/nobody")) as ask, pytest.raises(TransportError, match="no answer came in time"):
        ask(b"", timeout=0.1)


@pytest.mark.parametrize("name", PROBES)
def test_bad_events_are_dropped_counted_and_cost_no_connection(bus, name):
    server, _, port = bus
    probe = PROBES[name]
    with rj.subscribe(server("/")) as source, join(port) as peer:
        for each in probe["sent_hex"]:
            peer.sendall(bytes.fromhex(each))
        peer.sendall(bytes.fromhex(probe["then_sent_hex"]))
        if name == "frame of size 0":
            assert peer.recv(1) == b""
            return
        message = source.take(5)
        while message.data != b"AFTER":
            message = source.take(5)
        assert message.channel == "/probe/"
        dropped = name.startswith(
            ("no scope", "scope with a", "scope without the first", "sender id", "no event_id", "frame of garbage", "a Frag")
        )
        assert bool(source.lost) == dropped


def test_what_would_end_other_peers_is_not_sent(bus):
    server, _, _ = bus
    with rj.publish(server("/a")) as sink:
        with pytest.raises(TransportError, match="wire schema"):
            sink.send(b"x")
        for wrong in ({"scope": "/b"}, {"scope": "/a b"}, {"user_infos": {"ä": "1"}}, {"method": "ä"}):
            with pytest.raises(TransportError, match="refused"):
                sink.send(b"x", attributes={"type": "bytes", **wrong})


def test_who_joins_serves_the_bus_when_its_server_is_gone(bus):
    server, client, _ = bus
    first = rj.subscribe(server("/"))
    with rj.publish(client("/a", "&type=bytes")) as sink:
        until(lambda: sink.connections)
        first.close()
        until(lambda: sink.bus.is_server)
        with rj.subscribe(server("/a", "&role=client")) as late:
            until(lambda: sink.connections)
            sink.send(b"x")
            assert late.take(5).data == b"x"


def test_a_client_joins_again(bus):
    server, client, _ = bus
    with rj.subscribe(client("/", "&role=client&patient=yes")) as source:
        for number in range(2):
            with rj.publish(server("/a", "&role=server&type=bytes")) as sink:
                until(lambda: sink.connections)
                sink.send(bytes([number]))
                assert source.take(5).data == bytes([number])
            until(lambda: not source.connections)
        assert source.reconnects == 1


def test_ports_that_are_taken_and_buses_that_are_none(bus):
    server, _, port = bus
    with socket.create_server(("127.0.0.1", port)) as other:
        with pytest.raises(TransportError, match="another program listens there"):
            rj.subscribe(server("/", "&role=server"))
        other.settimeout(5)
        with pytest.raises(TransportError, match="no bus of RSB answers there"):
            rj.subscribe(server("/", "&timeout=0.1"))
    with pytest.raises(TransportError, match="no bus of RSB answers there"):
        rj.subscribe(server("/", "&role=client&timeout=0.1"))
    with pytest.raises(AddressError, match="a scope"):
        rj.subscribe(server("/a b"))


def event_of(data):
    parts = b"".join(map(bytes, encode(Event(EventId(bytes(16), 0), "/p/", "bytes", data))))
    return struct.pack("<I", len(parts)) + parts


def test_a_peer_that_dies_in_the_middle_and_one_that_reads_nothing(bus):
    server, _, port = bus
    with rj.subscribe(server("/")) as source, rj.publish(server("/big", "&type=bytes&timeout=0&linger=0")) as sink:
        with join(port) as bad:
            bad.sendall(event_of(b"x" * 100)[:50])
        until(lambda: source.lost)
        assert source.lost == {"the connection ended in the middle of a message": 1}
        with join(port):
            until(lambda: sink.connections == 1)
            began = time.monotonic()
            taken = sum(sink.send(bytes(1 << 20)) for _ in range(40))
            assert time.monotonic() - began < 3
            assert sink.lost == {"the connection ended in the middle of a message": 1, "the peer is too slow": 40 - taken}
            assert taken < 30
        until(lambda: not sink.connections)
        assert 10 <= sink.lost["the peer went away"] <= taken  # what waited for it
        assert source.lost == {"the connection ended in the middle of a message": 1}


def test_what_waits_when_the_bus_closes_is_counted(bus):
    server, _, port = bus
    with rj.publish(server("/big", "&type=bytes&timeout=0&linger=0.05")) as sink, join(port):
        until(lambda: sink.connections)
        taken = sum(sink.send(bytes(1 << 20)) for _ in range(24))
        sink.close()
        assert 4 <= sink.lost["closed before it was sent"] <= taken


def test_what_is_passed_on_and_waits_for_a_peer_that_goes_is_counted(bus):
    server, _, port = bus
    with rj.subscribe(server("/p")) as source, join(port) as sender:
        with join(port):
            until(lambda: source.connections == 2)
            for _ in range(24):
                sender.sendall(event_of(bytes(1 << 20)))
            until(lambda: source.messages == 24)
        until(lambda: source.connections == 1)
        assert 4 <= source.lost["the peer went away"] <= 24


def test_a_hundred_clients_at_once(bus):
    server, _, port = bus
    with rj.subscribe(server("/"), queue=100) as source:
        peers = [join(port) for _ in range(100)]
        until(lambda: source.connections == 100)
        peers[0].sendall(event_of(b"to all"))
        assert source.take(5).data == b"to all"
        for each in peers[1:]:
            assert b"to all" in read(each, 1)[0]
        for each in peers:
            each.close()
        until(lambda: not source.connections)
