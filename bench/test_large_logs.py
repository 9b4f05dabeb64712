"""Large logs: what point clouds and images cost a byte, what opening reads, and how much memory a long conversion takes."""

from __future__ import annotations

import os
import struct
import sys
import time
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

import rosetta_jit as rj
from bench.figures import Spread, ratio
from bench.peers.mcap import definition
from bench.peers.rosbags import store
from bench.processes import run
from bench.subjects import IMAGE_2, POINT_CLOUD_2
from bench.test_logs import mcap_file, run_pybag
from rosetta_jit.logs.mcap.grammar import CHANNEL, CHUNK_INDEX, DATA_END, FOOTER, HEADER, MAGIC, PREFIX, SCHEMA, STATISTICS
from rosetta_jit.logs.reading.storage import Storage
from rosetta_jit.runtime.arrow.files import write_tables

if TYPE_CHECKING:
    from collections.abc import Callable

GIGABYTE = 1e9
SIZE, QUICK_SIZE = 600_000_000, 200_000_000
RATE = 1.5
"""Gigabytes a second that one core is to decode."""

MEMORY_MB = 300


def uncompressed(path: Path, subject: Any, size: int) -> Path:
    """A log of one message, again and again."""
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.NONE, chunk_size=4 << 20)
        writer.start(profile="ros2")
        channel = writer.register_channel("/x", "cdr", writer.register_schema(subject.type, "ros2msg", definition(subject, 2).encode()))
        for number in range(size // len(subject.message)):
            writer.add_message(channel, number * 10**8, subject.message, number * 10**8)
        writer.finish()
    return path


def seconds_a_gigabyte(jobs: dict[str, Callable[[], Any]], size: int, rounds: int) -> dict[str, list[float]]:
    """Seconds of all threads on processors, of jobs in turns."""
    taken: dict[str, list[float]] = {what: [] for what in jobs}
    for work in jobs.values():
        work()
    for _ in range(rounds):
        for what, work in jobs.items():
            begin = time.process_time()
            work()
            taken[what].append((time.process_time() - begin) * GIGABYTE / size)
    return taken


COLUMNS, ARROW, PARQUET, ALONE = "columns", "Arrow", "Parquet", "pyarrow's Parquet, of tables in memory"
BYTES, ROSBAGS, PYBAG = "the mcap package, messages as bytes", "mcap and rosbags' deserialize_cdr", "pybag"


def counted(path: Path, decode: Callable[[bytes], Any] = bytes) -> int:
    """The messages that the mcap package gives, decoded by somebody else."""
    with path.open("rb") as file:
        return sum(decode(message.data) is not None for _, _, message in make_reader(file).iter_messages())


@pytest.mark.parametrize(("what", "subject"), [("point clouds", POINT_CLOUD_2), ("images", IMAGE_2)])
def test_large_messages(what, subject, effort, record, tmp_path):
    size = QUICK_SIZE if effort.quick else SIZE
    path = uncompressed(tmp_path / "a.mcap", subject, size)
    channel, types, sink = rj.open(path)["/x"], store("ros2"), Path(os.devnull)
    deserialize = partial(types.deserialize_cdr, typename=subject.type)
    made, count = list(channel.tables()), size // len(subject.message)
    jobs = {
        COLUMNS: lambda: sum(len(part.batch.data) for part in channel.parts()),
        ARROW: lambda: sum(table.num_rows for table in channel.tables()),
        PARQUET: lambda: write_tables(channel.tables(), sink, ".parquet"),
        ALONE: lambda: write_tables(made, sink, ".parquet"),
        BYTES: lambda: counted(path),
        ROSBAGS: lambda: counted(path, deserialize),
        PYBAG: lambda: run_pybag(path, "/x"),
    }
    assert {jobs[each]() for each in (COLUMNS, ARROW, BYTES, ROSBAGS, PYBAG)} == {count}
    taken = seconds_a_gigabyte(jobs, path.stat().st_size, 3 if effort.quick else 9)
    written = ratio(taken[PARQUET], taken[ALONE])
    rows = (
        ("uncompressed MCAP to columns", Spread.of(taken[COLUMNS]), 1 / RATE, "s a GB", "of processor; checksums compared"),
        ("uncompressed MCAP to Arrow", Spread.of(taken[ARROW]), 1 / RATE, "s a GB", "the same, with a copy for Arrow"),
        ("uncompressed MCAP to Parquet", written, None, "x pyarrow's writing of tables in memory", ""),
        *((peer, Spread.of(taken[peer]), None, "s a GB", "") for peer in (BYTES, ROSBAGS, PYBAG)),
    )
    for how, measured, at_most, unit, said in rows:
        record(f"{what}, {how}", measured, at_most, unit, said, messages=1)


def sparse(path: Path, size: int) -> Path:
    """An MCAP file whose chunks are a hole: as many as a log of that size has, and an index of all of them."""

    def record(opcode: int, content: bytes) -> bytes:
        return PREFIX.pack(opcode, len(content)) + content

    def text(value: str) -> bytes:
        return struct.pack("<I", len(value)) + value.encode()

    chunk = 1 << 20
    definitions = record(SCHEMA, struct.pack("<H", 1) + text("std_msgs/msg/Bool") + text("ros2msg") + text("bool data"))
    definitions += record(CHANNEL, struct.pack("<HH", 1, 1) + text("/x") + text("cdr") + struct.pack("<I", 0))
    with path.open("wb") as file:
        file.write(MAGIC + record(HEADER, text("ros2") + text("bench")))
        begin = file.tell()
        count = (size - begin) // chunk
        file.seek(begin + count * chunk)
        file.write(record(DATA_END, bytes(4)))
        summary = file.tell()
        file.write(definitions)
        for each in range(count):
            offsets = struct.pack("<IHQ", 10, 1, begin + each * chunk)
            times = struct.pack("<QQQQ", each, each, begin + each * chunk, chunk)
            file.write(record(CHUNK_INDEX, times + offsets + struct.pack("<Q", 0) + text("") + struct.pack("<QQ", chunk, chunk)))
        counts = struct.pack("<IHQ", 10, 1, count)
        file.write(record(STATISTICS, struct.pack("<QHIIIIQQ", count, 1, 1, 0, 0, count, 0, count) + counts))
        file.write(record(FOOTER, struct.pack("<QQI", summary, 0, 0)) + MAGIC)
    return path


def test_opening_reads_the_index(effort, record, tmp_path, monkeypatch):
    path = sparse(tmp_path / "sparse.mcap", 10 * 10**9)
    reads: list[int] = []
    read = Storage.read

    def counted(self: Storage, at: int, size: int) -> bytes:
        found = read(self, at, size)
        reads.append(len(found))
        return found

    monkeypatch.setattr(Storage, "read", counted)
    taken: list[float] = []
    for _ in range(3 if effort.quick else 9):
        reads.clear()
        begin = time.thread_time()
        log = rj.open(path)
        taken.append((time.thread_time() - begin) * 1000)
        assert log["/x"].count == len(log.pieces) - 2 > 9000
    told = f"{len(reads)} reads, {sum(reads) / 1e6:.2f} MB of {path.stat().st_size / 1e9:.0f} GB"
    record("bytes read to open an MCAP file of 10 GB", Spread.of([sum(reads) / 1e6]), 2.0, "MB", told)
    record("time to open it", Spread.of(taken), None, "ms", told)


CONVERT = """
import sys
from pathlib import Path
from rosetta_jit.cli import main
assert main(["convert", sys.argv[1], "-o", sys.argv[2]]) == 0
print(next(int(line.split()[1]) for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM")) / 1000)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="reads the largest resident set from /proc")
def test_memory(effort, record, tmp_path):
    clouds = uncompressed(tmp_path / "clouds.mcap", POINT_CLOUD_2, QUICK_SIZE if effort.quick else 2 * SIZE)
    imus = mcap_file(tmp_path / "imus.mcap", 50_000 if effort.quick else 1_000_000)
    many = mcap_file(tmp_path / "many.mcap", 50_000 if effort.quick else 1_000_000, topics=60)
    for what, path in (("point clouds", clouds), ("Imus, zstd", imus), ("Imus of 60 topics", many)):
        outputs = ("a folder", f"{path.stem}/"), ("one Parquet file", f"{path.stem}.parquet"), ("MCAP", f"{path.stem}-2.mcap")
        for where, output in outputs if path != many else outputs[:1]:
            used = float(run("-c", CONVERT, str(path), f"{tmp_path}/{output}"))
            told = f"a log of {path.stat().st_size / 1e6:.0f} MB"
            record(f"memory of a conversion of {what} into {where}", Spread.of([used]), MEMORY_MB, "MB", told)
