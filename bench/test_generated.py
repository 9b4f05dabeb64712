"""Generated Python against what the frameworks generate for Python, of the same message: for these two a person writes the same program."""

from __future__ import annotations

import json
import struct

import pytest

from bench import processes
from bench.contest import Contender
from bench.figures import Spread
from bench.peers import generated_python, python_peers
from bench.report import words
from bench.subjects import LCM_EXAMPLE, LCM_MATRICES, SUBJECTS, Subject
from bench.tagged import TAGGED

CHAPTER = "Generated Python"
WHO = generated_python.WHO
PEERS = {"ros1": "genpy", "lcm": "lcm-gen"}
AT_MOST = 1
PURE = "protobuf's pure Python"
"""protobuf without its C: a process has either one or the other."""

TIMED = """
import json, os, sys, time
from bench.peers import generated_python, protobuf
from bench.subjects import SCENE, SUBJECTS
from bench.tagged import TAGGED
subject = {**SUBJECTS, "Scene": SCENE, **TAGGED}[sys.argv[1]]
(ours,), theirs = generated_python.peers(subject), protobuf.message_class(subject)
from google.protobuf.internal import api_implementation
assert api_implementation.Type() == "python"
jobs = {
    "decode": (ours.decode, subject.message, theirs.FromString, subject.message),
    "encode": (ours.encode, ours.decode(subject.message), theirs.SerializeToString, theirs.FromString(subject.message)),
}
def took(call, given, count):
    begin = time.process_time()
    for _ in range(count):
        call(given)
    return (time.process_time() - begin) / count
found = {}
for job, (one, this, other, that) in jobs.items():
    count = max(1, int(0.01 / max(took(other, that, 3), 1e-6)))
    found[job] = [took(one, this, count) / took(other, that, count) for _ in range(int(sys.argv[2]))]
print(json.dumps(found))
"""


def text(value: str) -> bytes:
    return struct.pack("<I", len(value)) + value.encode()


def joint_state(joints: int) -> bytes:
    names, numbers = b"".join(text(f"joint_{each}") for each in range(joints)), [each / 7 for each in range(joints)]
    count = struct.pack("<I", joints)
    return struct.pack("<III", 7, 1, 2) + text("torso") + count + names + 3 * (count + struct.pack(f"<{joints}d", *numbers))


def diagnostics(statuses: int) -> bytes:
    values = struct.pack("<I", 3) + 3 * (text("temperature") + text("36.6"))
    status = b"\1" + text("left arm") + text("is warm") + text("board 17") + values
    return struct.pack("<III", 7, 1, 2) + text("") + struct.pack("<I", statuses) + statuses * status


def mesh(triangles: int) -> bytes:
    """A list of structs that are one array, and one of points."""
    count = struct.pack("<I", triangles)
    return (
        count + struct.pack(f"<{3 * triangles}I", *range(3 * triangles)) + count + struct.pack(f"<{3 * triangles}d", *range(3 * triangles))
    )


MESSAGES = {
    "Twist": Subject("geometry_msgs/Twist", "ros1", struct.pack("<6d", *range(6))),
    "JointState, 7 joints": Subject("sensor_msgs/JointState", "ros1", joint_state(7)),
    "DiagnosticArray, 20 statuses": Subject("diagnostic_msgs/DiagnosticArray", "ros1", diagnostics(20)),
    "Mesh, 50 triangles": Subject("shape_msgs/Mesh", "ros1", mesh(50)),
    "LCM example_t": LCM_EXAMPLE,
    "LCM multidim_array_t, 10 x 10 x 10": LCM_MATRICES,
    **{
        name: SUBJECTS[name]
        for name in ("Imu", "JointState, 32 joints", "LaserScan 1080", "PoseArray 1000", "LCM, 1,000 big-endian doubles")
    },
}


@pytest.mark.parametrize("job", ["decode", "encode"])
@pytest.mark.parametrize("name", MESSAGES)
def test_against_what_frameworks_generate(name, job, effort, compare, record):
    subject = MESSAGES[name]
    against = PEERS[subject.encoding]
    (peer,) = [each for each in python_peers(subject) if f"({against}" in each.who]
    (ours,) = generated_python.peers(subject)
    values = {each.who: each.decode(subject.message) for each in (ours, peer)}
    assert ours.encode(values[WHO]) == peer.encode(values[peer.who]) == subject.message

    def timed(each):
        return effort.call(each.decode, subject.message) if job == "decode" else effort.call(each.encode, values[each.who])

    makes = {each.who: each.makes if job == "decode" else "bytes, anew" for each in (ours, peer)}
    contenders = [Contender(WHO, "ours", makes[WHO], timed(ours)), Contender(peer.who, "peer", makes[peer.who], timed(peer))]
    outcome = compare(CHAPTER, f"{name}, {job}d", contenders)
    took = f"{words.time(outcome.took(WHO).median)} against {words.time(outcome.took(peer.who).median)}"
    record(f"{name}, generated Python, {job}d", outcome.ratio(WHO, peer.who), AT_MOST, f"x {against}", took)


@pytest.mark.parametrize("name", ["RST JointAngles, packed", "RST JointAngles, unpacked", "RST Image 320x240", "Scene", *TAGGED])
def test_against_pure_protobuf(name, effort, record):
    rounds = str(max(5, effort.rounds))
    said = processes.run("-c", TIMED, name, rounds, PROTOCOL_BUFFERS_PYTHON_IMPLEMENTATION="python")
    for job, ratios in json.loads(said).items():
        record(f"{name}, generated Python, {job}d", Spread.of(tuple(ratios)), AT_MOST, f"x {PURE}", messages=1)
