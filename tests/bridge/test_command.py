"""`rosetta-jit bridge` as people run it: signals, other files, and what becomes of its output."""

from __future__ import annotations

import fcntl
import json
import os
import pty
import signal
import subprocess
import sys
import termios
import threading
import time
import urllib.request
from pathlib import Path

import pytest

import rosetta_jit as rj
from tests.transports.free import answers, free_port, running, until


def command(path, *more):
    return [sys.executable, "-m", "rosetta_jit", "bridge", str(path), *more]


@pytest.fixture
def ways(tmp_path):
    """A file with one route from socket to socket, and the addresses of both."""
    source, target = free_port(), free_port()
    path = tmp_path / "bridge.toml"
    path.write_text(f'[bridge]\ninterval = 0.2\n[[route]]\nname = "a"\nsource = "tcp:{source}"\ntarget = "tcp:{target}"\n')
    return path, f"tcp:{source}", f"tcp:{target}"


def test_messages_on_standard_output_are_alone_there(tmp_path):
    (tmp_path / "in").write_bytes(b"\3\0\0\0abc\3\0\0\0def")
    (tmp_path / "bridge.toml").write_text(f'[[route]]\nname = "a"\nsource = "pipe:{tmp_path}/in"\ntarget = "pipe:-"\n')
    found = subprocess.run(command(tmp_path / "bridge.toml", "--json", "--seconds", "0.2"), capture_output=True, check=True, timeout=20)
    assert found.stdout == b"\3\0\0\0abc\3\0\0\0def"
    assert json.loads(found.stderr.splitlines()[-1])["routes"][0]["sent"] == 2


def test_from_start_to_stop(ways):
    """A file, a wrong one, another one, an end."""
    path, source, target = ways
    with (
        rj.subscribe(target) as there,
        running(*command(path, "--json"), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as program,
    ):
        with rj.publish(source) as robot:
            robot.send(b"1")
            assert there.take(20).data == b"1"
        assert json.loads(program.stdout.readline())["routes"][0]["route"] == "a"
        path.write_text(path.read_text().replace("source", "suorce"))
        os.kill(program.pid, signal.SIGHUP)
        said = program.stderr.readline()
        while "all goes on as before" not in said:
            said = program.stderr.readline()
        metrics = free_port()
        path.write_text(path.read_text().replace("suorce", "source").replace("[bridge]", f'[bridge]\nmetrics = "{metrics}"'))
        os.kill(program.pid, signal.SIGHUP)
        until(lambda: answers(metrics))  # where the new file says
        with urllib.request.urlopen(f"http://127.0.0.1:{metrics}/metrics") as answer:
            assert b'messages_sent_total{route="a"} 1' in answer.read()
        threading.Timer(0.3, program.send_signal, (signal.SIGTERM,)).start()
        out, _ = program.communicate(timeout=20)
        assert json.loads(out.splitlines()[-1])["routes"][0]["sent"] == 1
        assert program.returncode == 0


def carries(source, target):
    """Whether a message goes from one end to the other."""
    with rj.subscribe(target) as there, rj.publish(source, wait=True) as robot:
        until(lambda: robot.connections and there.connections, 20)
        robot.send(b"1")
        return there.take(20).data == b"1"


def test_it_goes_on_where_nobody_can_read_what_it_prints(ways):
    path, source, target = ways
    with Path("/dev/full").open("w") as full, running(*command(path, "--json"), stdout=full, stderr=subprocess.PIPE) as program:
        assert carries(source, target)
        time.sleep(0.3)  # the table has been printed since, or was to be
        assert carries(source, target)
        program.terminate()
        assert b"not everything could be printed: No space left on device" in program.communicate(timeout=20)[1]
        assert program.returncode == 1


def test_it_ends_in_order_with_its_terminal(ways):
    path, source, target = ways
    ours, theirs = pty.openpty()
    at_it = {"stdin": theirs, "stdout": theirs, "stderr": theirs, "start_new_session": True}
    with running(*command(path), **at_it, preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0)) as program:
        os.close(theirs)
        assert carries(source, target)
        os.close(ours)
        assert program.wait(20) == 0
