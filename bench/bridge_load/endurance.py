"""What a bridge takes while it runs for long."""

from __future__ import annotations

import socket
import sys
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import rosetta_jit as rj
from bench.bridge_load.processes import MAPPED, TORSO, Arrived, Lines, connected, cpu_s, framed, free_ports, running

PROBES = 21
"""Messages by which a sample measures how long one takes."""


class Sample(NamedTuple):
    """What the bridge of a soak takes at one moment, and how long messages take."""

    passed_s: float
    memory_kb: int
    files: int
    threads: int
    sent: int
    cpu_s: float
    latency_us: float


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
        lines = Lines(program)
        arrived, message = Arrived([listener.accept()[0]]), framed(bottle)
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


def _probe(sender: socket.socket, message: bytes, arrived: Arrived, sent: int, size: int) -> tuple[float, int]:
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
    return Sample(passed, int(told["VmRSS"].split()[0]), files, int(told["Threads"]), sent, cpu_s(pid), latency_us)


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
