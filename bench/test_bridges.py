"""What a bridge saves: one call from bytes to bytes, against a decoder's call and an encoder's."""

from __future__ import annotations

from itertools import repeat

import numpy as np
import pytest

import rosetta_jit as rj
from bench.contest import Contender

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
