"""Formats that are read message by message: recordings, delimited protobuf, RSB's TIDE."""

from __future__ import annotations

import struct
import subprocess
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import LogError

from .made import expected, time_of, values, write_old_bag

RECORDINGS = Path(rj.__file__).parent / "demo" / "recordings"


def test_a_recording():
    log = rj.open(RECORDINGS / "icub-yarp3" / "torso_state.rec.xz")
    torso = log["torso_state", "yarp/icub/torso_state.mapping"]
    assert torso.count == 500
    assert torso.to_arrow(["angles"]).num_rows == 500
    assert torso["log_time"].shape == (500,)


def varint(value):
    octets = bytearray()
    while value > 0x7F:
        octets.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*octets, value])


def test_delimited_protobuf(tmp_path):
    """Protobuf's own package writes; its messages are longer than a window, too."""
    from google.protobuf.internal.encoder import _VarintBytes
    from google.protobuf.wrappers_pb2 import BytesValue

    texts = [b"a" * size for size in (0, 1, 127, 128, 3_000_000, 5)]
    path = tmp_path / "a.delimited"
    messages = [BytesValue(value=each).SerializeToString() for each in texts]
    path.write_bytes(b"".join(_VarintBytes(len(each)) + each for each in messages))
    (tmp_path / "own.proto").write_text('syntax = "proto3"; package t; message Octets { bytes value = 1; }')  # as BytesValue
    log = rj.open(path, imports=["own.proto"], search_path=[tmp_path])
    assert [bytes(each.value) for each in log["a", "t.Octets"]] == texts
    with pytest.raises(LogError, match=r"does not say of which type(.|\n)*rosetta-jit infer .*a.delimited --topic a` drafts one"):
        log["a"].to_arrow()
    whole = path.read_bytes()
    for cut in (1, 5, 9, len(whole) - 4):
        path.write_bytes(whole[:cut])
        found = []
        read = [each.message for each in rj.open(path, on_problem=found.append).messages(raw=True)]
        assert read == messages[: whole_in(cut, messages)]
        assert {each.code for each in found} <= {"log-cut"}


def whole_in(size, messages):
    count, at = 0, 0
    for each in messages:
        at += len(varint(len(each))) + len(each)
        count += at <= size
    return count


def tide(channels, entries):
    """A file as the description of the format has it (rsbag-cl's specification)."""

    def block(tag, content):
        return tag + struct.pack("<Q", len(content)) + content

    def text(value):
        return struct.pack("<I", len(value)) + value

    parts = [block(b"TIDE", bytes([0, 0]) + bytes(8))]
    for number, name, type_ in channels:
        parts.append(
            block(b"CHAN", struct.pack("<IB", number, len(name)) + name + text(type_) + text(b"source") + text(b"config") + text(b""))
        )
    packed = b"".join(struct.pack("<IQI", channel, time, len(data)) + data for channel, time, data in entries)
    return b"".join([*parts, block(b"CHNK", struct.pack("<IIQQB", 1, len(entries), 0, 9, 0) + packed)])


def event(payload, sent_us):
    """A Notification with a payload and the time at which it was sent, and its id, which is of no meaning here."""
    meta = b"\x10" + varint(1) + b"\x18" + varint(sent_us)
    return b"\xe2\x06\x02\x10\x00" + b"\x4a" + varint(len(payload)) + payload + b"\x7a" + varint(len(meta)) + meta


def test_tide(tmp_path):
    angles = [struct.pack("<BB2f", 10, 8, number, 1.5) for number in range(5)]
    channels = [(7, b"/arm/:.rst.kinematics.JointAngles", b"rsb-event-0.9:.rst.kinematics.JointAngles"), (9, b"raw", b"MYTYPE")]
    entries = [(7, 10**18 + number, event(each, 1_700_000_000_000_000 + number)) for number, each in enumerate(angles)] + [(9, 5, b"\1\2")]
    path = tmp_path / "a.tide"
    path.write_bytes(whole := tide(channels, entries))
    log = rj.open(path)
    assert log.topics == ("/arm/", "raw")
    assert [each.message for each in log.messages(["/arm/"], raw=True)] == angles
    assert log["/arm/"].to_arrow(["angles"])["angles"].to_pylist() == [[number, 1.5] for number in range(5)]
    assert log["/arm/"]["publish_time"].astype(int).tolist() == [(1_700_000_000_000_000 + number) * 1000 for number in range(5)]
    assert [each.message for each in log.messages(["raw"], raw=True)] == [b"\1\2"]
    before = 0
    for size in range(22, len(whole)):
        path.write_bytes(whole[:size])
        found = []
        count = len(list(rj.open(path, on_problem=found.append).messages(raw=True)))
        assert before <= count <= len(entries)
        before = count
    assert before == len(entries) - 1
    path.write_bytes(whole[:22] + b"garbage" + whole[22:])
    found.clear()
    assert len(list(rj.open(path, on_problem=found.append).messages(raw=True))) == len(entries)
    assert [each.code for each in found] == ["log-damaged"]


def test_bags_of_version_1_2(tmp_path):
    """Where it is installed, ROS's own rosbag 1.15 reads the same from what the test writes."""
    path = write_old_bag(tmp_path / "old.bag", 30)
    log = rj.open(path)
    assert values(log.messages()) == list(expected(30))
    assert (log.facts["version"], log["/a"].type, log["/a"].count) == ("1.2", "t/Point", 30)
    assert log["/a"]["x"].tolist() == [number / 4 for number in range(30)]
    found = log.messages(["/b"], start=time_of(10), raw=True)
    assert [each.time for each in found] == [time_of(number) + 1 for number in range(10, 30, 5)]
    theirs = subprocess.run(["/usr/bin/python3", "-c", THEIRS, path], capture_output=True, text=True, check=False)
    if theirs.returncode == 0:
        assert theirs.stdout.splitlines() == [
            f"{time} {topic} {value[0] if topic == '/a' else value}" for time, topic, value in expected(30)
        ]


THEIRS = """
import rosbag, sys
with rosbag.Bag(sys.argv[1]) as bag:
    assert bag.version == 102
    for topic, message, time in bag._reader.read_messages(None, None, None, None, False):
        print(time.to_nsec(), topic, message.x if topic == "/a" else message.data)
"""


def test_damaged_bags_of_version_1_2(tmp_path):
    """Cut anywhere, what is whole before is read."""
    data = write_old_bag(tmp_path / "old.bag", 6).read_bytes()
    everything, before = list(rj.open(tmp_path / "old.bag").messages(raw=True)), 0
    path = tmp_path / "cut.bag"
    for size in range(13, len(data), 37):
        path.write_bytes(data[:size])
        found = []
        messages = list(rj.open(path, on_problem=found.append).messages(raw=True))
        assert messages == everything[: len(messages)]
        assert len(messages) >= before
        before = len(messages)
    assert before == len(everything)


def test_a_bag_of_version_1_2_without_the_last_record(tmp_path):
    """The index of one topic is whole, and that of the other is missing."""
    data, path = write_old_bag(tmp_path / "old.bag", 6).read_bytes(), tmp_path / "cut.bag"
    for size in range(data.rindex(b"op=\4") - 60, len(data)):
        path.write_bytes(data[:size])
        found = []
        assert len(list(rj.open(path, on_problem=found.append).messages(raw=True))) == 8
        assert {each.code for each in found} <= {"log-cut", "log-index"}
        assert found
