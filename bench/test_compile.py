"""How long types take to compile: large ones, ones of many arrays, and fifty at once. Seconds of processor time, without a cache."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

import pytest

from bench.figures import Series, Spread
from bench.processes import run, took_s

COMPILE = """
import json, sys, time
import rosetta_jit as rj
program = {"decode": rj.Decoder, "encode": rj.Encoder}[sys.argv[1]]
program.of("std_msgs/Header", encoding="ros1")
for what, options in map(json.loads, sys.argv[2:]):
    make = program if what.endswith(".mapping") else program.of
    started = time.process_time()
    make(what, **options)
    print(time.process_time() - started)
"""
"""After a first program, which pays for the compiler's import."""

PEAK = """
import json, sys
from pathlib import Path
import rosetta_jit as rj
what, options = json.loads(sys.argv[2])
{"decode": rj.Decoder, "encode": rj.Encoder}[sys.argv[1]].of(what, **options)
print(next(int(line.split()[1]) for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM")) * 1024 / 1e6)
"""
"""The most memory that a process has had which has compiled a type and nothing else."""

WARM = "import runpy, sys; sys.argv[0] = 'rosetta-jit'; runpy.run_module('rosetta_jit', run_name='__main__')"
NONE = "import numpy, rosetta_jit as rj; rj.Decoder"
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1"}
"""Else a thread of numpy's spins for some milliseconds after its import, beside whatever the process does, and is counted."""
FIFTY = """
import sys
import rosetta_jit as rj
made = [rj.Decoder.of(type, encoding="cdr") for type in sys.argv[1:]]
"""
FIRST_MESSAGES = f"""{FIFTY}
from contextlib import suppress
for decode in made:
    with suppress(rj.DecodeError):
        decode(bytes(4))
"""
"""Each makes the holder that its decoder fills, though it is cut short."""

EVERYDAY = """
geometry_msgs Accel AccelStamped Inertia Point Point32 PointStamped Polygon PolygonStamped Pose PoseArray PoseStamped PoseWithCovariance
    PoseWithCovarianceStamped Quaternion QuaternionStamped Transform TransformStamped Twist TwistStamped TwistWithCovarianceStamped Vector3
    Vector3Stamped Wrench WrenchStamped
sensor_msgs BatteryState CameraInfo CompressedImage FluidPressure Illuminance Image Imu JointState Joy LaserScan MagneticField
    MultiDOFJointState NavSatFix PointCloud2 Range RegionOfInterest RelativeHumidity Temperature TimeReference
nav_msgs OccupancyGrid Odometry Path MapMetaData
tf2_msgs TFMessage
diagnostic_msgs DiagnosticArray
trajectory_msgs JointTrajectory
"""


def everyday():
    """The names of fifty types of ROS 2."""
    package = ""
    for word in EVERYDAY.split():
        if word.endswith("_msgs"):
            package = word
        else:
            yield f"{package}/msg/{word}"


LARGE = {
    "RST HeadObjects": ("rst.vision.HeadObjects", {"encoding": "protobuf"}, 0.5),
    "ROS 2 InteractiveMarkerUpdate": ("visualization_msgs/msg/InteractiveMarkerUpdate", {"encoding": "cdr"}, 0.4),
}
"""Types, and how they are asked for; the aim in seconds."""


def ros1(fields, kind):
    text = "\n".join(f"{kind} field{index}" for index in range(fields))
    return "bench/Fields", {"encoding": "ros1", "schema": {"bench/msg/Fields.msg": text}}


def proto(fields, kind):
    text = "\n".join(f"  {kind} field{index} = {index + 1};" for index in range(fields))
    return "bench.Fields", protobuf(f"message Fields {{\n{text}\n}}")


def protobuf(text):
    return {"encoding": "protobuf", "schema": {"bench.proto": f'syntax = "proto3"; package bench;\n{text}'}}


def lists(depth):
    """A message of doubles in lists, so many in one another."""
    levels = "\n".join(f"message Level{level} {{ repeated Level{level - 1} inner = 1; }}" for level in range(1, depth))
    text = f"message Level0 {{ repeated double values = 1; }}\n{levels}"
    return f"bench.Level{depth - 1}", protobuf(text)


def padded_images(count):
    """A mapping of so many images of three channels, whose rows are padded on the wire and whose channels change sides."""
    fields = "\n".join(f"uint32 width{each}\nuint32 height{each}\nuint8[] data{each}" for each in range(count))
    rules = "\n".join(
        f"  .width{each} <-> .width{each}\n  .height{each} <-> .height{each}\n"
        f"  .data{each} <-> planar(rows(.data{each}, .height{each}, .width{each} * 3, align(.width{each} * 3, 8)), 3)"
        for each in range(count)
    )
    head = 'import "bench/msg/Wire.msg"\nimport "bench/msg/Held.msg"\ndata-holder: bench/Held\nwire-schema: bench/Wire\nrules:'
    files = {"bench/msg/Wire.msg": fields, "bench/msg/Held.msg": fields, "m.mapping": f"{head}\n{rules}\n"}
    return "m.mapping", {"encoding": "ros1", "schema": files}


MADE = {
    "ROS 1, 70 arrays": (*ros1(70, "float64[]"), 0.2),
    "ROS 1, 200 arrays": (*ros1(200, "float64[]"), 0.6),
    "ROS 1, 1,000 doubles": (*ros1(1000, "float64"), 1),
    "ROS 1, 1,000 strings": (*ros1(1000, "string"), 2),
    "protobuf, 1,000 integers": (*proto(1000, "int64"), 2),
    "protobuf, 1,000 strings": (*proto(1000, "string"), 2),
    "protobuf, 30 lists in one another": (*lists(30), 0.5),
    "a mapping of eight padded images": (*padded_images(8), 1),
}


def compiled_s(direction, *wanted):
    """Seconds for each of some types, in a process of their own."""
    asked = [json.dumps(each) for each in wanted]
    return [float(line) for line in run("-c", COMPILE, direction, *asked, ROSETTA_JIT_CACHE="off").split()]


@pytest.mark.parametrize("what", [*LARGE, *MADE])
def test_types(what, effort, record):
    type_, options, aim = {**LARGE, **MADE}[what]
    rounds = 1 if effort.quick else 3
    for direction, does in (("decode", "decoder"), ("encode", "encoder")):
        took = [compiled_s(direction, (type_, options))[0] for _ in range(rounds)]
        record(f"compile, {what}, {does}", Spread.of(took), None, "s", f"aim {aim} s")


def test_conformance_type(effort, record):
    """The largest type of protobuf's own conformance tests."""
    folder = os.environ.get("CONFORMANCE_PROTOS")
    if folder is None:
        pytest.skip("CONFORMANCE_PROTOS does not name the folder of protobuf's own test messages")
    name = "google/protobuf/test_messages_proto3.proto"
    options = {"encoding": "protobuf", "schema": {name: (Path(folder) / name).read_text("utf-8")}}
    wanted, rounds = ("protobuf_test_messages.proto3.TestAllTypesProto3", options), range(1 if effort.quick else 3)
    for direction, does in (("decode", "decoder"), ("encode", "encoder")):
        took = [compiled_s(direction, wanted)[0] for _ in rounds]
        record(f"compile, protobuf's TestAllTypesProto3, {does}", Spread.of(took), None, "s", "aim 3 s")
        if Path("/proc/self/status").exists():
            held = [float(run("-c", PEAK, direction, json.dumps(wanted), ROSETTA_JIT_CACHE="off")) for _ in rounds]
            said = "the whole process at its peak; aim 150 MB"
            record(f"memory of a process that compiles TestAllTypesProto3, {does}", Spread.of(held), None, "MB", said)


def test_fifty(record, tmp_path):
    """What a log or a bridge brings at once, by `rosetta-jit cache warm` on all processors; then from the cache it has filled.

    Then what is left out of that: programs for big-endian messages.
    """
    types, cache = tuple(everyday()), {"ROSETTA_JIT_CACHE_DIR": str(tmp_path / "cache")}
    assert len(set(types)) == 50
    started, cores = time.perf_counter(), len(os.sched_getaffinity(0))
    busy = took_s(WARM, "cache", "warm", *types, "--usual", "--encoding", "cdr", "--direction", "decode", **cache)
    elapsed, said = time.perf_counter() - started, f"{cores} processors, {{:.1f}} s of theirs; aim 1.5 s"
    record("compile, fifty everyday types, elapsed", Spread.of([elapsed]), None, "s", said.format(busy))
    alone, loaded, used = ([took_s(program, *types, **cache, **ONE_THREAD) for _ in range(5)] for program in (NONE, FIFTY, FIRST_MESSAGES))
    for what, took, aim in (("", loaded, "; aim 100 ms"), (", and a first message of each", used, "")):
        more = Spread.of([1000 * (each - min(alone)) for each in took])
        record(f"fifty everyday types, from the cache{what}", more, None, "ms", f"beyond a process that imports us and numpy{aim}")
    started = time.perf_counter()
    busy = took_s(WARM, "cache", "warm", *types, "--encoding", "cdr", "--direction", "decode", **cache)
    elapsed, said = time.perf_counter() - started, f"{cores} processors, {{:.1f}} s of theirs; behind `--usual`"
    record("compile, fifty everyday types, what big-endian messages need", Spread.of([elapsed]), None, "s", said.format(busy))


def nested(count):
    """A message of so many types, each of them once."""
    inner = {f"bench/msg/Inner{index}.msg": "string name\nfloat64 value" for index in range(count)}
    text = "\n".join(f"Inner{index} field{index}" for index in range(count))
    return "bench/Fields", {"encoding": "ros1", "schema": {"bench/msg/Fields.msg": text, **inner}}


def mapped(count):
    """A mapping of so many rules."""
    fields = "\n".join(f"float64 field{index}" for index in range(count))
    rules = "\n".join(f"  .field{index} = radians(.field{index})" for index in range(count))
    head = 'import "bench/msg/Wire.msg"\nimport "bench/msg/Held.msg"\ndata-holder: bench/Held\nwire-schema: bench/Wire\nunpack-rules:'
    files = {"bench/msg/Wire.msg": fields, "bench/msg/Held.msg": fields, "m.mapping": f"{head}\n{rules}\n"}
    return "m.mapping", {"encoding": "ros1", "schema": files}


GROWING = {
    "a ROS 1 message of fields": lambda count: ros1(count, "float64"),
    "a ROS 1 message of texts": lambda count: ros1(count, "string"),
    "a ROS 1 message of nested types": nested,
    "a mapping of rules": mapped,
}


@pytest.mark.parametrize("what", GROWING)
def test_growth(what, effort, draw):
    counts = [10, 100] if effort.quick else [30, 100, 300, 1000]
    points = [(count, Spread.of(compiled_s("decode", GROWING[what](count)))) for count in counts]
    draw(f"compile of {what}", what.rpartition(" of ")[2], "s", (Series("decoder", "ours", tuple(points)),))
