"""The size bound holds although hardly a write looks at all files, whatever the file says that is looked at instead."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from rosetta_jit.runtime.cache.kernels import Cache
from rosetta_jit.runtime.cache.sealed import seal
from rosetta_jit.runtime.cache.stores import FolderStore
from rosetta_jit.runtime.cache.usage import TOTAL, USAGE
from rosetta_jit.runtime.limits import MAX_USAGE_RECORDS

SIZE = len(seal("000", {}, bytes(1000)))

FILLER = """
import sys
from pathlib import Path
from rosetta_jit.runtime.cache.kernels import Cache
cache = Cache(Path(sys.argv[1]), max_bytes=int(sys.argv[2]))
for turn in range(100):
    cache.put(f"{sys.argv[3]}{turn:02}", {}, bytes(1000))
"""


@pytest.fixture
def looks(monkeypatch):
    """How often all files of a folder were looked at."""
    seen, stored = [], FolderStore.stored
    monkeypatch.setattr(FolderStore, "stored", lambda store: seen.append(store) or stored(store))
    return seen


def fill(folder, count, max_bytes=1000 * SIZE, start=0):
    """One cache a file: as many processes would write them."""
    for number in range(start, start + count):
        Cache(folder, max_bytes=max_bytes).put(f"{number:03}", {}, bytes(1000))


def size_of(folder):
    return sum(file.stat().st_size for file in folder.iterdir())


def test_files_are_looked_at_every_so_many_writes(tmp_path, looks):
    fill(tmp_path / "cache", 2 * MAX_USAGE_RECORDS)
    assert len(looks) == 2
    assert (tmp_path / "cache" / USAGE).stat().st_size <= 8 * MAX_USAGE_RECORDS


def test_a_full_folder_is_bounded_and_not_looked_at_each_time(tmp_path, looks):
    for start in range(0, 200, 10):
        fill(tmp_path / "cache", 10, max_bytes=40 * SIZE, start=start)
        assert size_of(tmp_path / "cache") <= 40 * SIZE + 8 * MAX_USAGE_RECORDS
    assert len(looks) < 200 / 4


def test_what_other_processes_wrote_counts(tmp_path):
    folder, bound = tmp_path / "cache", 50 * SIZE
    processes = [subprocess.Popen([sys.executable, "-c", FILLER, str(folder), str(bound), str(number)]) for number in range(4)]
    assert [process.wait() for process in processes] == [0] * 4
    Cache(folder, max_bytes=bound).put("400", {}, bytes(1000))
    assert 30 * SIZE < size_of(folder) <= bound + 8 * MAX_USAGE_RECORDS


@pytest.mark.parametrize(
    "damage",
    [
        lambda usage: usage.unlink(),
        lambda usage: usage.write_bytes(b""),
        lambda usage: usage.write_bytes(b"half"),
        lambda usage: usage.write_bytes(bytes(80)),
        lambda usage: usage.write_bytes(b"\xff" * 800),
        lambda usage: usage.write_bytes(bytes(10_000_000)),
        lambda usage: usage.chmod(0o666),
        lambda usage: (usage.unlink(), os.mkfifo(usage)),
        lambda usage: (usage.unlink(), usage.symlink_to("elsewhere")),
    ],
    ids=["gone", "empty", "half", "no total", "too much", "too long", "written by others", "fifo", "symlink"],
)
def test_a_damaged_usage_costs_a_look_and_is_replaced(tmp_path, looks, recwarn, damage):
    folder = tmp_path / "cache"
    fill(folder, 3)
    damage(folder / USAGE)
    looks.clear()
    fill(folder, 3, start=3)
    assert len(looks) == 1
    assert (folder / USAGE).read_bytes()[:8] == (TOTAL + 4 * SIZE).to_bytes(8, "little")
    assert not recwarn.list


def test_a_usage_that_says_too_little_is_not_believed_for_long(tmp_path):
    folder, bound = tmp_path / "cache", 20 * SIZE
    fill(folder, 15, bound)
    for start in range(15, 15 + MAX_USAGE_RECORDS, 5):
        if start < 200:
            (folder / USAGE).write_bytes((folder / USAGE).read_bytes()[:-40] + TOTAL.to_bytes(8, "little") * 5)
        fill(folder, 5, bound, start=start)
    assert size_of(folder) <= bound + 8 * MAX_USAGE_RECORDS


def test_a_folder_in_the_place_of_the_usage_costs_one_warning(tmp_path, recwarn):
    (tmp_path / "cache" / USAGE).mkdir(mode=0o700, parents=True)
    (tmp_path / "cache").chmod(0o700)
    cache = Cache(tmp_path / "cache")
    for name in "012":
        cache.put(name, {}, b"code")
        assert cache.get(name).image == b"code"
    assert len(recwarn.list) == 1
