"""Tables take the memory of large arrays, and keep their values while the batch is filled again."""

from __future__ import annotations

import threading

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.runtime.batches.batch import hand_over
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.memory_for_arrow import SPARE

SCHEMA = b"string name\nuint8[] data\nfloat64[4] fixed\nuint16[] numbers"
NUMBERS = {"data", "fixed", "numbers"}
IN_A_PART = 8


def message(number: int, size: int) -> bytes:
    """As CDR has it: the header, and each array behind its length, at a multiple of its size."""
    name = f"{number:03d}".encode() + b"\0"
    body = len(name).to_bytes(4, "little") + name + size.to_bytes(4, "little") + bytes([number]) * size
    body += bytes(-len(body) % 8) + np.full(4, number, "<f8").tobytes()
    return b"\0\1\0\0" + body + (3).to_bytes(4, "little") + np.full(3, number, "<u2").tobytes()


def channel(path, sizes, is_bad=lambda _: False):
    from mcap.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file, chunk_size=3000)
        writer.start()
        topic = writer.register_channel("/x", "cdr", writer.register_schema("t/msg/X", "ros2msg", SCHEMA))
        for number, size in enumerate(sizes):
            data = message(number, size)
            writer.add_message(topic, log_time=number, publish_time=number, data=data[:20] if is_bad(number) else data)
        writer.finish()
    return rj.open(path)["/x"]


def rows_of(sizes, first=0):
    return [
        {"name": f"{number:03d}", "data": bytes([number]) * size, "fixed": [number] * 4, "numbers": [number] * 3}
        for number, size in enumerate(sizes, first)
    ]


def address(table, name: str) -> int:
    return table[name].chunk(0).buffers()[-1].address


def lane_of(part, name: str):
    """The memory of a field's elements."""
    return part.batch.lanes.buffers[part.batch._family.tree.root.entries[name].node.lane]


@pytest.fixture
def small_parts(monkeypatch):
    monkeypatch.setattr("rosetta_jit.logs.decoded_parts.MESSAGES", IN_A_PART)


@pytest.mark.usefixtures("small_parts")
def test_memory_is_taken(tmp_path):
    sizes = [500] * 5 * IN_A_PART
    topic, tables, taken = channel(tmp_path / "x.mcap", sizes), [], []
    for part, table in topic.tables_of_parts(clocks=()):
        taken.append({name for name in NUMBERS if address(table, name) == lane_of(part, name).ctypes.data})
        tables.append(table)
    assert taken == [set(), *[NUMBERS] * 4]
    assert [row for table in tables for row in table.to_pylist()] == rows_of(sizes)
    assert len({address(table, "data") for table in tables}) == 5


@pytest.mark.usefixtures("small_parts")
def test_parts_of_other_sizes(tmp_path):
    """Parts that outgrow the memory, that have nothing, and that would leave most of what they take empty."""
    sizes = [size for size in (200, 200, 5000, 10, 0, 4000, 4900) for _ in range(IN_A_PART)]
    assert channel(tmp_path / "x.mcap", sizes).to_arrow(clocks=()).to_pylist() == rows_of(sizes)
    topic, taken = rj.open(tmp_path / "x.mcap")["/x"], []
    for number, (part, table) in enumerate(topic.tables_of_parts(clocks=())):
        first = number * IN_A_PART
        assert table.to_pylist() == rows_of(sizes[first : first + IN_A_PART], first)
        if number != 4:
            taken.append(address(table, "data") == lane_of(part, "data").ctypes.data)
    assert taken == [False, True, False, False, False, True]


@pytest.mark.usefixtures("small_parts")
def test_messages_that_are_left_out(tmp_path):
    """The arrays of the others do not lie together."""
    sizes = [300] * 4 * IN_A_PART
    topic = channel(tmp_path / "x.mcap", sizes, lambda number: number % 5 == 3)
    found = topic.to_arrow(clocks=(), on_error="skip").to_pylist()
    assert found == [row for number, row in enumerate(rows_of(sizes)) if number % 5 != 3]


def test_a_table_outlives_the_next_filling():
    """Of a batch that hands its memory over, whichever way it is filled again."""
    decoder = rj.Decoder.of("t/msg/X", encoding="cdr", schema=SCHEMA.decode())
    batch, tables = decoder.many([message(0, 100)] * 2), []
    hand_over(batch)
    for number in range(1, 4):
        decoder.many([message(number, 100)] * 2, into=batch)
        tables.append(batch.to_arrow())
    batch.reset(2)
    for each in batch:
        each.data = np.full(100, 9, np.uint8)
    assert [table["data"].to_pylist() for table in tables] == [[bytes([number]) * 100] * 2 for number in (1, 2, 3)]
    assert batch.lanes.buffers[batch._family.tree.root.entries["data"].node.lane].size <= 200 + 200 // SPARE + 8


@pytest.mark.usefixtures("small_parts")
def test_memory_of_a_batch_serves_the_next_reading(tmp_path, monkeypatch):
    """Tables that were read before keep their values, whatever is read then, and whoever keeps a part has its batch for himself."""
    sizes = [50 + number for number in range(20)]
    log = channel(tmp_path / "a.mcap", sizes)
    first = log.to_arrow(clocks=())
    copied = first.to_pylist()
    later = log.to_arrow(clocks=(), start=5)
    assert later.to_pylist() == rows_of(sizes[5:], 5)
    grown = []
    grow = Lanes.grow
    monkeypatch.setattr(Lanes, "grow", lambda lanes, lane, rows: (grown.append(lane), grow(lanes, lane, rows)))
    again = log.to_arrow(clocks=())
    assert not grown
    assert first.to_pylist() == copied == again.to_pylist() == rows_of(sizes)
    assert later.to_pylist() == rows_of(sizes[5:], 5)
    (*_, kept) = log.parts()
    data = kept.batch.to_arrow().to_pylist()
    log.to_arrow()
    assert kept.batch.to_arrow().to_pylist() == data


@pytest.mark.usefixtures("small_parts")
def test_readings_at_the_same_time_have_batches_of_their_own(tmp_path):
    sizes = [50] * 40
    log = channel(tmp_path / "a.mcap", sizes)
    log.to_arrow()
    one, other = log.tables(clocks=()), log.tables(clocks=())
    found = [row for pair in zip(one, other, strict=True) for table in pair for row in table.to_pylist()]
    expected = rows_of(sizes)
    assert sorted(found, key=lambda row: row["name"]) == [each for each in expected for _ in range(2)]
    tables, threads = [], [threading.Thread(target=lambda: tables.append(log.to_arrow(clocks=()).to_pylist())) for _ in range(8)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert tables == [expected] * 8


@pytest.mark.usefixtures("small_parts")
def test_a_reading_that_failed_leaves_nothing(tmp_path):
    sizes = [50] * 20
    log = channel(tmp_path / "a.mcap", sizes, lambda number: number == 12)
    for _ in range(2):
        with pytest.raises(rj.DecodeError, match=r"\[12\]"):
            log.to_arrow()
    masked = [log.to_arrow(clocks=(), on_error="skip").to_pylist() for _ in range(3)]
    assert masked == [rows_of(sizes[:12]) + rows_of(sizes[13:], 13)] * 3
