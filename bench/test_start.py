"""What a process pays before its first message: with a warm cache, and with a cold one."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from bench.figures import Comparison, Figure, Series, Spread, ratio
from bench.messages import TYPES, joints_mapping
from bench.processes import run, took_s

FIRST_DECODE = """
import struct, sys
import rosetta_jit as rj
decode = rj.Decoder(sys.argv[1], encoding="yarp3")
decode(struct.pack("<ii24d", 266, 24, *range(24)))
assert sys.argv[2] != "warm" or not {"numba", "lark"} & set(sys.modules)
"""

BASELINES = {
    "a process that imports nothing": "pass",
    "a process that imports numpy": "import numpy",
    "a process that imports numpy and llvmlite": "import numpy, llvmlite.binding",
    "a process that imports numba": "import numba",
}
NEEDED = "a process that imports numpy and llvmlite"
WARM, COLD = "first decode, warm cache", "first decode, nothing cached"

RESIDENT = """
import sys
from pathlib import Path
def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6
import numpy
before = resident()
exec(sys.argv[3])
print(resident() - before)
"""

COMPILES = """
import sys, time
import numpy, llvmlite.binding
for mapping in sys.argv[1:]:
    started = time.process_time()
    import rosetta_jit as rj
    rj.Decoder(mapping, encoding="yarp3")
    print(1000 * (time.process_time() - started))
"""

TYPES_COMPILE = """
import json, sys, time
import numpy, llvmlite.binding
for type, options in map(json.loads, sys.argv[1:]):
    started = time.process_time()
    import rosetta_jit as rj
    rj.Decoder.of(type, **options)
    print(1000 * (time.process_time() - started))
"""

NOTES = {"numba": "large kernels are not given to numba's own optimiser, which is why its share ends", "llvm": ""}


@pytest.fixture(scope="module")
def warm_cache(tmp_path_factory):
    """A mapping, and a cache that has it."""
    folder = tmp_path_factory.mktemp("warm")
    mapping = str(joints_mapping(24, folder))
    run("-c", FIRST_DECODE, mapping, "cold", ROSETTA_JIT_CACHE_DIR=str(folder / "cache"))
    return mapping, folder / "cache"


def test_processes(warm_cache, effort, found, record):
    mapping, cache = warm_cache
    processes = {
        WARM: lambda: took_s(FIRST_DECODE, mapping, "warm", ROSETTA_JIT_CACHE_DIR=str(cache)),
        COLD: lambda: took_s(FIRST_DECODE, mapping, "cold", ROSETTA_JIT_CACHE="off"),
        **{name: lambda program=program: took_s(program) for name, program in BASELINES.items()},
    }
    taken = in_turns(processes, 5 if effort.quick else 15)
    roles = dict.fromkeys(BASELINES, "limit")
    figures = tuple(Figure(who, roles.get(who, "ours"), "", tuple(1e9 * each for each in values)) for who, values in taken.items())
    found("comparisons", Comparison("Limits", "a process, from its start to its end", figures))
    milliseconds = 1000 * Spread.of(taken[WARM]).median
    what, unit = "fresh process to first decode, warm cache", "x importing numpy and llvmlite"
    record(what, ratio(taken[WARM], taken[NEEDED]), 1.5, unit, f"{milliseconds:.0f} ms")


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="reads the resident set from /proc")
def test_memory(warm_cache, effort, record):
    """LLVM alone is 42 MB, if it is loaded."""
    mapping, cache = warm_cache
    held = [
        float(run("-c", RESIDENT, mapping, "warm", FIRST_DECODE, ROSETTA_JIT_CACHE_DIR=str(cache))) for _ in range(3 if effort.quick else 7)
    ]
    record("memory of a process that has decoded, warm cache", Spread.of(held), None, "MB", "beyond a process that has imported numpy")


@pytest.mark.parametrize(("fields", "aim_ms"), [(10, 100), (100, 400)])
def test_compile(tmp_path, effort, record, fields, aim_ms):
    """The first one in a process pays for the compiler's import; the next one, of another mapping, for itself alone."""
    mapping, following, other = (str(joints_mapping(count, tmp_path)) for count in (fields, fields + 1, fields + 2))
    rounds = 3 if effort.quick else 7
    runs = [run("-c", COMPILES, mapping, following, ROSETTA_JIT_CACHE="off").split() for _ in range(rounds)]
    first, next_ = ([float(each[number]) for each in runs] for number in (0, 1))
    said = "numpy and llvmlite imported, nothing of ours"
    record(f"first compile in a process, {fields} fields", Spread.of(first), None, "ms", f"{said}; least {min(first):.0f} ms")
    record(f"next compile in a process, {fields} fields", Spread.of(next_), None, "ms", f"least {min(next_):.0f} ms, aim {aim_ms} ms")
    run("-c", COMPILES, other, ROSETTA_JIT_CACHE_DIR=str(tmp_path / "cache"))
    known = [_after_others(tmp_path / "cache", tmp_path / f"cache{each}", mapping)[0] for each in range(rounds)]
    what = f"first compile in a process, {fields} fields, on a machine that has compiled others"
    record(what, Spread.of(known), None, "ms", f"{said}; least {min(known):.0f} ms")


@pytest.mark.parametrize("framework", TYPES)
def test_compile_type(tmp_path, effort, record, framework):
    """The same of types without a mapping, for which nothing of the language is imported, on a machine that has compiled others."""
    *others, first, following = (json.dumps(TYPES[framework](count)) for count in (12, 13, 10, 11))
    cache = tmp_path / "cache"
    run("-c", TYPES_COMPILE, *others, ROSETTA_JIT_CACHE_DIR=str(cache))
    rounds = range(3 if effort.quick else 7)
    runs = [_after_others(cache, tmp_path / f"cache{each}", first, following, program=TYPES_COMPILE) for each in rounds]
    for number, which in enumerate(("first", "next")):
        took = [each[number] for each in runs]
        record(f"{which} compile in a process, {framework} type of 10 fields", Spread.of(took), None, "ms", f"least {min(took):.0f} ms")


def _after_others(cache, copied, *arguments, program=COMPILES):
    """Milliseconds of each compile beside what a cache has, in a copy of it: the cache has it from then on."""
    shutil.copytree(cache, copied)
    copied.chmod(0o700)
    return [float(each) for each in run("-c", program, *arguments, ROSETTA_JIT_CACHE_DIR=str(copied)).split()]


@pytest.mark.parametrize("backend", ["numba", "llvm"])
def test_cold_compile(tmp_path, effort, draw, backend):
    counts = [1, 10, 100] if effort.quick else [1, 3, 10, 30, 100, 300, 1000]
    points: dict[str, list] = {}
    for count in counts:
        mapping = str(joints_mapping(count, tmp_path))
        rounds = [json.loads(run("-m", "bench.cold_compile", mapping, backend)) for _ in range(1 if effort.quick else 3)]
        for stage in rounds[0]:
            points.setdefault(stage, []).append((count, Spread.of([each[stage] for each in rounds])))
    series = [Series(stage, "ours", tuple(each)) for stage, each in points.items() if any(cost.median for _, cost in each)]
    draw(f"cold compile in a new process, {backend}", "fields", "ms", tuple(series), parts=True, note=NOTES[backend])


def test_warm_load_against_cache_size(warm_cache, effort, draw, tmp_path):
    mapping, warm = warm_cache
    sizes = [1, 100] if effort.quick else [1, 10, 100, 1000]
    points = []
    for size in sizes:
        folder = tmp_path / f"cache{size}"
        fill(warm, folder, size)
        taken = in_turns({WARM: lambda folder=folder: took_s(FIRST_DECODE, mapping, "warm", ROSETTA_JIT_CACHE_DIR=str(folder))}, 5)
        points.append((size, Spread.of(taken[WARM]).times(1000)))
    draw("warm start against the size of the cache", "programs", "ms", (Series(WARM, "ours", tuple(points)),), may_grow=0)


def fill(warm, folder, programs):
    """A cache of so many programs: one that is asked for, and copies of it under other names."""
    shutil.copytree(warm, folder)
    folder.chmod(0o700)
    for number in range(1, programs):
        for file in warm.iterdir():
            shutil.copy(file, folder / f"{number:0{len(file.stem)}x}{file.suffix}")


def in_turns(processes, rounds):
    """Seconds of each process, by rounds; the first round, in which files are read from the disk, does not count."""
    taken = {name: [] for name in processes}
    for _ in range(1 + rounds):
        for name, process in processes.items():
            taken[name].append(process())
    return {name: values[1:] for name, values in taken.items()}
