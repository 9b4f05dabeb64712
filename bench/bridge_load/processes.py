"""A bridge in a process of its own, and plain sockets that send to it and receive from it."""

from __future__ import annotations

import json
import os
import selectors
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Generator

TORSO = "yarp/icub/torso_state.mapping"
MAPPED = f'mapping = "{TORSO}"\ndecode = {{ encoding = "yarp4" }}\n'


def free_ports(count: int) -> list[int]:
    """Ports of this machine that nobody listens at."""
    found = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [each.getsockname()[1] for each in found]
    for each in found:
        each.close()
    return ports


@contextmanager
def running(routes: str, *, pinned: bool = True) -> Generator[subprocess.Popen[str]]:
    """A bridge in a process of its own; pinned, it has one core."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bridge.toml"
        path.write_text(f"[bridge]\ninterval = 1\n{routes}")
        command = [sys.executable, "-m", "rosetta_jit", "bridge", str(path), "--json"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as program:
            if pinned and hasattr(os, "sched_setaffinity"):
                os.sched_setaffinity(program.pid, {max(os.sched_getaffinity(0))})
            try:
                yield program
            finally:
                program.terminate()
                program.communicate(timeout=30)


@contextmanager
def before_all_others(*programs: int) -> Generator[bool]:
    """Let no other program of the machine have the processor while these are ready, until the block ends; whether we may."""
    threads = [int(each.name) for program in programs for each in Path(f"/proc/{program}/task").iterdir()]
    try:
        for thread in threads:
            os.sched_setscheduler(thread, os.SCHED_FIFO, os.sched_param(20))
    except (OSError, AttributeError):
        yield False
        return
    try:
        yield True
    finally:
        for thread in threads:
            with suppress(OSError):  # it has ended
                os.sched_setscheduler(thread, os.SCHED_OTHER, os.sched_param(0))


def cpu_s(pid: int) -> float:
    """Processor time that a process has taken, in seconds."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def connected(port: int) -> socket.socket:
    """A connection to a port, as soon as somebody listens."""
    end = time.monotonic() + 60
    while True:
        try:
            made = socket.create_connection(("127.0.0.1", port))
        except OSError:
            if time.monotonic() > end:
                raise
            time.sleep(0.05)
        else:
            made.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            return made


def framed(message: bytes) -> bytes:
    """A message as it stands in a stream."""
    return struct.pack("<I", len(message)) + message


class Lines:
    """What a bridge prints, read all the time: a full pipe would stop it."""

    def __init__(self, program: subprocess.Popen[str]) -> None:
        self._last = ""
        self._thread = threading.Thread(target=self._read, args=(program,), daemon=True)
        self._thread.start()

    def _read(self, program: subprocess.Popen[str]) -> None:
        assert program.stdout is not None
        for line in program.stdout:
            self._last = line

    def last(self) -> list[dict[str, Any]]:
        """The counts of all routes when it ended."""
        self._thread.join(30)
        return json.loads(self._last)["routes"]


class Arrived:
    """Reads all that comes by some connections, until they end."""

    def __init__(self, sockets: list[socket.socket]) -> None:
        self.bytes = 0
        self.last_ns = 0
        self._thread = threading.Thread(target=self._read, args=(sockets,), daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Once the bridge has ended."""
        self._thread.join(30)

    def wait(self) -> None:
        """Until nothing has come for a second: what waits in the sockets of the bridge is to be counted."""
        before = -1
        while self.bytes != before:
            before = self.bytes
            time.sleep(1.0)

    def until(self, count: int, seconds: float) -> None:
        """Until so many bytes have come, or nothing has come for so many seconds; `last_ns` is when the last ones did."""
        before, since = self.bytes, time.monotonic()
        while self.bytes < count and time.monotonic() < since + seconds:
            time.sleep(0.0005)
            if self.bytes != before:
                before, since = self.bytes, time.monotonic()

    def _read(self, sockets: list[socket.socket]) -> None:
        chosen, buffer = selectors.DefaultSelector(), bytearray(1 << 20)
        for each in sockets:
            chosen.register(each, selectors.EVENT_READ)
        while chosen.get_map():
            for key, _ in chosen.select(1.0):
                connection = key.fileobj
                assert isinstance(connection, socket.socket)
                try:
                    count = connection.recv_into(buffer)
                except OSError:
                    count = 0
                self.last_ns = time.perf_counter_ns()
                self.bytes += count
                if not count:
                    chosen.unregister(connection)
                    connection.close()
        chosen.close()
