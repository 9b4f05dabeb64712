"""Run as a program: the kilobytes that each further decoder of a mapping of its own takes of this new process.

`python -m bench.decoder_memory FOLDER COUNT`. What counts is what no other process shares: the slope of a line through the private, written
pages, after the first decoders, which pay for what all use. One difference of two readings would be that of the allocator's mood.
"""

from __future__ import annotations

import ctypes
import gc
import statistics
import sys
from pathlib import Path

import rosetta_jit as rj
from bench.messages import joints_mapping

FIRST = 30
"""Doubles of the first mapping; each has one more than the one before."""

STEP = 5
"""Decoders between two readings."""


def main(folder: Path, count: int) -> float:
    decoders: list[object] = []
    readings: list[tuple[int, float]] = []
    for number in range(count):
        decoders.append(rj.Decoder(joints_mapping(FIRST + number, folder), encoding="yarp3"))
        if number % STEP == STEP - 1:
            readings.append((len(decoders), private_kb()))
    xs, ys = zip(*readings[len(readings) // 4 :], strict=True)
    return statistics.linear_regression(xs, ys).slope


def private_kb() -> float:
    """Kilobytes of this process that no other shares, without what it has given up."""
    gc.collect()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # glibc's
    if trim is not None:
        trim(0)
    lines = Path("/proc/self/smaps_rollup").read_text("utf-8").splitlines()
    return sum(int(line.split()[1]) * 1.024 for line in lines if line.startswith("Private_Dirty:"))


if __name__ == "__main__":
    sys.stdout.write(f"{main(Path(sys.argv[1]), int(sys.argv[2]))}\n")
