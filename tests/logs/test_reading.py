"""Logs that the real libraries write are read: their topics, messages, times and columns."""

from __future__ import annotations

import io
import sys
from datetime import UTC, datetime

import numpy as np
import pytest
from mcap.writer import Writer

import rosetta_jit as rj
from rosetta_jit.errors import DecodeError, LogError, SchemaError

from .made import BAGS, COMPRESSIONS, LCM_TYPES, POINT, START, STEP, expected, time_of, values, write_bag, write_lcm, write_mcap

COUNT = 200


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("logs")


@pytest.mark.parametrize("compression", COMPRESSIONS)
@pytest.mark.parametrize("how", [{}, {"chunked": False}, {"index": False}], ids=str)
def test_mcap(folder, compression, how):
    log = rj.open(write_mcap(folder / "a.mcap", COUNT, compression, **how))
    assert values(log.messages()) == list(expected(COUNT))
    assert [(each.topic, each.type, each.count) for each in log.channels] == [
        ("/a", "t/msg/Point", COUNT),
        ("/b", "t/msg/Text", COUNT // 5),
    ]
    assert log["/a"]["publish_time"].astype(np.int64).tolist() == [time_of(number) - 7 for number in range(COUNT)]


def test_an_mcap_file_whose_writer_was_stopped(folder):
    path, found = write_mcap(folder / "stopped.mcap", COUNT, finish=False), []
    log = rj.open(path, on_problem=found.append)
    there = list(expected(COUNT))[: len(list(log.messages(raw=True)))]
    assert len(there) > COUNT  # all but the chunk that the writer had not written yet
    assert values(log.messages()) == there
    assert sum(each.count for each in log.channels) == len(there)
    assert [each.code for each in found] == ["log-unfinished"]


def test_a_warning_is_of_the_line_that_opens_the_log(folder):
    path = write_mcap(folder / "stopped.mcap", COUNT, finish=False)
    with pytest.warns(rj.LogWarning) as found:
        rj.open(path)
    assert [each.filename for each in found] == [__file__]


@pytest.mark.parametrize("compression", BAGS)
def test_bag(folder, compression):
    log = rj.open(write_bag(folder / f"{compression}.bag", COUNT, compression))
    assert values(log.messages()) == list(expected(COUNT))
    assert log.facts["compression"] == compression
    assert (log.start, log.end) == (time_of(0), time_of(COUNT - 1))
    assert log["/a"].count == COUNT


def test_lcm(folder):
    log = rj.open(write_lcm(folder / "a.log", COUNT))
    with pytest.raises(LogError, match=r"does not say of which type.*fingerprint 0x"):
        log["/a"].to_arrow()
    assert log.channel("/a", "t.point_t", schema=LCM_TYPES)["x"].tolist() == [number / 4 for number in range(COUNT)]
    (folder / "definitions").mkdir()
    (folder / "definitions" / "others.lcm").write_text("package t;\nstruct other_t { double x; }\n")
    (folder / "definitions" / "types.lcm").write_text(LCM_TYPES)
    for where in ({"search_path": [folder / "definitions"]}, {"imports": [folder / "definitions" / "types.lcm"]}):
        found = rj.open(folder / "a.log", **where)
        assert found["/b"].to_arrow()["data"][1].as_py() == "text 5"  # whose fingerprint is found there
    with pytest.raises(LogError, match="does not say of which type"):
        rj.open(folder / "a.log", imports=[folder / "definitions" / "others.lcm"])["/b"].to_arrow()
    with pytest.raises(SchemaError, match=r"`absent.lcm` is not on the search path"):
        rj.open(folder / "a.log", imports=["absent.lcm"])["/b"].to_arrow()
    assert [(each.time, each.topic) for each in log.messages(raw=True)] == [
        (time // 1000 * 1000, topic) for time, topic, _ in expected(COUNT)
    ]


@pytest.fixture(scope="module")
def log(folder):
    return rj.open(write_mcap(folder / "whole.mcap", COUNT))


def test_columns_and_tables(log):
    points = log["/a"]
    table = points.to_arrow()
    assert table.column_names == ["log_time", "publish_time", "x", "name"]
    assert table["name"].to_pylist() == points.to_polars(["name"])["name"].to_list() == [f"p{number}" for number in range(COUNT)]
    frame = points.to_pandas(["x"], clocks=["log_time"])
    assert frame["log_time"].astype("int64").tolist() == [time_of(number) for number in range(COUNT)]
    assert log["/b"].to_arrow(start=time_of(COUNT)).num_rows == 0
    assert log["/b"].to_arrow(start=time_of(COUNT)).schema == log["/b"].to_arrow().schema


@pytest.mark.parametrize("kind", [int, "datetime", np.datetime64])
def test_a_stretch_of_time(log, kind):
    def moment(number):
        if kind is int:
            return time_of(number)
        return np.datetime64(time_of(number), "ns") if kind is np.datetime64 else datetime.fromtimestamp(time_of(number) / 1e9, UTC)

    found = [each.time for each in log.messages(["/a"], start=moment(100), end=moment(125))]
    assert found == [time_of(number) for number in range(100, 125)]
    assert log["/a"].to_arrow(start=moment(100), end=moment(125)).num_rows == 25
    with pytest.raises(TypeError, match="not float"):
        next(log.messages(start=1.5))


def test_only_wanted_chunks_are_read(log, monkeypatch):
    sizes = []
    read = log._storage.read
    monkeypatch.setattr(log._storage, "read", lambda at, size: sizes.append(size) or read(at, size))
    into = log._storage.read_into
    monkeypatch.setattr(log._storage, "read_into", lambda at, memory: sizes.append(memory.size) or into(at, memory))
    assert len(list(log.messages(["/a"], start=START + 50 * STEP, end=START + 51 * STEP))) == 1
    assert sum(sizes) < log._storage.size / 3


def test_what_there_is_not(log):
    with pytest.raises(LogError, match="did you mean `/a`"):
        log["a"]
    assert "/a" in log
    assert list(log) == ["/a", "/b"]
    assert "t/msg/Point  200" in repr(log)


def test_standard_input(log, monkeypatch):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(log.path.read_bytes())))
    assert len(rj.open("-", format="mcap")["/a"]) == COUNT


def test_a_message_that_its_type_does_not_allow(folder):
    from mcap.writer import Writer

    path = folder / "bad.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("/x", "cdr", writer.register_schema("t/msg/X", "ros2msg", b"int32 x"))
        for number, data in enumerate([b"\0\1\0\0\1\0\0\0", b"\0\1\0\0\1", b"\0\1\0\0\3\0\0\0"]):
            writer.add_message(channel, log_time=number, publish_time=number, data=data)
        writer.finish()
    log = rj.open(path)
    with pytest.raises(DecodeError, match=r"`\[1\]"):
        log["/x"].to_arrow()
    with pytest.raises(DecodeError, match=r"a message of /x, logged 1970-01-01T00:00:00.000000001Z"):
        list(log.messages())
    assert log["/x"].to_arrow(on_error="skip")["x"].to_pylist() == [1, 3]
    assert [each.time for each in log.messages(on_error="skip")] == [0, 2]


def test_parts_of_many_blocks(folder):
    """Messages of several chunks fill one batch; those that cannot be decoded keep their bytes and times."""
    from mcap.writer import Writer

    path, bad = folder / "chunks.mcap", b"\0\1\0\0\1"
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=150)
        writer.start()
        channel = writer.register_channel("/x", "cdr", writer.register_schema("t/msg/X", "ros2msg", b"int32 x"))
        for number in range(40):
            data = bad if number in (3, 17) else b"\0\1\0\0" + number.to_bytes(4, "little")
            writer.add_message(channel, log_time=100 + number, publish_time=number, data=data)
        writer.finish()
    log, good = rj.open(path), [number for number in range(40) if number not in (3, 17)]
    assert len(list(log.blocks())) > 5
    (part,) = log["/x"].parts(on_error="skip")
    assert part.batch.x.tolist() == part.publish_ns.tolist() == good
    assert (part.first, part.given, part.batch.kept.tolist()) == (0, 40, good)
    assert {number: (each.log_ns, each.data) for number, each in part.refused.items()} == {3: (103, bad), 17: (117, bad)}
    with pytest.raises(DecodeError, match=r"`\[3\]"):
        log["/x"].to_arrow()
    lent = rj.open(path, borrow=True)["/x"]
    assert lent.to_arrow(on_error="mask")["x"].to_pylist() == [number if number in good else 0 for number in range(40)]


def test_bytes_that_are_lent(folder):
    """A batch borrows from one block, whose memory is not used again as long as a message shows it."""
    from mcap.writer import Writer

    path = folder / "lent.mcap"
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=300)
        writer.start()
        channel = writer.register_channel("/x", "cdr", writer.register_schema("t/msg/X", "ros2msg", b"uint8[] data"))
        for number in range(30):
            writer.add_message(channel, log_time=number, publish_time=number, data=b"\0\1\0\0\x20\0\0\0" + bytes([number]) * 32)
        writer.finish()
    log = rj.open(path, borrow=True)
    assert [bytes(each.message.data) for each in list(log.messages())] == [bytes([number]) * 32 for number in range(30)]
    assert log["/x"].to_arrow()["data"].to_pylist() == [bytes([number]) * 32 for number in range(30)]


def test_counters_go_on_from_part_to_part(folder, monkeypatch):
    """A mapping that counts messages counts those of all blocks and parts."""
    monkeypatch.setattr("rosetta_jit.logs.decoded_parts.MESSAGES", 60)
    files = {
        "n.proto": 'syntax = "proto3"; package n; message Counted { int64 number = 1; double x = 2; }',
        "t/msg/Point.msg": POINT,
        "n.mapping": """import "n.proto"
import "t/msg/Point.msg"
data-holder: n.Counted
wire-schema: t/msg/Point
unpack-rules:
  ignore rest
  .number = counter()
  .x = .x
""",
    }
    log = rj.open(write_mcap(folder / "counted.mcap", COUNT), schema=files)
    table = log["/a", "n.mapping"].to_arrow()
    assert table["number"].to_pylist() == list(range(COUNT))


def test_two_readings_at_once(log):
    """Each has memory of its own, also for what it reads ahead; one that is left early ends its thread."""
    import threading

    before = threading.active_count()
    one, other = log["/a"].tables(["x"]), log["/b"].tables(["data"])
    assert next(one)["x"].to_pylist() == [number / 4 for number in range(COUNT)]
    assert next(other)["data"].to_pylist() == [f"text {number}" for number in range(0, COUNT, 5)]
    one.close()
    other.close()
    assert threading.active_count() == before
    pairs = zip(log["/a"], log["/a"], strict=True)
    assert all((first.x, first.name) == (second.x, second.name) for first, second in pairs)


def test_what_goes_wrong_ahead_is_raised(log, monkeypatch):
    def broken(at, size):
        raise OSError(5, "the disk is gone")

    points = log["/a"]
    assert points.decoder
    monkeypatch.setattr(log._storage, "read", broken)
    with pytest.raises(OSError, match="the disk is gone"):
        points.to_arrow()


def test_many_messages_in_small_memory(tmp_path, monkeypatch):
    """Longer than what is decoded at once: tables of some thousand messages, one after the other."""
    monkeypatch.setattr("rosetta_jit.logs.decoded_parts.MESSAGES", 5000)
    log = rj.open(write_mcap(tmp_path / "long.mcap", 17_000, chunk_size=100_000))
    sizes = [table.num_rows for table in log["/a"].tables()]
    assert sum(sizes) == 17_000
    assert max(sizes) <= 5000
    assert np.array_equal(log["/a"]["x"], np.arange(17_000) / 4)


def test_a_url(log):
    import fsspec

    fsspec.filesystem("memory").pipe("/drive/whole.mcap", log.path.read_bytes())
    assert rj.open("memory://drive/whole.mcap")["/a"].to_arrow().num_rows == COUNT
    with pytest.raises(LogError, match="log-unreadable"):
        rj.open("memory://drive/nothing.mcap")


def test_an_address_whose_package_is_missing(monkeypatch):
    import fsspec.core

    def missing(*_, **__):
        raise ImportError("install aiohttp")

    monkeypatch.setattr(fsspec.core, "url_to_fs", missing)
    with pytest.raises(LogError, match="cannot be read: install aiohttp"):
        rj.open("https://host/a.mcap")


@pytest.mark.parametrize("size", [1, 40])
def test_a_definition_that_is_empty(folder, size):
    """It is of a type without fields, or there is none: then the type is looked for on the search path."""
    from mcap.writer import Writer

    path = folder / "empty.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("/x", "cdr", writer.register_schema("z/msg/Unknown", "ros2msg", b" \n"))
        writer.add_message(channel, log_time=1, publish_time=1, data=b"\0\1\0\0" + bytes(size))
        writer.finish()
    (folder / "z" / "msg").mkdir(parents=True, exist_ok=True)
    (folder / "z" / "msg" / "Unknown.msg").write_text("float64[5] x\n")
    if size == 1:
        assert rj.open(path)["/x"].to_arrow().num_rows == 1
        return
    with pytest.raises(LogError, match="has no definition of `z/msg/Unknown`, the type of the messages of `/x`"):
        rj.open(path)["/x"].to_arrow()
    assert rj.open(path, search_path=[folder])["/x"].to_arrow()["x"].to_pylist() == [[0] * 5]


@pytest.mark.parametrize("chunk_size", [40, 1 << 20])
def test_times_before_1970(tmp_path, chunk_size):
    """MCAP writes times without sign; ROS 2's have one."""
    times, path = [-3, -2, -1, 0, 1, 2], tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=chunk_size)
        writer.start()
        topic = writer.register_channel("/x", "cdr", writer.register_schema("t/msg/X", "ros2msg", b"uint8 x"))
        for number, time in enumerate(times):
            writer.add_message(topic, log_time=time % 2**64, publish_time=time % 2**64, data=b"\0\1\0\0" + bytes([number]))
        writer.finish()
    log = rj.open(path)
    assert [each.time for each in log.messages()] == times
    assert log["/x"].to_arrow()["publish_time"].cast("int64").to_pylist() == times
    for start, end in ((-2, 1), (-9, 0), (-3, -1), (0, 9), (None, -1), (2, None)):
        wanted = [each for each in times if (start is None or each >= start) and (end is None or each < end)]
        assert [each.time for each in log.messages(start=start, end=end)] == wanted
        assert log["/x"].to_arrow(start=start, end=end).num_rows == len(wanted)
    assert (log.start, log.end) == ((-3, 2) if chunk_size == 40 else (None, None))  # one chunk has both kinds, and says neither bound


def test_columns_are_a_list_of_names(tmp_path):
    with pytest.raises(TypeError, match=r"columns=\['x'\]"):
        rj.open(write_mcap(tmp_path / "a.mcap", 3))["/a"].to_arrow(columns="x")
