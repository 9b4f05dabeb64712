"""What a bridge saves: one call from bytes to bytes, against a decoder's call and an encoder's. What one that runs adds, and carries."""

from __future__ import annotations

from itertools import repeat

import numpy as np
import pytest

import rosetta_jit as rj
from bench.bridge_load.latency import latencies
from bench.bridge_load.throughput import images, shared, topics
from bench.contest import Contender
from bench.figures import Spread

CHAPTER, SHORT = "Bridges", "an iCub's torso, YARP to RST"
OURS, TWO, MOVE = "rosetta_jit, a bridge", "rosetta_jit, decode and encode", "memmove"
AT_MOST = 0.8
LOOP = 20
"""Both are called as a program would, in a loop: a function around them would take as long as they do."""


def torso():
    """Three angles of a bottle, in radians, as protobuf has them."""
    mapping = "yarp/icub/torso_state.mapping"
    message = rj.Encoder(mapping, encoding="yarp4")({"angles": [0.25, -1.0, 2.0]})
    decode = rj.Decoder(mapping, encoding="yarp4"), rj.Encoder.of("rst.kinematics.JointAngles")
    return message, *decode, rj.Bridge(mapping, decode={"encoding": "yarp4"})


def image():
    """A camera image of ROS 2, 320 x 240 pixels, in another version of CDR."""
    return of_ros2("sensor_msgs/msg/Image", {"height": 240, "width": 320, "encoding": "rgb8", "step": 960, "data": bytes(230_400)})


def cloud():
    """A megabyte of points of ROS 2."""
    return of_ros2("sensor_msgs/msg/PointCloud2", {"height": 1, "width": 62_500, "point_step": 16, "data": bytes(1_000_000)})


def of_ros2(type_, values):
    decode, encode = rj.Decoder.of(type_, encoding="cdr"), rj.Encoder.of(type_, encoding="cdr2")
    bridge = rj.Bridge.of(type_, decode={"encoding": "cdr"}, encode={"encoding": "cdr2"})
    return rj.Encoder.of(type_, encoding="cdr")(values), decode, encode, bridge


KINDS = {SHORT: torso, "an image of 230 KB, CDR to CDR 2": image, "1 MB of points, CDR to CDR 2": cloud}


@pytest.mark.parametrize("kind", KINDS)
def test_bridges(kind, effort, compare, record):
    message, decode, encode, bridge = KINDS[kind]()
    assert bridge(message) == encode(decode(message))

    def one_call():
        for _ in repeat(None, LOOP):
            bridge(message)

    def two_calls():
        for _ in repeat(None, LOOP):
            encode(decode(message))

    source, target = np.frombuffer(message, np.uint8), np.empty(len(message), np.uint8)
    contenders = [
        Contender(OURS, "ours", "bytes, anew", effort.call(one_call, messages=LOOP)),
        Contender(TWO, "limit", "bytes, anew", effort.call(two_calls, messages=LOOP)),
        Contender(MOVE, "limit", "the message, elsewhere", effort.call(np.copyto, target, source)),
    ]
    outcome = compare(CHAPTER, kind, contenders)
    record(f"bridge, {kind}", outcome.ratio(OURS, TWO), AT_MOST, "x decode and encode", f"{outcome.took(OURS).median:.0f} ns")


def test_one_call(effort, compare, record):
    message, _, _, bridge = torso()
    contenders = [
        Contender(OURS, "ours", "bytes, anew", effort.call(bridge, message)),
        Contender("len()", "limit", "a number", effort.call(len, message)),
    ]
    outcome = compare(CHAPTER, f"{SHORT}, one call", contenders)
    record(f"bridge, {SHORT}, one call", outcome.ratio(OURS, "len()"), 3.6, "x len()", f"{outcome.took(OURS).median:.0f} ns")


def test_many(effort, compare, record):
    """Batches, from one buffer to another."""
    message, decode, encode, bridge = torso()
    count = 1000
    offsets = np.arange(count + 1) * len(message)
    messages = message * count
    one, two = bridge.many(messages, offsets), encode.many(decode.many(messages, offsets))
    assert bytes(one[0]) == bytes(two[0])
    contenders = [
        Contender(OURS, "ours", "bytes, anew", effort.call(bridge.many, messages, offsets, messages=count)),
        Contender(TWO, "limit", "bytes, anew", effort.call(lambda: encode.many(decode.many(messages, offsets)), messages=count)),
    ]
    outcome = compare(CHAPTER, f"{SHORT}, 1000 at once", contenders)
    record(f"bridge.many, {SHORT}", outcome.ratio(OURS, TWO), AT_MOST, "x decode and encode", f"{outcome.took(OURS).median:.0f} ns")


def test_latency(effort, record):
    """Rounds of messages, the 99th percentile of each, and what it is above that of the same bytes that a loop in Python copies meanwhile.

    Both are slow when the machine is, one by as many times as the other: a ratio is told besides.
    """
    rounds, count = (3, 300) if effort.quick else (9, 1000)
    found, is_first = latencies(rounds * count)
    mapped, copied = np.percentile(np.split(found, rounds), 99, axis=1).T
    said = f"{np.median(mapped):.0f} us" + ("" if is_first else ", other programs had their turns")
    ratio = Spread.of((mapped / copied).tolist())
    record("a running bridge, latency (p99)", ratio, None, "x that of a copy from socket to socket", said, messages=1)
    said = f"median {np.subtract(*np.median(found, axis=0)):.0f} us"
    added = Spread.of((mapped - copied).tolist())
    record("a running bridge, latency added (p99)", added, 50, "us over a copy from socket to socket", said, messages=1)


def test_topics(effort, record):
    found = topics(seconds=2.0 if effort.quick else 10.0)
    assert (found["lost"], found["not_taken"]) == (0, 0)
    said = f"{found['carried_per_s']:.0f} a second of 100 topics at 1 kHz; a core at 10"
    measured = Spread.of([found["cpu_us_a_message"]])
    record("a running bridge, 200 bytes, YARP 4 to 3", measured, 10, "us of a core a message", said, messages=1)


@pytest.mark.parametrize("way", [images, shared], ids=["TCP", "shared memory"])
def test_images(way, effort, record, request):
    if way is shared:
        pytest.importorskip("iceoryx2")
    found = way(seconds=1.0 if effort.quick else 5.0)
    assert found["lost"] == 0
    said = f"{found['gigabytes_per_s']:.2f} GB/s; a GB/s and core at 1"
    what = f"a running bridge, images of 1 MB, {request.node.callspec.id}"
    record(what, Spread.of([found["cpu_us_an_image"] / 1000]), 1, "ms of a core an image", said, messages=1)
