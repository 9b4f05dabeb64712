"""Side files of units: what they say of fields, and what can be wrong with them."""

from __future__ import annotations

import math
import time

import pint
import pytest

import rosetta_jit as rj
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.language.parse.unit_file import parse
from rosetta_jit.language.units.side_files import annotated
from rosetta_jit.model.types import Schema, Struct
from rosetta_jit.parsing.search import Reading, SearchPath

UREG = pint.UnitRegistry()
BACKENDS = ["llvm", "python", "interpreter"]
IMU = {
    "robot.proto": """syntax = "proto3"; package robot; import "rosetta_jit/unit.proto";
message Gyro { double x = 1 [(rosetta_jit.unit) = "degree/s"]; double y = 2 [(rosetta_jit.unit) = "degree/s"]; double up = 3; }""",
    "imu.mapping": """import "robot.proto"
import "ros1/sensor_msgs/Imu.msg"
import "ros/sensor_msgs.units"
import "robot.units"
data-holder: robot.Gyro
wire-schema: sensor_msgs/Imu
unpack-rules:
  .x = .angular_velocity.x
  .y = .angular_velocity.y
  .up = .linear_acceleration.z
""",
    "robot.units": "robot.Gyro:   # what is not said by the option\n  .up: cm/s^2\n",
}


def files(tmp_path, texts):
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_foreign_type_gets_units_where_it_is_used(backend):
    encode = rj.Encoder.of("sensor_msgs/Imu", encoding="ros1", backend="python")
    imu = encode.holder_type.from_dict({"angular_velocity": {"x": 1.5, "y": -2.0}, "linear_acceleration": {"z": 9.81}})
    decode = rj.Decoder("imu.mapping", schema=IMU, encoding="ros1", backend=backend)
    gyro = decode(encode(imu))
    assert gyro.x == pytest.approx(UREG.Quantity(1.5, "rad/s").to("degree/s").magnitude, rel=1e-15)
    assert gyro.y == pytest.approx(math.degrees(-2.0), rel=1e-15)
    assert gyro.up == pytest.approx(981.0, rel=1e-15)


PRISMATIC = {
    "robot.proto": 'syntax = "proto3"; package robot; message Arm { repeated double joints = 1; string name = 2; }',
    "ros1/lab/Joints.msg": "float64[] position\nstring name\n",
    "arm.units": "robot.Arm:\n  .joints: rad, rad, m\n\nlab/Joints:\n  .position: degree\n  .position[2]: mm\n",
    "arm.mapping": """import "robot.proto"
import "ros1/lab/Joints.msg"
import "arm.units"
data-holder: robot.Arm
wire-schema: lab/Joints
rules:
  .joints <-> .position
  .name <-> .name
""",
}


@pytest.mark.parametrize("backend", [*BACKENDS, "llvm"])
def test_prismatic_joints(backend):
    options = {"schema": PRISMATIC, "encoding": "ros1", "backend": backend}
    decode, encode = rj.Decoder("arm.mapping", **options), rj.Encoder("arm.mapping", **options)
    own = {"schema": PRISMATIC, "imports": ["ros1/lab/Joints.msg"], "encoding": "ros1", "backend": "python"}
    write, read = rj.Encoder.of("lab/Joints", **own), rj.Decoder.of("lab/Joints", **own)
    message = write(write.holder_type.from_dict({"position": [180.0, -90.0, 250.0], "name": "arm"}))
    arm = decode(message)
    expected = [
        UREG.Quantity(value, unit).to(wanted).magnitude
        for value, unit, wanted in zip((180.0, -90.0, 250.0), ("degree", "degree", "mm"), ("rad", "rad", "m"), strict=True)
    ]
    assert list(arm.joints) == pytest.approx(expected, rel=1e-15)
    assert list(read(encode(arm)).position) == pytest.approx([180.0, -90.0, 250.0], rel=1e-15)
    short = write(write.holder_type.from_dict({"position": [45.0]}))
    assert list(decode(short).joints) == pytest.approx([math.pi / 4], rel=1e-15)


ARM = "message Arm { repeated double joints = 1; string name = 2; Arm next = 3; map<string, double> by = 4; }"
CHECKED = """import "robot.proto"
import "arm.units"
data-holder: robot.Arm
wire-schema: robot.Arm
unpack-rules:
  .name = .name
  ignore .joints
  ignore .next
  ignore .by
  default .joints
  default .next
  default .by
"""


def reports(tmp_path, units, proto=ARM):
    texts = {"robot.proto": f'syntax = "proto3"; package robot; {proto}', "arm.units": units, "arm.mapping": CHECKED}
    try:
        return rj.check(files(tmp_path, texts) / "arm.mapping")
    except rj.MappingError as error:
        return error.diagnostics


@pytest.mark.parametrize(
    ("units", "code", "words", "place"),
    [
        ("robot.Arn:\n  .joints: rad\n", "unknown-type", "`robot.Arm`", "1:1"),
        ("robot.Arm:\n  .joint: rad\n", "unknown-field", "`.joints`", "2:3"),
        ("robot.Arm:\n  .next.next.joint: rad\n", "unknown-field", "`.joints`", "2:13"),
        ("robot.Arm:\n  .joints: radd\n", "unknown-unit", "`rad`", "2:12"),
        ("robot.Arm:\n  .joints: 10**10**10\n", "unknown-unit", "pint", "2:12"),
        ("robot.Arm:\n  .name: m\n", "unit", "numbers", "2:10"),
        ("robot.Arm:\n  .by: m\n", "unit", "numbers", "2:8"),
        ("robot.Arm:\n  .name.x: m\n", "unknown-field", "text has no fields", "2:8"),
        ("robot.Arm:\n  .joints.x: m\n", "unknown-field", "`[]`", "2:10"),
        ("robot.Arm:\n  .name[]: m\n", "unknown-field", "text has no elements", "2:8"),
        ("robot.Arm:\n  .joints[0]: rad, m\n", "unit", "one unit, not several", "2:20"),
        ("robot.Arm:\n  .joints[1]: rad\n  .joints[1]: m\n", "unit-contradiction", "arm.units:2:15", "3:15"),
        ("robot.Arm:\n  .joints:\n", "syntax", "missing", "2:11"),
        ("robot.Arm:\n  .joints: rad,,m\n", "syntax", "missing", "2:16"),
        ("robot.Arm:\n  .joints rad\n", "syntax", "`:`", "2:10"),
        ("robot.Arm:\n  joints: rad\n  .joints: rad\n", "syntax", "neither a type nor a field", "2:3"),
        ("  .joints: rad\n", "syntax", "begins with the name of a type", "1:3"),
        ("robot.Arm\n  .joints: rad\n", "syntax", "begins with the name of a type", "1:1"),
    ],
)
def test_mistakes(tmp_path, units, code, words, place):
    found = [problem for problem in reports(tmp_path, units) if problem.severity == "error"]
    assert {problem.code for problem in found} == {code}
    first = found[0]
    assert str(first.span).endswith(f"arm.units:{place}")
    assert words in f"{first.message} {first.help} {first.notes} {first.label}"


def test_what_the_idl_says_is_not_said_otherwise(tmp_path):
    proto = """import "rosetta_jit/unit.proto";
message Arm { repeated double joints = 1 [(rosetta_jit.unit) = "rad"]; string name = 2; Arm next = 3; int32 by = 4; }"""
    (found,) = [each for each in reports(tmp_path, "robot.Arm:\n  .joints: degree\n", proto) if each.severity == "error"]
    assert (found.code, found.notes) == ("unit-contradiction", ("rad is said by the IDL itself",))
    assert not [each for each in reports(tmp_path, "robot.Arm:\n  .joints: radian\n", proto) if each.severity == "error"]


def test_a_type_that_is_not_imported_is_no_mistake(tmp_path):
    units = "robot.Arm:\n  .joints: rad\nsensor_msgs/Imu:\n  .no_such_field: m\n"
    assert [problem.code for problem in reports(tmp_path, units)] == []


def test_a_file_that_says_nothing_of_the_types_is_unused(tmp_path):
    assert [problem.code for problem in reports(tmp_path, "sensor_msgs/Imu:\n  .x: m\n")] == ["import-unused"]


def test_units_of_unions_and_nested_structs(tmp_path):
    proto = """message Arm { oneof how { double angle = 1; Arm other = 5; }
string name = 2; repeated Arm next = 3; int32 by = 4; int32 joints = 6; }"""
    units = "robot.Arm:\n  .angle: rad\n  .next[].angle: degree\n  .next[3].other.angle: mrad\n"
    assert [problem for problem in reports(tmp_path, units, proto) if problem.severity == "error"] == []


@pytest.mark.parametrize(
    ("units", "root"),
    [
        ("ros/sensor_msgs.units", "ros1"),
        ("ros/sensor_msgs.units", "ros2"),
        ("ros/geometry_msgs.units", "ros1"),
        ("ros/geometry_msgs.units", "ros1-2012"),
        ("ros/geometry_msgs.units", "ros2"),
        ("ros/nav_msgs.units", "ros1"),
        ("ros/nav_msgs.units", "ros2"),
        ("rst/rst.units", "rst"),
    ],
)
def test_shipped_files_fit_the_types(units, root):
    """Each type that a shipped file names is there, with its fields, and its units are known."""
    search, readers, reading = SearchPath.of(), Readers(installed(), framework=None if root == "rst" else root[:4]), Reading()
    problems = []
    file = parse(search.find(units), problems)
    names = [name for each in file.types for name in candidates(each.text, root) if search.find(name) is not None]
    if root != "ros1-2012":  # which has fewer types
        assert len(names) == len(file.types)
    types = {}
    for name in names:
        source = search.find(name)
        types |= readers.find(source.name)(source, search.loader(reading, source)).types
    found = annotated(Schema(types), [file], lambda _: True, problems)
    assert problems == []
    measured = [name for name, type_ in found.types.items() if isinstance(type_, Struct) and any(each.unit for each in type_.fields)]
    assert len(measured) == len(names)


def candidates(name, root):
    package, _, short = name.rpartition("/") if "/" in name else name.replace(".", "/").rpartition("/")
    return [f"{root}/{package}/msg/{short}.msg", f"{root}/{package}/{short}.msg", f"{package}/{short}.proto"]


@pytest.mark.parametrize(
    "text",
    [
        "robot.Arm:\n" + "  .joints[1]: m\n" * 100_000,
        "robot.Arm:\n" + "".join(f"  .joints[{number}]: m\n" for number in range(100_000)),
        "robot.Arm:\n  .joints: " + ", ".join(["rad"] * 100_000),
        "robot.Arm:\n  " + ".next" * 100_000 + ": m",
        "".join(f"a{number}:\n" for number in range(100_000)),
        "robot.Arm:\n" + "  .?\n" * 100_000,
        "a" + ":" * 100_000,
        "robot.Arm:\n  .joints: " + "m*" * 100_000 + "m",
        "robot.Arm:\n  .joints[" + "9" * 100_000 + "]: m",
        "robot.Arm:\n" + "".join(f"  .next.joints[{number}]: u{number}\n" for number in range(4000)),
    ],
)
def test_hostile_files_end_in_a_report(tmp_path, text):
    start = time.process_time()
    assert any(problem.severity == "error" for problem in reports(tmp_path, text)) or "joints[1]: m" in text
    assert time.process_time() - start < 30
