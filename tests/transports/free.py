"""What tests of transports share: ports of this machine, waiting for what other threads do, and programs that end with their test."""

from __future__ import annotations

import socket
import subprocess
import time
from contextlib import contextmanager

GIVEN = set()
"""Ports that a test has: the system may name one again as soon as nobody listens there."""


def free_port():
    while True:
        with socket.create_server(("127.0.0.1", 0)) as found:
            port = found.getsockname()[1]
        if port not in GIVEN:
            GIVEN.add(port)
            return port


def until(condition, seconds=10.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.005)


def answers(port):
    try:
        socket.create_connection(("127.0.0.1", port), 0.2).close()
    except OSError:
        return False
    return True


@contextmanager
def running(*command, **how):
    """A program, killed at the end."""
    with subprocess.Popen(list(map(str, command)), **{"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, **how}) as program:
        try:
            yield program
        finally:
            program.kill()
