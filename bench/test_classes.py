"""Generated C++ that fills classes of roscpp, rclcpp, protoc and lcm-gen, against the frameworks' own code, of ROS 2 Fast CDR."""

from __future__ import annotations

import pytest

from bench.contest import Contender, Outcome, comparison
from bench.peers import generated_classes as peers
from bench.peers.generated_classes import Messages
from bench.report import words
from bench.subjects import (
    DIAGNOSTICS,
    FLAGS_T,
    LCM_BOOLS,
    LCM_DOUBLES,
    LCM_EXAMPLE,
    LCM_FLAGS,
    LCM_MATRICES,
    LCM_NODES,
    LISTS,
    MARKERS,
    ROS_2,
    SCENE,
    SEVERAL_VARINTS,
    SHORT,
    SUBJECTS,
)
from rosetta_jit.api.options import type_request

CHAPTER = "Generated C++ in frameworks' classes"
OURS = "rosetta_jit, generated C++"
PEERS = {"ros1": "roscpp", "ros2": "Fast CDR" if peers.has_fast_cdr() else "roscpp", "protobuf": "protobuf", "lcm": "lcm-gen"}
JOBS = {
    "decode": ("decoded", "an object, used again", 1),
    "anew": ("decoded into a new object", "an object, made anew", None),
    "encode": ("encoded", "a buffer that is given", None),
    "turn": ("decoded, one of many in turn", "an object, used again", 1),
}
"""What is done, what each makes, and the target. Messages of a few bytes are read in turn, too."""
NESTED = {"DiagnosticArray, 20 statuses": DIAGNOSTICS, "MarkerArray, 10 markers": MARKERS}
"""Texts and structs in lists of lists; Debian has no struct of a TFMessage."""
MATRICES = "LCM multidim_array_t, 10 x 10 x 10"
NODES = "LCM node_t, a tree of 121"
WRITTEN_AS_QUICKLY = frozenset({*SEVERAL_VARINTS, *LISTS, *SHORT, *NESTED, MATRICES, NODES})
"""What has a target for encoding, too."""
WITHOUT_TARGET = frozenset({"Float64", "Bool", "LCM, 64 bools"})
"""What has none for decoding, as it takes as long in both, or longer: docs/cpp.md says why."""
ROS = ("Imu", "JointState, 32 joints", "LaserScan 1080", "PoseArray 1000", "Image 640x480")
PROTOBUF = {
    "RST JointAngles, packed": "angles.proto",
    "RST JointAngles, unpacked": "angles.proto",
    "RST Image 320x240": "rst/vision/Image.proto",
    "Scene": "scene.proto",
    **dict.fromkeys(SEVERAL_VARINTS, "angles.proto"),
    **dict.fromkeys(LISTS, "texts.proto"),
}
LCM = {
    "LCM example_t": (LCM_EXAMPLE, peers.IDL / "lcm" / "exlcm" / "example_t.lcm"),
    "LCM, 1,000 doubles": (LCM_DOUBLES, peers.IDL / "lcm" / "rjtest" / "doubles_t.lcm"),
    "LCM, 64 bools": (LCM_FLAGS, FLAGS_T),
    "LCM bools_t, 6 x 6": (LCM_BOOLS, peers.IDL / "lcm" / "lcmtest" / "bools_t.lcm"),
    MATRICES: (LCM_MATRICES, peers.IDL / "lcm" / "lcmtest" / "multidim_array_t.lcm"),
    NODES: (LCM_NODES, peers.IDL / "lcm" / "exlcm" / "node_t.lcm"),
}


@pytest.fixture
def against(tmp_path, effort, found, record):
    """Call it with a row's name, a request, whose classes, and the messages: each job becomes a row."""

    def measure(name, request, holder, messages, **given):
        taken = peers.measured(peers.program(request, holder, tmp_path, **given), messages, effort.rounds, effort.round_s)
        whose = {OURS: "ours", f"{PEERS[holder]} in C++": "theirs"}
        for job, (done, makes, at_most) in ((each, how) for each, how in JOBS.items() if f"ours {each}" in taken):
            outcome = Outcome({who: taken[f"{each} {job}"] for who, each in whose.items()})
            contenders = [Contender(who, "ours" if each == "ours" else "peer", makes, lambda: 0.0) for who, each in whose.items()]
            found("comparisons", comparison(CHAPTER, f"{name}, {done}", contenders, outcome))
            mine, other = (words.time(outcome.took(who).median) for who in whose)
            what, said = f"{name}, generated C++, {done}", f"{mine} against {other}"
            aim = 1 if job == "encode" and name in WRITTEN_AS_QUICKLY else at_most
            record(
                what,
                outcome.ratio(*whose),
                None if name in WITHOUT_TARGET and job != "turn" else aim,
                f"x {PEERS[holder]}",
                said,
                messages=1,
            )

    return measure


@pytest.mark.skipif(not peers.installed("ros1"), reason="roscpp is not installed")
@pytest.mark.parametrize("name", [*ROS, *NESTED, *SHORT])
def test_structs_of_roscpp(name, against):
    subject = {**SUBJECTS, **NESTED, **SHORT}[name]
    request = type_request("decode", subject.type, {"encoding": "ros1"})
    against(name, request, "ros1", Messages(subject.message, subject.message))


@pytest.mark.skipif(not peers.installed("ros2"), reason="rosidl, which makes the structs of rclcpp, is not installed, or roscpp is not")
@pytest.mark.parametrize("name", ROS)
def test_structs_of_rclcpp(name, against):
    """ROS 2's own reader is Fast CDR. Where that is not installed, roscpp stands for it, which reads the same data as ROS 1 has them.

    Both read the encapsulation first, as rmw_fastrtps does.
    """
    older, newer = SUBJECTS[name], ROS_2[f"{name}, ROS 2"]
    request = type_request("decode", newer.type, {"encoding": "cdr"})
    theirs = newer.message if peers.has_fast_cdr() else peers.ENCAPSULATION + older.message
    against(f"{name}, CDR", request, "ros2", Messages(newer.message, theirs), peer=older.type)


@pytest.mark.skipif(not peers.installed("protobuf"), reason="protoc and its library are not installed")
@pytest.mark.parametrize("name", PROTOBUF)
def test_classes_of_protoc(name, against):
    subject = {**SUBJECTS, **SEVERAL_VARINTS, **LISTS, "Scene": SCENE}[name]
    request = type_request("decode", subject.type, {"encoding": "protobuf", **subject.options})
    against(name, request, "protobuf", Messages(subject.message, subject.message), proto=PROTOBUF[name])


@pytest.mark.skipif(not peers.installed("lcm"), reason="lcm-gen and its headers are not installed")
@pytest.mark.parametrize("name", LCM)
def test_classes_of_lcm_gen(name, against):
    subject, schema = LCM[name]
    request = type_request("decode", subject.type, {"encoding": "lcm", **subject.options})
    against(name, request, "lcm", Messages(subject.message, subject.message), lcm=schema)
