"""`python -m bench.bridge_load latency | topics | images | shared | soak`: what a running bridge adds, and what it carries.

The bridge is a process of its own, pinned to one core; who sends and who receives are plain sockets in another process.
"""

from __future__ import annotations

import argparse
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
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

import rosetta_jit as rj

if TYPE_CHECKING:
    from collections.abc import Generator

TORSO = "yarp/icub/torso_state.mapping"
MAPPED = f'mapping = "{TORSO}"\ndecode = {{ encoding = "yarp4" }}\n'
IMAGES = """decode_type = "sensor_msgs/Image"
encode_type = "sensor_msgs/msg/Image"
decode = { encoding = "ros1" }
encode = { encoding = "cdr" }
"""
IMAGES_AT_ONCE = 4
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


def latency(count: int = 3000) -> dict[str, Any]:
    """What a mapped message takes from socket to socket, beside the same bytes copied by Python: p50 and p99 in microseconds.

    Both programs run all the time and are asked in turn, so that what else the machine does meets both. Where the user may say so, as root
    may, they go before all other programs; then even a loaded machine gives a 99th percentile that is theirs.
    """
    bottle = rj.Encoder(TORSO, encoding="yarp4")({"angles": [0.1, 0.2, 0.3]})
    framed_bottle, answer = framed(bottle), len(framed(rj.Bridge(TORSO, decode={"encoding": "yarp4"})(bottle)))
    ports = free_ports(4)
    route = f'[[route]]\nsource = "tcp:{ports[0]}"\ntarget = "tcp:{ports[1]}"\n{MAPPED}'
    command = [sys.executable, "-c", COPY, str(ports[2]), str(ports[3])]
    with ExitStack() as stack:
        listeners = [stack.enter_context(socket.create_server(("127.0.0.1", port))) for port in ports[1::2]]
        bridge = stack.enter_context(running(route, pinned=False))
        copying = stack.enter_context(subprocess.Popen(command))
        stack.callback(copying.terminate)
        ways = [
            stack.enter_context(closing(Way(source, listener, framed_bottle, size)))
            for source, listener, size in zip(ports[::2], listeners, (answer, len(framed_bottle)), strict=True)
        ]
        is_first = _before_all_others(os.getpid(), bridge.pid, copying.pid)
        found = np.empty((count, 2))
        for number in range(-100, count):
            for which in (0, 1) if number % 2 else (1, 0):
                took = ways[which].once()
                if number >= 0:
                    found[number, which] = took
                time.sleep(0.0005)
    shown = {
        f"{kind}_p{part}_us": float(np.percentile(found[:, which], part))
        for which, kind in enumerate(("bridge", "copy"))
        for part in (50, 99)
    }
    added = {f"added_p{part}_us": shown[f"bridge_p{part}_us"] - shown[f"copy_p{part}_us"] for part in (50, 99)}
    return {**shown, **added, "before_all_others": is_first}


def _before_all_others(*programs: int) -> bool:
    """Let no other program of the machine have the processor while these are ready; whether we may."""
    try:
        for thread in (each for program in programs for each in Path(f"/proc/{program}/task").iterdir()):
            os.sched_setscheduler(int(thread.name), os.SCHED_FIFO, os.sched_param(20))
    except (OSError, AttributeError):
        return False
    return True


def topics(count: int = 100, rate: int = 1000, seconds: float = 10.0) -> dict[str, Any]:
    """So many topics of 200 bytes at a rate, mapped: what arrives, and how much of a core the bridge takes.

    The bridge goes before all other programs, where the user may say so.
    """
    bottle = rj.Encoder.of("yarp.sig.Vector", encoding="yarp4", imports=["yarp/sig/Vector.bottle-schema"])({"values": [0.5] * 24})
    message = framed(bottle)
    ports = free_ports(2 * count)
    routes = "".join(
        f'[[route]]\nname = "{number}"\nsource = "tcp:{one}"\ntarget = "tcp:{other}"\nbetween = ["yarp4", "yarp3"]\n'
        for number, (one, other) in enumerate(zip(ports[:count], ports[count:], strict=True))
    )
    with ExitStack() as stack:
        listeners = [stack.enter_context(socket.create_server(("127.0.0.1", port))) for port in ports[count:]]
        program = stack.enter_context(running(routes))
        lines = _Lines(program)
        arrived = _Arrived([each.accept()[0] for each in listeners])
        senders = [stack.enter_context(connected(port)) for port in ports[:count]]
        is_first = _before_all_others(program.pid)
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
        arrived.wait()
        used = _cpu_s(program.pid) - before
        program.terminate()
        last = lines.last()
        arrived.close()
    return {
        "bytes": len(bottle),
        "offered_per_s": sent / took,
        "carried_per_s": sum(each["sent"] for each in last) / took,
        "not_taken": sent - sum(each["taken"] for each in last),
        "lost": sum(sum(each["dropped"].values()) for each in last),
        "cpu_us_a_message": used / max(sent, 1) * 1e6,
        "cores": used / took,
        "p99_us": max(each["p99_us"] for each in last),
        "before_all_others": is_first,
    }


def images(size: int = 1_000_000, seconds: float = 5.0) -> dict[str, Any]:
    """Images of ROS 1 that become those of ROS 2, over loopback: gigabytes a second. At most four are on their way."""
    image = rj.Encoder.of("sensor_msgs/Image", encoding="ros1")({"height": 1000, "width": 1000, "step": 1000, "data": bytes(size)})
    source, target = free_ports(2)
    route = f'[[route]]\nsource = "tcp:{source}"\ntarget = "tcp:{target}"\nqueue = 4\n{IMAGES}'
    with socket.create_server(("127.0.0.1", target)) as listener, running(route) as program:
        lines = _Lines(program)
        arrived, message = _Arrived([listener.accept()[0]]), framed(image)
        with connected(source) as sender:
            is_first = _before_all_others(program.pid)
            before, begun, sent = _cpu_s(program.pid), time.monotonic(), 0
            while time.monotonic() - begun < seconds:
                if sent - arrived.bytes // len(message) < IMAGES_AT_ONCE:
                    sender.sendall(message)
                    sent += 1
                else:
                    time.sleep(0.0001)
            took = time.monotonic() - begun
            arrived.wait()
            used = _cpu_s(program.pid) - before
            program.terminate()
            (last,) = lines.last()
        arrived.close()
    return {
        "gigabytes_per_s": last["bytes_out"] / took / 1e9,
        "lost": sum(last["dropped"].values()),
        "cores": used / took,
        "cpu_us_an_image": used / max(last["taken"], 1) * 1e6,
        "p99_us": last["p99_us"],
        "before_all_others": is_first,
    }


def shared(size: int = 1_000_000, seconds: float = 5.0) -> dict[str, Any]:
    """The same images through shared memory (iceoryx2), there and back; the next one goes as soon as at most one is on its way."""
    image = rj.Encoder.of("sensor_msgs/Image", encoding="ros1")({"height": 1000, "width": 1000, "step": 1000, "data": bytes(size)})
    there, back = f"iceoryx:bench/{os.getpid()}/there?first={2 * size}", f"iceoryx:bench/{os.getpid()}/back?first={2 * size}"
    route = f'[[route]]\nsource = "{there}"\ntarget = "{back}"\n{IMAGES}'
    free, came = threading.Semaphore(2), threading.Event()

    def take(_: object) -> None:
        came.set()
        free.release()

    with running(route) as program, rj.subscribe(back, take) as source, rj.publish(there) as sink:
        lines = _Lines(program)
        while not came.is_set():
            sink.send(image)
            came.wait(0.1)
        time.sleep(1.0)
        is_first = _before_all_others(program.pid)
        free, before, first, begun, sent = threading.Semaphore(2), _cpu_s(program.pid), source.messages, time.monotonic(), 0
        while time.monotonic() - begun < seconds:
            if free.acquire(timeout=1.0):
                sink.send(image)
                sent += 1
        took = time.monotonic() - begun
        time.sleep(1.0)
        used, arrived = _cpu_s(program.pid) - before, source.messages - first
        program.terminate()
        (last,) = lines.last()
    return {
        "gigabytes_per_s": arrived * size / took / 1e9,
        "lost": sent - arrived,
        "cores": used / took,
        "cpu_us_an_image": used / max(arrived, 1) * 1e6,
        "p99_us": last["p99_us"],
        "before_all_others": is_first,
    }


class Sample(NamedTuple):
    """What the bridge of a soak takes at one moment, and how long messages take."""

    passed_s: float
    memory_kb: int
    files: int
    threads: int
    sent: int
    cpu_s: float
    latency_us: float


PROBES = 21
"""Messages by which a sample measures how long one takes."""


def soak(seconds: float = 3600.0) -> dict[str, Any]:
    """Mapped messages at a thousand a second: what the bridge takes, sampled a hundred times.

    Growth is that of a straight line through the samples behind the first tenth, over an hour; so that a short run says something, too.
    Latencies, from a socket to a socket, and processor time a message are given for the first and for the last fifth of these samples.
    """
    bottle = rj.Encoder(TORSO, encoding="yarp4")({"angles": [0.1, 0.2, 0.3]})
    size = len(framed(rj.Bridge(TORSO, decode={"encoding": "yarp4"})(bottle)))
    source, target = free_ports(2)
    route = f'[[route]]\nsource = "tcp:{source}"\ntarget = "tcp:{target}"\n{MAPPED}'
    samples: list[Sample] = []
    with ExitStack() as stack:
        listener = stack.enter_context(socket.create_server(("127.0.0.1", target)))
        program = stack.enter_context(running(route))
        lines = _Lines(program)
        arrived, message = _Arrived([listener.accept()[0]]), framed(bottle)
        sender = stack.enter_context(connected(source))
        begun, sent = time.monotonic(), 0
        while (passed := time.monotonic() - begun) < seconds:
            due = max(int(passed * 1000) - sent, 0)
            sender.sendall(message * due)
            sent += due
            if passed > len(samples) * seconds / 100:
                took, sent = _probe(sender, message, arrived, sent, size)
                samples.append(_sample(program.pid, passed, sent, took))
                if len(samples) % 10 == 0:
                    print(_shown(samples[-1]), file=sys.stderr)
            time.sleep(0.001)
        arrived.until(sent * size, 60.0)
        program.terminate()
        (last,) = lines.last()
        arrived.close()
    return {
        "seconds": seconds,
        "messages": sent,
        "not_taken": sent - last["taken"],
        "not_arrived": sent - arrived.bytes // size,
        "lost": sum(last["dropped"].values()) + sum(last["failed"].values()),
        **_over_time(samples),
        "p50_us": last["p50_us"],
        "p99_us": last["p99_us"],
    }


def _probe(sender: socket.socket, message: bytes, arrived: _Arrived, sent: int, size: int) -> tuple[float, int]:
    """The median of what some messages take, one after the other, in microseconds; and how many have been sent then."""
    arrived.until(sent * size, 5.0)
    took: list[float] = []
    for _ in range(PROBES):
        sent += 1
        begun = time.perf_counter_ns()
        sender.sendall(message)
        arrived.until(sent * size, 5.0)
        took.append((arrived.last_ns - begun) / 1000)
    return float(np.median(took)), sent


def _sample(pid: int, passed: float, sent: int, latency_us: float) -> Sample:
    """What a process takes now."""
    told = dict(line.split(":", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines())
    files = sum(1 for _ in Path(f"/proc/{pid}/fd").iterdir())
    return Sample(passed, int(told["VmRSS"].split()[0]), files, int(told["Threads"]), sent, _cpu_s(pid), latency_us)


def _shown(sample: Sample) -> str:
    used = sample.cpu_s / sample.sent * 1e6
    return (
        f"{sample.passed_s:8.0f} s  {sample.sent:10,d} messages  {sample.memory_kb:10,d} kB  {sample.files} files  {sample.threads} threads"
        f"  {used:.1f} us of processor time a message so far  {sample.latency_us:.0f} us from socket to socket"
    )


def _over_time(samples: list[Sample]) -> dict[str, float]:
    """What changed from the first to the last sample behind the first tenth."""
    behind = samples[len(samples) // 10 :]
    first, last = behind[: len(behind) // 5 + 1], behind[-len(behind) // 5 - 1 :]
    slope = float(np.polyfit([each.passed_s for each in behind], [each.memory_kb for each in behind], 1)[0])
    return {
        "first_kb": behind[0].memory_kb,
        "memory_kb": behind[-1].memory_kb,
        "grown_kb": behind[-1].memory_kb - behind[0].memory_kb,
        "growth_kb_an_hour": slope * 3600,
        "grown_files": behind[-1].files - behind[0].files,
        "grown_threads": behind[-1].threads - behind[0].threads,
        "first_latency_us": float(np.median([each.latency_us for each in first])),
        "last_latency_us": float(np.median([each.latency_us for each in last])),
        "first_cpu_us": _cpu_us(first),
        "last_cpu_us": _cpu_us(last),
    }


def _cpu_us(samples: list[Sample]) -> float:
    """Processor time a message between the first and the last of some samples."""
    return (samples[-1].cpu_s - samples[0].cpu_s) / max(samples[-1].sent - samples[0].sent, 1) * 1e6


class _Lines:
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


class _Arrived:
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


def _cpu_s(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


WORK = {"latency": latency, "topics": topics, "images": images, "shared": shared, "soak": soak}


def main() -> int:
    parser = argparse.ArgumentParser(prog="bench.bridge_load", description="What a running bridge adds, and what it carries.")
    parser.add_argument("work", choices=WORK)
    parser.add_argument("--seconds", type=float, help="how long, in place of 10 (topics), 5 (images, shared) or 3600 (soak)")
    arguments = parser.parse_args()
    if arguments.seconds is not None and arguments.work == "latency":
        parser.error("latency takes as long as its messages do")
    how = {} if arguments.seconds is None else {"seconds": arguments.seconds}
    for name, value in WORK[arguments.work](**how).items():
        print(f"{name:20} {value:,.3f}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
