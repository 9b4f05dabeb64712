"""Drafts of mappings: what is proposed, and what is marked as not decided."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.cli import main
from rosetta_jit.draft.words import alike, shared, tokens

SCHEMAS = {
    "lab/msg/Arm.msg": "lab/Joint[] joints\nbuiltin_interfaces/Time stamp\nstring mode\nfloat64 depth\nuint8[] pixels\nuint32 step\n"
    "int32 turns\n",
    "lab/msg/Joint.msg": "string name\nfloat64 position\nfloat64 effort\n",
    "robot.proto": """syntax = "proto2"; package robot; import "rosetta_jit/unit.proto";
message Limb {
  enum Mode { IDLE = 0; MOVE = 1; }
  repeated string joint_names = 1;
  repeated float joint_positions = 2;
  required int64 timestamp = 3 [(rosetta_jit.unit) = "us"];
  required Mode mode = 4;
  required double depth = 5 [(rosetta_jit.unit) = "mm"];
  required bytes image = 6;
  required string turns = 7;
  optional bool calibrated = 8;
  required bytes pixels = 9;
}""",
    "arm.units": "lab/Arm:\n  .depth: m\n",
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name, text in SCHEMAS.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_draft(folder, capsys):
    assert main(["draft", "robot.Limb", "lab/Arm", "--import", "robot.proto", "--import", "lab/msg/Arm.msg", "--import", "arm.units"]) == 0
    text = capsys.readouterr().out
    rules = [line.partition("   #")[0].strip() for line in text.partition("rules:\n")[2].splitlines()]
    assert "  .joint_names[] <-> .joints[].name   # a guess: " in text
    assert rules == [
        ".joint_names[] <-> .joints[].name",
        ".joint_positions[] <-> float32(.joints[].position)",
        ".timestamp <-> .stamp.sec * 1000000 + floor_divide(.stamp.nanosec, 1000)",
        '# not decided: which value means which constant? .mode <-> table(.mode) { "..." = robot.Limb.Mode.IDLE, ... }',
        ".depth <-> .depth",
        ".turns <-> text(.turns)",
        "# look at this: rows may be padded, see .step; if they are: rows(.pixels, height, bytes of a row, stride)",
        ".pixels <-> .pixels",
        "# not decided: nothing of the wire is like these",
        "default .mode",
        "default .image",
        "default .calibrated",
        "# not decided: nothing of the holder is like these",
        "ignore .mode",
        "ignore .step",
        "for i from 0 to len(.joints)",
        "ignore .joints[i].effort",
        "end",
    ]
    (folder / "limb.mapping").write_text(text)
    assert rj.check("limb.mapping").laws is not None


def test_types_by_their_names_alone(capsys):
    assert main(["draft", "rst.geometry.Rotation", "sensor_msgs/Imu", "--encoding", "ros1"]) == 0
    text = capsys.readouterr().out
    assert 'import "ros1/sensor_msgs/Imu.msg"' in text
    assert ".qw <-> .orientation.w" in text
    assert "  ignore .angular_velocity\n" in text


def test_an_array_of_what_are_fields(capsys):
    schema = ["--import", "yarp/icub/torso_state.bottle-schema", "--import", "rst/kinematics/JointAngles.proto"]
    assert main(["draft", "rst.kinematics.JointAngles", "yarp.icub.torso.state", *schema]) == 0
    rules = capsys.readouterr().out.partition("rules:\n")[2]
    assert "  len(.angles) <-> 3" in rules
    assert "  .angles[2] <-> float32(radians(.pitch))" in rules


def test_a_type_that_there_is_not(capsys):
    assert main(["draft", "rst.geometry.Poze", "geometry_msgs/Pose"]) == 1
    assert "did you mean `rst.geometry.Pose`?" in capsys.readouterr().err


def test_a_file_that_there_is_not(capsys):
    assert main(["draft", "a.B", "c.D", "--import", "none.proto"]) == 1
    assert "import-not-found" in capsys.readouterr().err


def test_words():
    assert tokens("hardwareID_v2") == ("hardware", "id", "v", "2")
    assert tokens("jointPositions") == tokens("joint_position") == ("joint", "position")
    assert alike("position", "Translation") > alike("position", "posture") >= 0
    assert alike("time_stamp", "timestamp") > 0.7
    assert alike("temperature", "width") == 0
    assert shared(["pose", "orientation"], ["Rotation"]) > shared(["pose", "position"], ["Rotation"])


def test_types_of_one_name_are_told_apart(capsys):
    assert main(["draft", "std_msgs/Header", "std_msgs/msg/Header"]) == 0
    rules = capsys.readouterr().out.partition("rules:\n")[2].splitlines()
    assert [line.strip() for line in rules if line.strip()] == [
        ".stamp.secs <-> uint32(.stamp.sec)",
        ".stamp.nsecs <-> .stamp.nanosec",
        ".frame_id <-> .frame_id",
        "# not decided: nothing of the wire is like these",
        "default .seq",
    ]


def test_a_stamp_of_both_sides_is_no_matter_of_other_times(capsys):
    """`time_increment`, which is in seconds, is not the moment of the message."""
    assert main(["draft", "sensor_msgs/msg/LaserScan", "sensor_msgs/LaserScan"]) == 0
    lines = {line.strip() for line in capsys.readouterr().out.splitlines()}
    assert {
        ".header.stamp.sec <-> int32(.header.stamp.secs)",
        ".header.stamp.nanosec <-> .header.stamp.nsecs",
        ".time_increment <-> .time_increment",
    } <= lines
