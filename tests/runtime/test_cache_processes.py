"""Many processes share one folder: readers meet whole entries or none, whoever is killed when."""

from __future__ import annotations

import subprocess
import sys
import time

from rosetta_jit.runtime.cache.kernels import ENTRY, Cache

WRITER = """
import sys
from pathlib import Path
from rosetta_jit.runtime.cache.kernels import Cache
cache, turn = Cache(Path(sys.argv[1])), 0
print("ready", flush=True)
while True:
    turn += 1
    cache.put("shared", {"turn": turn % 251}, bytes([turn % 251]) * 300_000)
"""

COLD = """
import sys, warnings
from pathlib import Path
from rosetta_jit.runtime.cache.kernels import Cache
warnings.simplefilter("error")
cache = Cache(Path(sys.argv[1]))
for turn in range(50):
    entry = cache.get(str(turn))
    assert entry is None or entry.image == bytes([turn]) * 1000, turn
    cache.put(str(turn), {"turn": turn}, bytes([turn]) * 1000)
    assert cache.get(str(turn)).image == bytes([turn]) * 1000
"""

NAMES = """
import sys
from rosetta_jit.runtime.cache.names import entry_name, request_name
assert not {"numba", "lark", "importlib.metadata"} & set(sys.modules)
print(entry_name("a kernel"), request_name({"mapping": "a", "encoding": None}), request_name({"encoding": None, "mapping": "a"}))
"""


def test_killed_writers_leave_whole_entries(tmp_path, recwarn):
    folder, reads = tmp_path / "cache", 0
    for turn in range(20):
        writer = subprocess.Popen([sys.executable, "-c", WRITER, str(folder)], stdout=subprocess.PIPE, text=True)
        assert writer.stdout.readline() == "ready\n"
        until = time.monotonic() + 0.001 + 0.0025 * turn
        while time.monotonic() < until:
            reads += whole(Cache(folder))
        writer.kill()
        writer.wait()
        writer.stdout.close()
        reads += whole(Cache(folder))
    assert reads > 20
    assert not recwarn.list
    assert [file.name for file in Cache(folder)._own_files()] == [f"shared{ENTRY}"]


def whole(cache):
    entry = cache.get("shared")
    assert entry is None or entry.image == bytes([entry.header["turn"]]) * 300_000
    return entry is not None


def test_eight_processes_on_a_cold_cache(tmp_path):
    folder = tmp_path / "cache"
    processes = [subprocess.Popen([sys.executable, "-c", COLD, str(folder)]) for _ in range(8)]
    assert [process.wait() for process in processes] == [0] * 8
    assert Cache(folder).info().entries == 50
    assert Cache(folder).verify() == ()


def test_names_are_stable_between_processes_and_never_import_the_compiler():
    runs = [subprocess.run([sys.executable, "-c", NAMES], check=True, capture_output=True, text=True).stdout for _ in range(2)]
    assert runs[0] == runs[1]
    entry, request, reordered = runs[0].split()
    assert request == reordered != entry
