"""Logs of more than 10 GB, most of which is a hole that nobody reads, and messages that are large themselves."""

from __future__ import annotations

import struct

import pytest

import rosetta_jit as rj
from rosetta_jit.logs.bag.writer import u32
from rosetta_jit.logs.reading.storage import Storage

from .made import expected, values, write_bag, write_mcap

COUNT = 60
HOLE = 10 * 10**9
PRIVATE_RECORD, DATA_END_SIZE, FOOTER_SIZE, MAGIC_SIZE = 0x80, 13, 29, 8


def mcap_with_hole(path):
    """An MCAP file whose last record of data is one that readers skip, because its opcode is an application's own."""
    whole = write_mcap(path, COUNT).read_bytes()
    footer = len(whole) - MAGIC_SIZE - FOOTER_SIZE
    (summary,) = struct.unpack_from("<Q", whole, footer + 9)
    at, head = summary - DATA_END_SIZE, struct.pack("<BQ", PRIVATE_RECORD, HOLE)
    tail = bytearray(whole[at:])
    struct.pack_into("<QQI", tail, footer - at + 9, summary + len(head) + HOLE, 0, 0)
    with path.open("wb") as file:
        file.write(whole[:at] + head)
        file.seek(HOLE, 1)
        file.write(tail)
    return path


def bag_with_hole(path):
    """A bag with records behind its chunks that readers skip, because what tells of chunks stands in the index."""
    whole = bytearray(write_bag(path, COUNT).read_bytes())
    place = whole.index(b"index_pos=") + len(b"index_pos=")
    (index,) = struct.unpack_from("<Q", whole, place)
    head, each = u32(8) + u32(4) + b"op=\6", (1 << 32) - 1
    count = -(-HOLE // each)
    struct.pack_into("<Q", whole, place, index + count * (len(head) + 4 + each))
    with path.open("wb") as file:
        file.write(whole[:index])
        for _ in range(count):
            file.write(head + u32(each))
            file.seek(each, 1)
        file.write(whole[index:])
    return path


@pytest.fixture
def sizes(monkeypatch):
    """How many bytes each reading of a file asked for."""
    found, read, read_into = [], Storage.read, Storage.read_into
    monkeypatch.setattr(Storage, "read", lambda self, at, size: found.append(size) or read(self, at, size))
    monkeypatch.setattr(Storage, "read_into", lambda self, at, memory: found.append(memory.size) or read_into(self, at, memory))
    return found


@pytest.mark.parametrize("make", [mcap_with_hole, bag_with_hole])
def test_opening_reads_the_index_alone(make, tmp_path, sizes):
    path = make(tmp_path / "large.log")
    assert path.stat().st_size > HOLE
    log = rj.open(path)
    assert [(each.topic, each.count) for each in log.channels] == [("/a", COUNT), ("/b", COUNT // 5)]
    assert sum(sizes) < 10_000
    assert values(log.messages()) == list(expected(COUNT))
    assert sum(sizes) < 100_000
    assert not log.problems


def test_large_messages(tmp_path, monkeypatch):
    """Those of several chunks become one part, as long as it has room for them; small ones between them are no hindrance."""
    from mcap.writer import CompressionType, Writer

    monkeypatch.setattr("rosetta_jit.logs.decoded_parts.LARGE_BYTES", 1 << 20)
    path, sizes = tmp_path / "large.mcap", [300_000] * 5 + [10] * 3 + [2_000_000, 300_000]
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=400_000, compression=CompressionType.NONE)
        writer.start()
        channel = writer.register_channel("/x", "cdr", writer.register_schema("t/msg/X", "ros2msg", b"uint8[] data"))
        for number, size in enumerate(sizes):
            writer.add_message(channel, number, b"\0\1\0\0" + u32(size) + bytes([number]) * size, number)
        writer.finish()
    channel = rj.open(path)["/x"]
    found = [each for table in channel.tables() for each in table["data"].to_pylist()]
    assert found == [bytes([number]) * size for number, size in enumerate(sizes)]
    parts = [part.given for part in channel.parts()]
    assert sum(parts) == len(sizes)
    assert parts[:1] == [3]
    assert len(parts) < len(sizes) - 2
