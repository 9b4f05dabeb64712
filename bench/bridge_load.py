"""`python -m bench.bridge_load latency | topics | images | soak`: what a running bridge adds, and what it carries.

The bridge is a process of its own, pinned to one core; who sends and who receives are plain sockets in another process.
"""

from __future__ import annotations

import argparse
import json
import os
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import rosetta_jit as rj

if TYPE_CHECKING:
    from collections.abc import Generator

TORSO = "yarp/icub/torso_state.mapping"
MAPPED = f'mapping = "{TORSO}"\ndecode = {{ encoding = "yarp4" }}\n'
COPY = """
import socket, sys
source, target = socket.create_server(("127.0.0.1", int(sys.argv[1]))), socket.create_connection(("127.0.0.1", int(sys.argv[2])))
target.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
connection, _ = source.accept()
while data := connection.recv(65536):
    target.sendall(data)
"""
"""What a bridge is compared with: the same bytes from one socket to another, in Python."""


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


def latencies(source: int, accepted: socket.socket, message: bytes, size: int, count: int) -> np.ndarray:
    """How long each of so many messages takes to get there, in microseconds; one after the other."""
    sender, found = connected(source), np.empty(count)
    with sender:
        for number in range(count):
            begun = time.perf_counter_ns()
            sender.sendall(message)
            left = size
            while left:
                left -= len(accepted.recv(left))
            found[number] = (time.perf_counter_ns() - begun) / 1000
            time.sleep(0.0005)
    return found


def latency(count: int = 3000) -> dict[str, Any]:
    """What a mapped message takes from socket to socket, beside the same bytes copied by Python: p50 and p99 in microseconds."""
    bottle = rj.Encoder(TORSO, encoding="yarp4")({"angles": [0.1, 0.2, 0.3]})
    answer = len(framed(rj.Bridge(TORSO, decode={"encoding": "yarp4"})(bottle)))
    found: dict[str, list[np.ndarray]] = {"bridge": [], "copy": []}
    for _ in range(3):
        for kind, size in (("copy", len(framed(bottle))), ("bridge", answer)):
            source, target = free_ports(2)
            with socket.create_server(("127.0.0.1", target)) as listener:
                route = f'[[route]]\nsource = "tcp:{source}"\ntarget = "tcp:{target}"\n{MAPPED}'
                command = [sys.executable, "-c", COPY, str(source), str(target)]
                with running(route, pinned=False) if kind == "bridge" else subprocess.Popen(command) as program:
                    accepted, _ = listener.accept()
                    found[kind].append(latencies(source, accepted, framed(bottle), size, count // 3)[50:])
                    accepted.close()
                    program.terminate()
    both = {kind: np.concatenate(each) for kind, each in found.items()}
    shown: dict[str, Any] = {f"{kind}_p{part}_us": float(np.percentile(each, part)) for kind, each in both.items() for part in (50, 99)}
    added = {f"added_p{part}_us": shown[f"bridge_p{part}_us"] - shown[f"copy_p{part}_us"] for part in (50, 99)}
    return {**shown, **added}


def topics(count: int = 100, rate: int = 1000, seconds: float = 10.0) -> dict[str, Any]:
    """So many topics of 200 bytes at a rate, mapped: what arrives, and how much of a core the bridge takes."""
    bottle = rj.Encoder.of("yarp.sig.Vector", encoding="yarp4", imports=["yarp/sig/Vector.bottle-schema"])({"values": [0.5] * 24})
    message = framed(bottle)
    ports = free_ports(2 * count)
    routes = "".join(
        f'[[route]]\nname = "{number}"\nsource = "tcp:{one}"\ntarget = "tcp:{other}"\nbetween = ["yarp4", "yarp3"]\n'
        for number, (one, other) in enumerate(zip(ports[:count], ports[count:], strict=True))
    )
    listeners = [socket.create_server(("127.0.0.1", port)) for port in ports[count:]]
    with running(routes) as program:
        accepted = [each.accept()[0] for each in listeners]
        drain = threading.Thread(target=_drain, args=(accepted,), daemon=True)
        drain.start()
        senders = [connected(port) for port in ports[:count]]
        before, begun = _cpu_s(program.pid), time.monotonic()
        sent = 0
        while (passed := time.monotonic() - begun) < seconds:
            due = int(passed * rate) - sent // count
            if due > 0:
                for each in senders:
                    each.sendall(message * due)
                sent += due * count
            else:
                time.sleep(0.0002)
        took = time.monotonic() - begun
        time.sleep(5.0)  # what waits in sockets is to arrive
        used = _cpu_s(program.pid) - before
        last = _last(program)
    return {
        "bytes": len(bottle),
        "offered_per_s": sent / took,
        "carried_per_s": sum(each["sent"] for each in last) / took,
        "not_taken": sent - sum(each["taken"] for each in last),
        "lost": sum(sum(each["dropped"].values()) for each in last),
        "cpu_us_a_message": used / max(sent, 1) * 1e6,
        "cores": used / took,
        "p99_us": max(each["p99_us"] for each in last),
    }


def images(size: int = 1_000_000, seconds: float = 5.0) -> dict[str, Any]:
    """Images of ROS 1 that become those of ROS 2, as fast as they go: gigabytes a second, over loopback."""
    image = rj.Encoder.of("sensor_msgs/Image", encoding="ros1")({"height": 1000, "width": 1000, "step": 1000, "data": bytes(size)})
    source, target = free_ports(2)
    route = (
        f'[[route]]\nsource = "tcp:{source}"\ntarget = "tcp:{target}"\nqueue = 4\ndecode_type = "sensor_msgs/Image"\n'
        'encode_type = "sensor_msgs/msg/Image"\ndecode = { encoding = "ros1" }\nencode = { encoding = "cdr" }\n'
    )
    with socket.create_server(("127.0.0.1", target)) as listener, running(route) as program:
        accepted, _ = listener.accept()
        threading.Thread(target=_drain, args=([accepted],), daemon=True).start()
        sender, message = connected(source), framed(image)
        before, begun, sent = _cpu_s(program.pid), time.monotonic(), 0
        while time.monotonic() - begun < seconds:
            sender.sendall(message)
            sent += 1
        took = time.monotonic() - begun
        time.sleep(1.0)
        used, (last,) = _cpu_s(program.pid) - before, _last(program)
    return {
        "gigabytes_per_s": last["bytes_out"] / took / 1e9,
        "lost": sum(last["dropped"].values()),
        "cores": used / took,
        "cpu_us_an_image": used / max(last["taken"], 1) * 1e6,
        "p99_us": last["p99_us"],
    }


def soak(seconds: float = 3600.0) -> dict[str, Any]:
    """Mapped messages at a thousand a second: how the bridge's memory grows, in kilobytes, from a tenth of the time on."""
    bottle = rj.Encoder(TORSO, encoding="yarp4")({"angles": [0.1, 0.2, 0.3]})
    source, target = free_ports(2)
    route = f'[[route]]\nsource = "tcp:{source}"\ntarget = "tcp:{target}"\n{MAPPED}'
    with socket.create_server(("127.0.0.1", target)) as listener, running(route) as program:
        threading.Thread(target=_last, args=(program,), daemon=True).start()
        accepted, _ = listener.accept()
        threading.Thread(target=_drain, args=([accepted],), daemon=True).start()
        sender, message = connected(source), framed(bottle)
        begun, sent, first = time.monotonic(), 0, 0
        while (passed := time.monotonic() - begun) < seconds:
            due = int(passed * 1000) - sent
            sender.sendall(message * due)
            sent += due
            first = first or (_memory_kb(program.pid) if passed > seconds / 10 else 0)
            time.sleep(0.001)
        return {"messages": sent, "memory_kb": _memory_kb(program.pid), "grown_kb": _memory_kb(program.pid) - first}


def _drain(sockets: list[socket.socket]) -> None:
    import selectors

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
            if not count:
                chosen.unregister(connection)


def _last(program: subprocess.Popen[str]) -> list[dict[str, Any]]:
    """The counts when the bridge ends."""
    if threading.current_thread() is threading.main_thread():
        program.terminate()
    assert program.stdout is not None
    lines = program.stdout.read().splitlines()
    return json.loads(lines[-1])["routes"]


def _cpu_s(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _memory_kb(pid: int) -> int:
    return next(int(line.split()[1]) for line in Path(f"/proc/{pid}/status").read_text().splitlines() if line.startswith("VmRSS"))


WORK = {"latency": latency, "topics": topics, "images": images, "soak": soak}


def main() -> int:
    parser = argparse.ArgumentParser(prog="bench.bridge_load", description="What a running bridge adds, and what it carries.")
    parser.add_argument("work", choices=WORK)
    for name, value in WORK[parser.parse_args().work]().items():
        print(f"{name:20} {value:,.3f}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
