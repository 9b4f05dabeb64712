"""What a process pays before its first message: with a warm cache, and with a cold one."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time

import pytest

from bench.messages import joints_mapping

ROUNDS = 11

SURROUNDINGS = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
"""Our modules are compiled to bytecode once, as an installer has done with numpy's and llvmlite's."""

FIRST_DECODE = """
import struct, sys
import rosetta_jit as rj
decode = rj.Decoder(sys.argv[1], encoding="yarp3")
decode(struct.pack("<ii24d", 266, 24, *range(24)))
assert sys.argv[2] != "warm" or not {"numba", "lark"} & set(sys.modules)
"""

BASELINE = "import numpy, llvmlite.binding"

FIRST_COMPILE = """
import sys, time
import numba
import rosetta_jit as rj
started = time.perf_counter()
rj.Decoder(sys.argv[1], encoding="yarp3")
print(time.perf_counter() - started)
"""


def test_warm_start_against_importing_what_it_needs(tmp_path, record):
    mapping = str(joints_mapping(24, tmp_path))
    environment = {**SURROUNDINGS, "ROSETTA_JIT_CACHE_DIR": str(tmp_path / "cache")}
    run(environment, FIRST_DECODE, mapping, "cold")
    times = {"warm": [], "baseline": []}
    for _ in range(ROUNDS):
        times["warm"].append(run(environment, FIRST_DECODE, mapping, "warm"))
        times["baseline"].append(run(environment, BASELINE))
    warm, baseline = (statistics.median(times[name]) for name in ("warm", "baseline"))
    record("fresh process to first decode, warm cache", warm / baseline, 1.5, "x importing numpy and llvmlite", f"{1000 * warm:.0f} ms")


@pytest.mark.parametrize(("fields", "aim_ms"), [(10, 60), (100, 250)])
def test_first_compile(tmp_path, record, fields, aim_ms):
    mapping = str(joints_mapping(fields, tmp_path))
    environment = {**SURROUNDINGS, "ROSETTA_JIT_CACHE": "off"}
    command = [sys.executable, "-c", FIRST_COMPILE, mapping]
    best = min(float(subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout) for _ in range(3))
    record(f"first compile, {fields} fields, numba imported", 1000 * best, None, "ms", f"aim {aim_ms} ms")


def run(environment: dict[str, str], program: str, *arguments: str) -> float:
    started = time.perf_counter()
    subprocess.run([sys.executable, "-c", program, *arguments], env=environment, check=True)
    return time.perf_counter() - started
