"""What a bridge adds to the time of a message."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from contextlib import ExitStack, closing
from typing import Any

import numpy as np

import rosetta_jit as rj
from bench.bridge_load.processes import MAPPED, TORSO, before_all_others, connected, framed, free_ports, running

COPY = """
import socket, sys
source, target = socket.create_server(("127.0.0.1", int(sys.argv[1]))), socket.create_connection(("127.0.0.1", int(sys.argv[2])))
target.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
connection, _ = source.accept()
while data := connection.recv(65536):
    target.sendall(data)
"""
"""What a bridge is compared with: the same bytes from one socket to another, in Python."""
PAUSE_S = 0.0005
"""Before each message; other programs have the processor's caches meanwhile."""


class Way:
    """From a sender by way of a program to a receiver, both here."""

    def __init__(self, source: int, listener: socket.socket, message: bytes, size: int) -> None:
        self._sender = connected(source)
        self._accepted, _ = listener.accept()
        self._message, self._size = message, size

    def once(self) -> float:
        """How long one message takes, in microseconds."""
        begun = time.perf_counter_ns()
        self._sender.sendall(self._message)
        left = self._size
        while left:
            left -= len(self._accepted.recv(left))
        return (time.perf_counter_ns() - begun) / 1000

    def close(self) -> None:
        self._sender.close()
        self._accepted.close()


def latencies(count: int) -> tuple[np.ndarray[tuple[int, int], np.dtype[np.float64]], bool]:
    """What messages take from socket to socket, in microseconds: a row each, mapped by a bridge, and the same bytes copied by Python.

    Both programs run all the time and are asked in turn, so that what else the machine does meets both. Where the user may say so, as root
    may, they go before all other programs, and even a loaded machine gives a 99th percentile that is theirs. The second value: whether.
    """
    bottle = rj.Encoder(TORSO, encoding="yarp4")({"angles": [0.1, 0.2, 0.3]})
    framed_bottle, answer = framed(bottle), len(framed(rj.Bridge(TORSO, decode={"encoding": "yarp4"})(bottle)))
    ports = free_ports(4)
    route = f'[[route]]\nsource = "tcp:{ports[0]}"\ntarget = "tcp:{ports[1]}"\n{MAPPED}'
    command = [sys.executable, "-c", COPY, str(ports[2]), str(ports[3])]
    found = np.empty((count, 2))
    with ExitStack() as stack:
        listeners = [stack.enter_context(socket.create_server(("127.0.0.1", port))) for port in ports[1::2]]
        bridge = stack.enter_context(running(route, pinned=False))
        copying = stack.enter_context(subprocess.Popen(command))
        stack.callback(copying.terminate)
        ways = [
            stack.enter_context(closing(Way(source, listener, framed_bottle, size)))
            for source, listener, size in zip(ports[::2], listeners, (answer, len(framed_bottle)), strict=True)
        ]
        is_first = stack.enter_context(before_all_others(os.getpid(), bridge.pid, copying.pid))
        for number in range(-100, count):
            for which in (0, 1) if number % 2 else (1, 0):
                took = ways[which].once()
                if number >= 0:
                    found[number, which] = took
                time.sleep(PAUSE_S)
    return found, is_first


def latency(count: int = 3000) -> dict[str, Any]:
    """The 50th and the 99th percentile of messages that are mapped and of those that are copied, and what is added."""
    found, is_first = latencies(count)
    shown: dict[str, Any] = {"before_all_others": is_first}
    for part in (50, 99):
        mapped, copied = np.percentile(found, part, axis=0).tolist()
        shown |= {f"bridge_p{part}_us": mapped, f"copy_p{part}_us": copied, f"added_p{part}_us": mapped - copied}
    return shown
