"""Ports of ours with YARP's own programs: yarpserver, yarp write, read, connect, rpc and rpcserver; `make yarp` builds them."""

from __future__ import annotations

import os
import subprocess
from contextlib import contextmanager

import pytest

import rosetta_jit as rj
from rosetta_jit.transports.opening import names as names_at
from rosetta_jit.transports.yarp.admin import ask_port
from rosetta_jit.transports.yarp.bottles import from_text, to_text
from rosetta_jit.transports.yarp.names import NameServer
from tests.transports.free import answers, free_port, running, until
from tests.transports.real_yarp import dialect, program

YARP, SERVER = program("yarp"), program("yarpserver")


def bottle(text):
    """A text as one of them writes it."""
    return from_text(text, dialect())


def text_of(data):
    return to_text(data, dialect())


LONG = f"7 8 9 {'x' * 150_000}"
"""More than two datagrams."""

CARRIERS = ["tcp", "fast_tcp", "udp", "mcast"]

pytestmark = pytest.mark.skipif(not (YARP and SERVER), reason="YARP's programs are not built: `make yarp`")


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """A name server of its own on loopback, and the environment in which programs find it."""
    found = place(tmp_path_factory.mktemp("yarp"))
    with serving(found):
        yield found


def place(home):
    """A port for a name server, and the environment in which programs find it there."""
    port = free_port()
    (home / "yarp.conf").write_text(f"127.0.0.1 {port} yarp\n")
    return port, {**os.environ, "YARP_CONFIG_HOME": str(home), "YARP_DATA_HOME": str(home), "HOME": str(home), "YARP_CONF": str(home)}


@contextmanager
def serving(found):
    port, env = found
    with running(SERVER, "--read", "--socket", port, "--portdb", ":memory:", "--subdb", ":memory:", env=env, cwd=env["HOME"]) as program:
        until(lambda: answers(port))
        yield program


@pytest.fixture
def at(server):
    return lambda name, more="": f"yarp:{name}?server=127.0.0.1:{server[0]}&dialect={dialect()}{more}"


def obeyed(server, *command):
    """A command of YARP succeeded: a port may be registered a moment before it listens."""
    return lambda: subprocess.run([YARP, *command], env=server[1], capture_output=True, check=False, timeout=10).returncode == 0


def registered(at, name):
    return lambda: (name, None) in names_at(at("/"))


@pytest.mark.parametrize("carrier", CARRIERS)
def test_what_yarp_writes_arrives(at, server, carrier):
    with (
        running(YARP, "write", "/w", env=server[1], stdin=subprocess.PIPE, text=True) as writer,
        rj.subscribe(at("/w", f"&carrier={carrier}")) as source,
    ):
        until(lambda: source.connections)
        until(lambda: ask_port(NameServer("127.0.0.1", server[0]).query("/w"), "[list] [out]", 2.0).strip())  # by mcast a little later
        for line in ("1 2 3", 'hello 2.5 "a b" [set] (1 (2.5 x))', LONG):
            writer.stdin.write(f"{line}\n")
            writer.stdin.flush()
            message = source.take(5)
            assert message.data == bottle(line)
            assert message.attributes == {"sender": "/w", "carrier": carrier}
        source.close()
        writer.stdin.close()
        assert writer.wait(5) == 0


def test_yarp_writes_as_text_to_a_port_of_ours(at, server):
    with (
        rj.subscribe(at("/r", "&open=yes")) as source,
        running(YARP, "write", "/w", env=server[1], stdin=subprocess.PIPE, text=True) as writer,
    ):
        until(registered(at, "/w"))
        for carrier in ("text", "text_ack"):
            until(obeyed(server, "connect", "/w", "/r", carrier))
            until(lambda: source.connections)
            writer.stdin.write("1 2.5 hello\n")
            writer.stdin.flush()
            message = source.take(5)
            assert (message.data, message.attributes["carrier"]) == (bottle("1 2.5 hello"), carrier)
            until(obeyed(server, "disconnect", "/w", "/r"))
            until(lambda: not source.connections)


@pytest.mark.parametrize("carrier", CARRIERS)
def test_yarp_reads_what_is_written(at, server, carrier, tmp_path):
    with (tmp_path / "read").open("w") as printed, running(YARP, "read", "/r", env=server[1], stdout=printed) as reader:
        until(registered(at, "/r"))
        with rj.publish(at("/out")) as sink:
            until(obeyed(server, "connect", "/out", "/r", carrier))
            assert sink.connections == 1
            if carrier == "mcast":  # nothing says when the reader has joined the group
                until(lambda: sink.send(bottle("early " * 1000)) or (tmp_path / "read").stat().st_size)
            for number in range(3):
                sink.send(bottle(f"{number} 0.5 (x [set])"), time=10**18 + number)
            sink.send(bottle(LONG))
            assert sink.flush()
            until(lambda: (tmp_path / "read").stat().st_size > 140_000)  # the rest is printed at the end
        reader.terminate()
        reader.wait(5)
    lines = [each for each in (tmp_path / "read").read_text().splitlines() if each[:1].isdigit()]
    assert lines == [*(f"{number} 0.5 (x [set])" for number in range(3)), LONG]


def test_questions_go_both_ways(at, server):
    def answer(message):
        return None if text_of(message.data) == "nothing" else bottle(f"[ok] {text_of(message.data)}")

    with rj.serve(at("/srv"), answer):
        asked = subprocess.run(
            [YARP, "rpc", "/srv"], env=server[1], input="set 1.5\nnothing\nget\n", capture_output=True, text=True, timeout=10, check=False
        )
        assert asked.stdout.splitlines() == ["Response: [ok] set 1.5", "Response: ", "Response: [ok] get"]
    with running(YARP, "rpcserver", "/rs", env=server[1], stdin=subprocess.PIPE, text=True) as program:
        until(registered(at, "/rs"))
        program.stdin.write("fine 2.5 (1 2)\n")
        program.stdin.flush()
        with rj.call(at("/rs")) as ask:
            assert text_of(ask(bottle("how are you")).data) == "fine 2.5 (1 2)"


def test_ports_answer_commands(at, server):
    def said(*command, **how):
        return subprocess.run([YARP, *command], env=server[1], capture_output=True, text=True, timeout=10, check=True, **how).stdout

    with rj.publish(at("/out")), rj.subscribe(at("/out")):
        assert "/out" in said("ping", "/out")
        assert said("exists", "/out") == ""
        lines = said("admin", "rpc", "/out", input="[ver]\n[list] [in]\n[nonsense]\n").splitlines()
        assert lines[:2] == ["Response: [ver] 1 2 3", "Response: anon_rpc"]
        assert lines[2].startswith("Response: [fail]")


def test_a_reader_that_is_killed_costs_nobody_else(at, server):
    with rj.publish(at("/out")) as sink, rj.subscribe(at("/out")) as source:
        with running(YARP, "read", "/killed", env=server[1]):
            until(obeyed(server, "connect", "/out", "/killed"), 20)
            until(lambda: sink.connections == 2)
            sink.send(b"1")
            assert source.take(5).data == b"1"
        for _ in range(20):
            sink.send(bottle("2"))
            assert source.take(5) is not None
        until(lambda: sink.connections == 1)


def test_a_name_server_that_is_started_again_gets_to_know_the_ports(tmp_path, monkeypatch):
    monkeypatch.setattr("rosetta_jit.transports.yarp.port.HEARTBEAT_S", 0.1)
    found = place(tmp_path)
    here = f"?server=127.0.0.1:{found[0]}&dialect={dialect()}"
    with serving(found) as first, rj.publish(f"yarp:/stays{here}") as sink, rj.subscribe(f"yarp:/stays{here}") as source:
        until(lambda: sink.connections)
        first.kill()
        first.wait()
        sink.send(b"meanwhile")
        assert source.take(5).data == b"meanwhile"
        with serving(found), (tmp_path / "read").open("w") as printed:
            until(lambda: ("/stays", None) in names_at(f"yarp:/{here}"))
            with running(YARP, "read", "/late", env=found[1], stdout=printed):
                until(obeyed(found, "connect", "/stays", "/late"), 20)
                sink.send(bottle("7 8"))
                until(lambda: "7 8" in (tmp_path / "read").read_text())
        assert not sink.lost
