"""Logs to columns: beside what it takes to decompress them, and beside the Python readers of logs.

Time is that of all threads on processors: one reads ahead while another one decodes.
"""

from __future__ import annotations

import os
from functools import wraps
from itertools import cycle
from time import process_time
from typing import TYPE_CHECKING, Any

import lcm
import lz4.frame
import zstandard
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from mcap_ros1.decoder import DecoderFactory as Ros1Factory
from mcap_ros2.decoder import DecoderFactory as Ros2Factory
from pybag.mcap_reader import McapFileReader
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag1 import Writer as BagWriter

import rosetta_jit as rj
from bench.contest import Contender
from bench.peers.lcm_gen import peers as lcm_peers
from bench.peers.mcap import definition
from bench.peers.rosbags import store, type_name
from bench.subjects import IMU, IMU_2, LCM_DOUBLES
from rosetta_jit.logs.reading.segments import Chunk

if TYPE_CHECKING:
    from pathlib import Path

CHAPTER = "Logs"
COUNT, FEW = 200_000, 5_000
TABLE, BYTES, ALONE = "rosetta_jit, `to_arrow`", "rosetta_jit, messages as bytes", "decompression alone"
ELAPSED, ONE = ", elapsed", ", on one core"
START, STEP = 1_700_000_000 * 10**9, 5_000_000


def varied(subject, count):
    """Messages that differ as those of a sensor do, in all of their numbers but the covariances."""
    import numpy as np

    encode, dice = subject.encoder(), np.random.default_rng(0)
    holder = subject.decoder()(subject.message)
    for each in range(count):
        values = dice.normal(size=10).round(6).tolist()
        holder.header.frame_id = "base_link"
        for name, part in (("orientation", "xyzw"), ("angular_velocity", "xyz"), ("linear_acceleration", "xyz")):
            for axis in part:
                setattr(getattr(holder, name), axis, values.pop())
        yield START + each * STEP, encode(holder)


def mcap_file(path: Path, count: int, topics: int = 1) -> Path:
    """Imus, on several topics in turn."""
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start(profile="ros2")
        schema = writer.register_schema(IMU_2.type, "ros2msg", definition(IMU_2, 2).encode())
        channels = [writer.register_channel(f"/imu{number or ''}", "cdr", schema) for number in range(topics)]
        for (time, data), channel in zip(varied(IMU_2, count), cycle(channels), strict=False):
            writer.add_message(channel, log_time=time, publish_time=time, data=data)
        writer.finish()
    return path


def bag_file(path: Path, count: int) -> Path:
    writer = BagWriter(path)
    writer.set_compression(BagWriter.CompressionFormat.LZ4)
    with writer:
        connection = writer.add_connection("/imu", type_name(IMU), typestore=store("ros1"))
        for time, data in varied(IMU, count):
            writer.write(connection, time, data)
    return path


def decompress(path: Path) -> Any:
    """What decompresses all chunks, in memory already, and does nothing else."""
    reader: Any = rj.open(path)._reader
    records, grammar = reader._storage, reader._grammar
    summary = getattr(reader, "_summary", None) or reader._contents
    packed = [grammar.packed(records.read(each.at, each.size)) for each in summary.segments if isinstance(each, Chunk)]

    def run() -> None:
        for each in packed:
            if each.compression == "zstd":
                zstandard.ZstdDecompressor().decompress(each.body, max_output_size=each.size)
            else:
                lz4.frame.decompress(each.body)

    return run


def on_one_core(function):
    """The same where the process may use one processor alone, as long as it lasts: it starts no thread then."""

    @wraps(function)
    def run():
        before = os.sched_getaffinity(0)
        os.sched_setaffinity(0, {min(before)})
        try:
            return function()
        finally:
            os.sched_setaffinity(0, before)

    return run


def run_mcap(path, *factories):
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=factories)
        return sum(1 for _ in (reader.iter_decoded_messages() if factories else reader.iter_messages()))


def run_pybag(path, topic="/imu"):
    with McapFileReader.from_file(path) as reader:
        return sum(1 for _ in reader.messages(topic))


def run_rosbags(path):
    types = store("ros1")
    with BagReader(path) as reader:
        return sum(1 for each in reader.messages() if types.deserialize_ros1(each[2], each[0].msgtype))


def ours(effort, path, count):
    channel, log = rj.open(path)["/imu"], rj.open(path)
    assert channel.to_arrow().num_rows == count
    return [
        Contender(
            TABLE,
            "ours",
            "a table of all fields and two times; checksums compared",
            effort.call(channel.to_arrow, messages=count, clock=process_time),
        ),
        Contender(
            BYTES,
            "ours",
            "one bytes object a message",
            effort.call(lambda: sum(1 for _ in log.messages(raw=True)), messages=count, clock=process_time),
        ),
        Contender(ALONE, "limit", "the chunks' content, in memory", effort.call(decompress(path), messages=count, clock=process_time)),
        Contender(TABLE + ONE, "ours", "the same", effort.call(on_one_core(channel.to_arrow), messages=count, clock=process_time)),
        Contender(TABLE + ELAPSED, "ours", "the same", effort.call(channel.to_arrow, messages=count, threaded=True)),
        Contender(ALONE + ELAPSED, "limit", "the same", effort.call(decompress(path), messages=count, threaded=True)),
    ]


def test_mcap(effort, compare, record, tmp_path):
    count = COUNT // 10 if effort.quick else COUNT
    path, few = mcap_file(tmp_path / "many.mcap", count), mcap_file(tmp_path / "few.mcap", FEW)
    peers = {
        "mcap, messages as bytes": lambda: run_mcap(few),
        "mcap with mcap-ros2-support": lambda: run_mcap(few, Ros2Factory()),
        "pybag": lambda: run_pybag(few),
    }
    assert {run() for run in peers.values()} == {FEW}
    contenders = [
        Contender(name, "peer", "one object a message", effort.call(run, messages=FEW, clock=process_time)) for name, run in peers.items()
    ]
    outcome = compare(CHAPTER, f"{count:,} messages of sensor_msgs/msg/Imu in MCAP, zstd", [*ours(effort, path, count), *contenders])
    told(record, outcome, "Imu, MCAP (zstd) to Arrow", 2, [name for name in peers if "bytes" not in name])


def test_bag(effort, compare, record, tmp_path):
    count = COUNT // 10 if effort.quick else COUNT
    path, few = bag_file(tmp_path / "many.bag", count), bag_file(tmp_path / "few.bag", FEW)
    mcap_of_bag = tmp_path / "few.mcap"
    from rosetta_jit.cli import main

    assert main(["convert", str(few), "-o", str(mcap_of_bag)]) == 0
    peers = {"rosbags": lambda: run_rosbags(few), "mcap with mcap-ros1-support, of MCAP": lambda: run_mcap(mcap_of_bag, Ros1Factory())}
    assert {run() for run in peers.values()} == {FEW}
    contenders = [
        Contender(name, "peer", "one object a message", effort.call(run, messages=FEW, clock=process_time)) for name, run in peers.items()
    ]
    outcome = compare(CHAPTER, f"{count:,} messages of sensor_msgs/Imu in a bag, lz4", [*ours(effort, path, count), *contenders])
    told(record, outcome, "Imu, bag (lz4) to Arrow", None, list(peers))


def test_lcm(effort, compare, record, tmp_path):
    count, path = COUNT // 100 if effort.quick else COUNT // 10, tmp_path / "many.lcmlog"
    log = lcm.EventLog(str(path), "w")
    for number in range(count):
        log.write_event(START // 1000 + number, "DOUBLES", LCM_DOUBLES.message)
    log.close()
    decode, channel = lcm_peers(LCM_DOUBLES)[0].decode, rj.open(path)["DOUBLES"]
    assert channel.to_arrow().num_rows == sum(1 for each in lcm.EventLog(str(path)) if decode(each.data)) == count

    def theirs():
        return sum(1 for each in lcm.EventLog(str(path)) if decode(each.data))

    contenders = [
        Contender(TABLE, "ours", "a table of all fields and two times", effort.call(channel.to_arrow, messages=count, clock=process_time)),
        Contender("lcm with lcm-gen", "peer", "one object a message", effort.call(theirs, messages=count, clock=process_time)),
    ]
    outcome = compare(CHAPTER, f"{count:,} messages of 1000 float64 in a log of LCM", contenders)
    ratio = outcome.ratio(TABLE, "lcm with lcm-gen")
    record("1000 float64, log of LCM to Arrow, against lcm", ratio, None, "of it", f"{outcome.took(TABLE).median:.0f} ns a message")


def told(record, outcome, what, at_most, peers):
    took = outcome.took(TABLE).median
    record(what, outcome.ratio(TABLE, ALONE), None, "x decompression alone", f"{took:.0f} ns a message of processor, on two threads")
    alone = outcome.took(TABLE + ONE).median
    record(f"{what}, on one core", outcome.ratio(TABLE + ONE, ALONE), None, "x decompression alone", f"{alone:.0f} ns a message")
    elapsed = outcome.took(TABLE + ELAPSED).median
    ratio = outcome.ratio(TABLE + ELAPSED, ALONE + ELAPSED)
    record(f"{what}, elapsed", ratio, at_most, "x decompression alone", f"{elapsed:.0f} ns a message; needs two idle cores")
    fastest = outcome.fastest(peers)
    record(f"{what}, against the fastest Python peer", outcome.ratio(TABLE, fastest), 1 / 20, "of it", fastest)
