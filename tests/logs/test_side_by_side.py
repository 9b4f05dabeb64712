"""Chunks that several threads unpack: the order, errors in their places, what is begun ahead, and logs that are the same by one thread."""

from __future__ import annotations

import collections
import threading
import time

import pytest
from mcap.writer import CompressionType, Writer

import rosetta_jit as rj
from rosetta_jit.logs.reading import side_by_side as module
from rosetta_jit.logs.reading.segments import Chunk
from rosetta_jit.logs.reading.side_by_side import BYTES, side_by_side


@pytest.fixture(autouse=True)
def _four_processors(monkeypatch):
    monkeypatch.setattr(module, "processors", lambda: 4)


def slow_first(number):
    """Work that takes the longer, the earlier it begins."""
    time.sleep(0.02 / (number + 1))
    return number * number


def size_of_one(_):
    return BYTES


def test_results_come_in_the_order_of_the_items():
    assert list(side_by_side(iter(range(50)), slow_first, size_of_one)) == [(each, each * each) for each in range(50)]


def test_several_threads_work_at_once():
    together = threading.Barrier(3, timeout=10)

    def work(number):
        if number:
            together.wait()
        return threading.get_ident()

    found = [thread for _, thread in side_by_side(iter(range(7)), work, size_of_one)]
    assert found[0] == threading.get_ident() not in found[1:]
    assert len(set(found[1:])) == 3


def test_an_error_comes_behind_what_is_before_it():
    def items():
        yield from range(6)
        raise OSError("the disk is gone")

    def work(number):
        if number == 4:
            raise ValueError(number)
        return slow_first(number)

    for wrong, error, before in ((work, ValueError, 4), (slow_first, OSError, 6)):
        seen = []
        with pytest.raises(error):
            collections.deque(map(seen.append, (number for number, _ in side_by_side(items(), wrong, size_of_one))), 0)
        assert seen == list(range(before))


def test_little_is_begun_ahead():
    """Four times `BYTES` in all for three threads, a single item where it is larger, and nothing behind one that is not worth a thread."""
    begun = list[int]()

    def items():
        for number in range(100):
            begun.append(number)
            yield number

    for size, most in ((BYTES, 7), (100 * BYTES, 4), (0, 2)):
        begun.clear()
        found = side_by_side(items(), slow_first, {}.fromkeys(range(100), size).__getitem__)
        assert next(found) == (0, 0)
        assert begun == [0]
        next(found)
        time.sleep(0.1)
        assert len(begun) <= most
        found.close()


def test_who_leaves_early_leaves_no_thread():
    before = threading.active_count()
    found = side_by_side(iter(range(100)), slow_first, size_of_one)
    next(found)
    assert threading.active_count() == before
    next(found)
    assert threading.active_count() > before
    found.close()
    assert threading.active_count() == before


def log_of(path, compression):
    """A log of many small chunks, of which one has lost its checksum and one is no longer what its compression gives."""
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=2000, compression=compression)
        writer.start()
        schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
        channel = writer.register_channel("/x", "cdr", schema)
        for number in range(2000):
            text = f"{number:06}".encode()
            writer.add_message(channel, number, b"\0\1\0\0" + (len(text) + 1).to_bytes(4, "little") + text + b"\0", number)
        writer.finish()
    data = bytearray(path.read_bytes())
    chunks = [each for each in rj.open(path)._reader._summary.segments if isinstance(each, Chunk)]
    data[chunks[5].at + 9 + 24] ^= 1  # of the checksum
    data[chunks[9].at + chunks[9].size // 2] ^= 0x55
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("compression", [CompressionType.ZSTD, CompressionType.LZ4, CompressionType.NONE])
def test_a_damaged_log_is_the_same_by_one_thread_and_by_many(compression, tmp_path, monkeypatch):
    path = log_of(tmp_path / "a.mcap", compression)

    def read(processors):
        monkeypatch.setattr(module, "processors", lambda: processors)
        told = list[str]()
        log = rj.open(path, on_problem=lambda problem: told.append(problem.message))
        texts = log["/x"].to_arrow(on_error="skip")["data"].to_pylist()
        return texts, told, [bytes(each.message) for each in log.messages(raw=True)]

    texts, told, messages = read(1)
    assert 1500 < len(texts) <= len(messages) < 2000
    assert len(told) >= 2
    assert texts == sorted(texts)
    assert read(4) == (texts, told, messages)


def test_only_compressed_chunks_are_unpacked_ahead(tmp_path):
    for compression, expected in ((CompressionType.ZSTD, True), (CompressionType.LZ4, True), (CompressionType.NONE, False)):
        path = tmp_path / f"{compression.name}.mcap"
        log_of(path, compression)
        assert rj.open(path, on_problem=lambda _: None)._reader.works_ahead is expected
