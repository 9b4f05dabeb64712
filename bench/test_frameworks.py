"""Each framework's messages into a holder that is used again, one Python call a message, and back into a buffer that is given."""

from __future__ import annotations

import ctypes
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import rosetta_jit as rj
from bench import framework_messages as messages
from bench.ratios import best_call_ns, best_ns

ROSCPP = Path(__file__).resolve().parent.parent / "build" / "native" / "libroscpp_peer.so"

SUBJECTS = {
    "Imu": messages.IMU,
    "JointState, 32 joints": messages.JOINT_STATE,
    "LaserScan 1080": messages.LASER_SCAN,
    "PoseArray 1000": messages.POSE_ARRAY,
    "Image 640x480": messages.IMAGE,
    "PointCloud2, 100,000 points": messages.POINT_CLOUD,
    "LCM, 1,000 big-endian doubles": messages.LCM_DOUBLES,
    "RST JointAngles, packed": messages.RST_ANGLES_PACKED,
    "RST JointAngles, unpacked": messages.RST_ANGLES,
    "RST Image 320x240": messages.RST_IMAGE,
    "CORBA TimedDoubleSeq 1000": messages.CORBA_DOUBLES,
    "OROCOS vector<double> 1000": messages.OROCOS_DOUBLES,
}


def decoder(subject, **options):
    return rj.Decoder.of(subject.type, encoding=subject.encoding, **subject.options, **options)


def moved(message):
    """A memmove of a message's bytes, and the same call with nothing to move."""
    target = ctypes.create_string_buffer(len(message))
    return partial(ctypes.memmove, target, message, len(message)), partial(ctypes.memmove, target, message, 0)


def limits(subject, decode):
    """Nanoseconds of a decode, of `len()`, and of moving the bytes."""
    move, nothing = moved(subject.message)
    calls = best_call_ns({"decode": (decode, subject.message), "len": (len, subject.message)})
    moves = best_ns({"move": move, "nothing": nothing})
    return calls["decode"], calls["len"], max(moves["move"] - moves["nothing"], 1.0)


@pytest.mark.parametrize(("name", "lens"), [("Imu", 3), ("RST JointAngles, packed", 3), ("RST JointAngles, unpacked", 5)])
def test_small_messages_against_len(name, lens, record):
    subject = SUBJECTS[name]
    took, len_, move = limits(subject, decoder(subject))
    allowed = lens * len_ + (move if name == "Imu" else 0)
    record(f"{name}, decode", took / len_, allowed / len_, "x len()", f"{took:.0f} ns")


@pytest.mark.parametrize(
    ("name", "moves"),
    [
        ("LaserScan 1080", 2),
        ("PoseArray 1000", 1.5),
        ("LCM, 1,000 big-endian doubles", 2),
        ("CORBA TimedDoubleSeq 1000", 1.5),
        ("OROCOS vector<double> 1000", 1.5),
    ],
)
def test_arrays_against_memmove(name, moves, record):
    subject = SUBJECTS[name]
    took, len_, move = limits(subject, decoder(subject))
    record(f"{name}, decode", took / move, moves + len_ / move, "x memmove", f"{took:.0f} ns, the call in the limit")


@pytest.mark.parametrize("name", ["Image 640x480", "PointCloud2, 100,000 points", "RST Image 320x240"])
def test_blobs_against_memmove(name, record):
    subject = SUBJECTS[name]
    decode = decoder(subject)
    source, target = np.frombuffer(subject.message, np.uint8), np.empty(len(subject.message), np.uint8)
    times = best_ns({"decode": lambda: decode(subject.message), "move": lambda: np.copyto(target, source)})
    record(f"{name}, copied", times["decode"] / times["move"], 1.15, "x memmove", f"{times['decode'] / 1000:.1f} µs")


@pytest.mark.parametrize("name", ["Image 640x480", "PointCloud2, 100,000 points", "RST Image 320x240"])
def test_borrowed_blobs_against_len(name, record):
    subject = SUBJECTS[name]
    times = best_call_ns({"decode": (decoder(subject, borrow=True), subject.message), "len": (len, subject.message)})
    record(f"{name}, borrowed", times["decode"] / times["len"], 4, "x len()", f"{times['decode']:.0f} ns")


@pytest.mark.parametrize("name", SUBJECTS)
def test_encoders_against_decoders(name, record):
    subject = SUBJECTS[name]
    decode = decoder(subject)
    encode = rj.Encoder.of(subject.type, encoding=subject.encoding, **subject.options)
    holder, buffer = decode(subject.message), bytearray(len(subject.message))
    assert encode(holder) == subject.message
    times = best_ns({"decode": lambda: decode(subject.message), "encode": lambda: encode(holder, buffer, 0)})
    record(f"{name}, encode", times["encode"] / times["decode"], 1.5, "x its decode", f"{times['encode']:.0f} ns")


# --- peers -------------------------------------------------------------------------------------------------------------------


def python_peers(subject):
    """Decoders of ROS 1 messages that are installed."""
    found = {}
    rosbags = pytest.importorskip("rosbags.typesys")
    store = rosbags.get_typestore(rosbags.Stores.ROS1_NOETIC)
    found["rosbags"] = lambda: store.deserialize_ros1(subject.message, subject.rosbags)
    try:
        from mcap.records import Schema
        from mcap_ros1.decoder import DecoderFactory
    except ImportError:
        return found
    text, _ = store.generate_msgdef(subject.rosbags, ros_version=1)
    decode = DecoderFactory().decoder_for("ros1", Schema(1, text.encode(), "ros1msg", subject.type))
    found["mcap-ros1-support (genpy)"] = lambda: decode(subject.message)
    return found


@pytest.mark.parametrize(("name", "part"), [("Imu", 50), ("JointState, 32 joints", 30), ("PoseArray 1000", None), ("LaserScan 1080", None)])
def test_against_python_peers(name, part, record):
    subject = SUBJECTS[name]
    decode = decoder(subject)
    times = best_ns({"ours": lambda: decode(subject.message), **python_peers(subject)}, rounds=5)
    ours = times.pop("ours")
    peer = min(times, key=times.get)
    share = None if part is None else 1 / part
    record(f"{name}, against the fastest Python peer", ours / times[peer], share, "of it", f"{peer}: {times[peer] / 1000:.1f} µs")


def test_joint_state_against_roscpp(record):
    if not ROSCPP.exists():
        pytest.skip("roscpp's headers are not installed")
    library = ctypes.CDLL(str(ROSCPP))
    library.joint_state_decode_ns.restype = ctypes.c_double
    subject = messages.JOINT_STATE
    ours = best_call_ns({"decode": (decoder(subject), subject.message)})["decode"]
    arguments = (subject.message, ctypes.c_int64(len(subject.message)), ctypes.c_int64(200_000))
    theirs = min(library.joint_state_decode_ns(*arguments) for _ in range(7))
    record("JointState, 32 joints, against roscpp in C++", ours / theirs, 1.2, "x", f"{theirs:.0f} ns, object used again")
