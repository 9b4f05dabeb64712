"""Small logs, written by the real libraries: a point (float64 x, string name) on `/a`, texts on `/b`."""

from __future__ import annotations

import struct

import lcm
from mcap.writer import CompressionType, Writer
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

import rosetta_jit as rj
from rosetta_jit.logs.bag.writer import record, u32

START = 1_700_000_000 * 10**9
STEP = 10_000_000
POINT, TEXT = "float64 x\nstring name\n", "string data\n"
COMPRESSIONS = {"none": CompressionType.NONE, "zstd": CompressionType.ZSTD, "lz4": CompressionType.LZ4}
BAGS = {"none": None, "bz2": BagWriter.CompressionFormat.BZ2, "lz4": BagWriter.CompressionFormat.LZ4}


def time_of(number):
    return START + number * STEP


def expected(count):
    """What the logs hold: time, topic, value."""
    for number in range(count):
        yield time_of(number), "/a", (number / 4, f"p{number}")
        if number % 5 == 0:
            yield time_of(number) + 1, "/b", f"text {number}"


def encoders(encoding):
    names = ("t/msg/Point", "t/msg/Text") if encoding == "cdr" else ("t/Point", "t/Text")
    point, text = (rj.Encoder.of(name, encoding=encoding, schema=schema) for name, schema in zip(names, (POINT, TEXT), strict=True))

    def encode(topic, value):
        if topic == "/a":
            return point(point.holder_type.from_dict({"x": value[0], "name": value[1]}))
        return text(text.holder_type.from_dict({"data": value}))

    return encode


def write_mcap(path, count, compression="zstd", *, chunked=True, chunk_size=1500, finish=True, index=True):
    encode = encoders("cdr")
    indexes = {} if index else {"use_chunking": chunked, "use_statistics": False, "use_summary_offsets": False, "repeat_channels": False}
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=chunk_size, compression=COMPRESSIONS[compression], **{"use_chunking": chunked} | indexes)
        writer.start(profile="ros2")
        channels = {}
        for topic, name, schema in (("/a", "t/msg/Point", POINT), ("/b", "t/msg/Text", TEXT)):
            number = writer.register_schema(name, "ros2msg", schema.encode())
            channels[topic] = writer.register_channel(topic, "cdr", number)
        for time, topic, value in expected(count):
            writer.add_message(channels[topic], log_time=time, publish_time=time - 7, data=encode(topic, value))
        if finish:
            writer.finish()
    return path


def write_bag(path, count, compression="none"):
    encode, types = encoders("ros1"), get_typestore(Stores.EMPTY)
    types.register(get_types_from_msg(POINT, "t/msg/Point") | get_types_from_msg(TEXT, "t/msg/Text"))
    writer = BagWriter(path)
    writer.chunk_threshold = 1500
    if BAGS[compression] is not None:
        writer.set_compression(BAGS[compression])
    with writer:
        connections = {
            topic: writer.add_connection(topic, name, typestore=types) for topic, name in (("/a", "t/msg/Point"), ("/b", "t/msg/Text"))
        }
        for time, topic, value in expected(count):
            writer.write(connections[topic], time, encode(topic, value))
    return path


def write_old_bag(path, count):
    """A bag of version 1.2; ROS's rosbag 1.15 reads it: see `test_small_formats`."""
    encode, out, places = encoders("ros1"), bytearray(b"#ROSBAG V1.2\n"), {"/a": [], "/b": []}
    types = {"/a": ("t/Point", POINT), "/b": ("t/Text", TEXT)}
    sums = {topic: rj.Decoder.of(name, encoding="ros1", schema=text).holder_type._md5sum for topic, (name, text) in types.items()}
    header = {"op": b"\3", "index_pos": bytes(8)}
    out += record(b" " * (4096 - len(record(b"", **header))), **header)
    for time, topic, value in expected(count):
        name, text = types[topic]
        about = {"topic": topic.encode(), "type": name.encode(), "md5": sums[topic].encode()}
        seconds, nanoseconds = divmod(time, 10**9)
        places[topic].append((seconds, nanoseconds, len(out)))
        if len(places[topic]) == 1:
            out += record(b"", op=b"\1", **about, **{"def": text.encode()})
        out += record(encode(topic, value), op=b"\2", **about, sec=u32(seconds), nsec=u32(nanoseconds))
    index = len(out)
    for topic, found in places.items():
        entries = b"".join(struct.pack("<IIQ", *each) for each in found)
        name = types[topic][0].encode()
        out += record(entries, op=b"\4", topic=topic.encode(), type=name, ver=u32(0), count=u32(len(found)))
    header["index_pos"] = struct.pack("<Q", index)
    out[13 : 13 + 4096] = record(b" " * (4096 - len(record(b"", **header))), **header)
    path.write_bytes(out)
    return path


LCM_TYPES = "package t;\nstruct point_t { double x; string name; }\nstruct text_t { string data; }\n"


def lcm_encoders():
    point, text = (rj.Encoder.of(f"t.{name}", encoding="lcm", schema=LCM_TYPES) for name in ("point_t", "text_t"))

    def encode(topic, value):
        if topic == "/a":
            return point(point.holder_type.from_dict({"x": value[0], "name": value[1]}))
        return text(text.holder_type.from_dict({"data": value}))

    return encode


def write_lcm(path, count):
    encode, log = lcm_encoders(), lcm.EventLog(str(path), "w", overwrite=True)
    for time, topic, value in expected(count):
        log.write_event(time // 1000, topic, encode(topic, value))
    log.close()
    return path


def values(messages):
    """Time, topic and value of messages that were read."""
    return [(each.time, each.topic, (each.message.x, each.message.name) if each.topic == "/a" else each.message.data) for each in messages]
