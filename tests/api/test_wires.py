"""Several wires in one mapping: messages of each fill their part of a holder, alike on every backend, and leave the others' alone."""

from __future__ import annotations

import copy
import json
import pickle
import threading
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rosetta_jit as rj
from rosetta_jit.cli import main

BACKENDS = ("llvm", "python", "interpreter")
WIRES = ("pose", "arm", "mode")
SCHEMAS = {
    "lab/Point.msg": "float64 x\nfloat64 y\n",
    "lab/Pose.msg": "string frame\nlab/Point at\nfloat64[3] sigma\n",
    "lab/Joint.msg": "string name\nfloat64[] history\n",
    "lab/Arm.msg": "lab/Joint[] joints\nuint8[] raw\nint32 level\nlab/Point goal\n",
    "mode.proto": """syntax = "proto3"; package lab;
message Mode { int32 kind = 1; double gain = 2; string why = 3; repeated double spread = 4; }""",
    "robot.proto": """syntax = "proto3"; package lab;
message Point { double x = 1; double y = 2; }
message Joint { string name = 1; repeated double history = 2; }
message Robot {
  string frame = 1; Point at = 2; repeated Joint joints = 3; bytes raw = 4; repeated double joined = 5; optional int32 level = 6;
  oneof what { double gain = 7; string why = 8; } string kind = 9; Point goal = 10; int64 seen = 11; double last = 12;
}""",
}
HEAD = """import "lab/Pose.msg"
import "lab/Arm.msg"
import "mode.proto"
import "robot.proto"
data-holder: lab.Robot
wire-schema pose: lab/Pose
wire-schema arm: lab/Arm
wire-schema mode: lab.Mode
"""
MAPPING = f"""{HEAD}
state seen: int64 = 0
state x: float64 = 0.0
rules:
  .frame <-> .pose.frame
  .at.x <-> .pose.at.x
  .at.y <-> .pose.at.y
  .joints[].name <-> .arm.joints[].name
  .joints[].history <-> .arm.joints[].history
  .raw <-> .arm.raw
  .goal.x <-> .arm.goal.x
  .goal.y <-> .arm.goal.y
unpack-rules:
  len(.joined) = 5
  for i from 0 to 3
    .joined[i] = .pose.sigma[i]
  end
  .joined[3] = .mode.gain
  .joined[4] = .mode.spread[0] if len(.mode.spread) > 0 else -1.0
  when .arm.level > 0
    .level = .arm.level
  end
  when .mode.kind == 0
    .gain = .mode.gain
  else
    .why = .mode.why
  end
  .kind = "robot"
  .seen = seen
  .last = x if .mode.kind >= 0 else 0.0
  state seen = seen + 1
  state x = .pose.at.x
  reject "no such mode" when .mode.kind > 9
pack-rules:
  ignore rest
  for i from 0 to 3
    .pose.sigma[i] = .joined[i]
  end
  .arm.level = .level if has(.level) else 0
  .mode.kind = 0 if has(.gain) else 1
  .mode.gain = .joined[3]
  .mode.why = .why
  len(.mode.spread) = 1
  .mode.spread[0] = .joined[4]
"""
FILES = {**SCHEMAS, "robot.mapping": MAPPING}
FLOATS = st.floats(-1e6, 1e6)
POINTS = st.fixed_dictionaries({"x": FLOATS, "y": FLOATS})
TEXTS = st.text(st.characters(codec="utf-8"), max_size=12)
JOINTS = st.lists(st.fixed_dictionaries({"name": TEXTS, "history": st.lists(FLOATS, max_size=3)}), max_size=3)
MESSAGES = {
    "pose": st.fixed_dictionaries({"frame": TEXTS, "at": POINTS, "sigma": st.lists(FLOATS, min_size=3, max_size=3)}),
    "arm": st.fixed_dictionaries({"joints": JOINTS, "raw": st.binary(max_size=400), "level": st.integers(-1, 2), "goal": POINTS}),
    "mode": st.fixed_dictionaries(
        {"kind": st.sampled_from([-1, 0, 1, 10]), "gain": FLOATS, "why": TEXTS, "spread": st.lists(FLOATS, max_size=2)}
    ),
}
ARRIVALS = st.lists(st.sampled_from(WIRES).flatmap(lambda wire: st.tuples(st.just(wire), MESSAGES[wire], st.booleans())), max_size=10)


def decoders(backend="llvm", mapping="robot.mapping", files=FILES, **options):
    return rj.Decoders(mapping, schema=files, backend=backend, **options)


@cache
def shared(backend="llvm"):
    """Decoders that several tests use, one after the other."""
    return decoders(backend)


def begun(backend="llvm"):
    """The same, before their first message."""
    programs = shared(backend)
    programs.reset()
    return programs


@cache
def encoders():
    return rj.Encoders("robot.mapping", schema=FILES)


TYPES = {"pose": ("lab/Pose", "lab/Pose.msg"), "arm": ("lab/Arm", "lab/Arm.msg"), "mode": ("lab.Mode", "mode.proto")}
WRITE = {wire: rj.Encoder.of(name, schema=FILES, imports=[file], backend="python") for wire, (name, file) in TYPES.items()}


def message(wire, values):
    return WRITE[wire](WRITE[wire].holder_type.from_dict(values))


POSE = {"frame": "map", "at": {"x": 1.0, "y": 2.0}, "sigma": [0.1, 0.2, 0.3]}
ARM = {"joints": [{"name": "elbow", "history": [1.0]}], "raw": b"abc", "level": 1, "goal": {"x": 0.0, "y": 5.0}}
MODE = {"kind": 1, "gain": 7.0, "why": "asked", "spread": [8.0]}
POSE_DATA, ARM_DATA, MODE_DATA = message("pose", POSE), message("arm", ARM), message("mode", MODE)


class Model:
    """What the mapping means, in plain Python."""

    def __init__(self):
        self.parts = {"pose": {}, "arm": {}, "mode": {}}
        self.joined = [0.0] * 5
        self.seen, self.x, self.shown = 0, 0.0, {}

    def take(self, wire, values):
        match wire:
            case "pose":
                self.parts[wire] = {"frame": values["frame"], "at": values["at"]}
                self.joined[:3] = values["sigma"]
            case "arm":
                level = {"level": values["level"]} if values["level"] > 0 else {}
                self.parts[wire] = {"joints": values["joints"], "raw": values["raw"], "goal": values["goal"], **level}
            case _:
                case_ = {"gain": values["gain"]} if values["kind"] == 0 else {"why": values["why"]}
                self.parts[wire] = {**case_, "last": self.x if values["kind"] >= 0 else 0.0}
                self.joined[3:] = [values["gain"], values["spread"][0] if values["spread"] else -1.0]
        self.shown = {"joined": list(self.joined), "kind": "robot", "seen": self.seen}
        self.seen += 1
        self.x = values["at"]["x"] if wire == "pose" else self.x

    def holder(self, holder_type):
        return holder_type.from_dict({name: value for part in (self.shown, *self.parts.values()) for name, value in part.items()})


@pytest.mark.parametrize("backend", BACKENDS)
@settings(max_examples=12, deadline=None)
@given(ARRIVALS)
def test_messages_fill_their_parts_and_no_others(backend, arrivals):
    compare(begun(backend), arrivals)


@pytest.mark.campaign
@settings(max_examples=2000, deadline=None)
@given(ARRIVALS)
def test_many_messages_fill_their_parts_and_no_others(arrivals):
    compare(begun(), arrivals)


def compare(programs, arrivals):
    """What the holder has behind each message, and what it means in plain Python."""
    model, broken = Model(), set()
    for wire, values, is_cut in arrivals:
        data = message(wire, values)
        is_bad = wire == "mode" and values["kind"] > 9
        if is_bad or (is_cut and wire != "mode"):
            with pytest.raises(rj.DecodeError):
                programs[wire](data if is_bad else data[:-1])
            broken.add(wire)
        else:
            assert programs[wire](data) is programs.holder
            model.take(wire, values)
            broken.discard(wire)
        if broken:
            with pytest.raises(rj.InvalidHolder):
                programs.holder.to_dict()
            assert broken <= set(programs.missing)
        elif model.seen:
            assert programs.holder == model.holder(programs.holder_type)
            assert programs.state == {"seen": model.seen, "x": model.x}


def test_what_has_arrived_is_known():
    programs = decoders()
    assert programs.ages == dict.fromkeys(WIRES)
    assert programs.missing == WIRES
    assert list(programs) == list(WIRES)
    assert len(programs) == 3
    programs.decode("pose", POSE_DATA, time=12.5)
    programs.arm(ARM_DATA)
    assert programs.ages == {"pose": 1, "arm": 0, "mode": None}
    assert programs.missing == ("mode",)
    assert programs.times == {"pose": 12.5}
    with pytest.raises(rj.DecodeError, match="no such mode"):
        programs.mode(message("mode", {**MODE, "kind": 10}))
    assert programs.missing == ("mode",)
    assert programs.ages["arm"] == 0
    programs.mode(MODE_DATA)
    assert programs.missing == ()
    assert programs.ages == {"pose": 2, "arm": 1, "mode": 0}
    assert programs.holder.why == "asked"
    assert programs.holder.frame == "map"
    assert programs.holder.last == 1.0
    programs.reset()
    assert programs.missing == WIRES
    assert programs.holder == programs.new()
    assert programs.times == {}
    assert programs.state["seen"] == 0


def test_a_message_that_is_refused_takes_nothing_else_with_it():
    programs = begun()
    for data, wire in ((POSE_DATA, "pose"), (ARM_DATA, "arm"), (MODE_DATA, "mode")):
        programs[wire](data)
    with pytest.raises(rj.DecodeError) as caught:
        programs.pose(POSE_DATA[:-1])
    assert caught.value.path == ".sigma"
    programs.arm(message("arm", {**ARM, "raw": bytes(5000)}))
    with pytest.raises(rj.InvalidHolder):
        programs.holder.raw  # noqa: B018 - to read it raises
    assert programs.missing == ("pose",)
    holder = programs.pose(POSE_DATA)
    assert holder.raw == bytes(5000)
    assert holder.joints[0].name == "elbow"
    assert holder.why == "asked"
    assert holder.at.x == 1.0


def test_the_first_message_may_be_refused():
    """It has taken room for an array that other messages fill, too, and that room is not kept."""
    for programs in map(begun, BACKENDS):
        holder = programs.holder_type()
        with pytest.raises(rj.DecodeError):
            programs.mode(message("mode", {**MODE, "kind": 10}), holder)
        programs.pose(POSE_DATA, holder)
        assert programs.mode(MODE_DATA, holder).joined.tolist() == [0.1, 0.2, 0.3, 7.0, 8.0]


def test_holders_of_ones_own():
    programs = begun()
    one, other = programs.new(), programs.new()
    assert programs.pose.into(POSE_DATA, one) is one
    programs.arm.into(ARM_DATA, other)
    programs.arm(message("arm", {**ARM, "level": 0}), one)
    assert one.frame == "map"
    assert other.frame == ""
    assert one.raw == b"abc" == other.raw
    assert other.level == 1
    assert not one.HasField("level")
    one.frame, one.raw = "changed by hand", b"x" * 100
    programs.mode.into(bytearray(MODE_DATA), one)
    assert one.frame == "changed by hand"
    assert len(one.raw) == 100
    assert one.why == "asked"
    one.clear()
    programs.mode.into(memoryview(MODE_DATA), one)
    assert one.frame == ""
    assert one.joined.tolist() == [0.0, 0.0, 0.0, 7.0, 8.0]


def test_a_holder_that_another_decoder_has_left_half_filled_begins_anew():
    programs = begun()
    own = rj.Decoder.of("lab.Robot", schema=FILES, imports=["robot.proto"])
    holder = programs.new()
    programs.pose.into(POSE_DATA, holder)
    if type(holder) is own.holder_type:
        with pytest.raises(rj.DecodeError):
            own.into(b"\x0a\x05ab", holder)
        programs.arm.into(ARM_DATA, holder)
        assert holder.frame == ""
        assert holder.raw == b"abc"


def test_lanes_do_not_grow_with_the_number_of_messages():
    programs = begun()
    holder = programs.holder_type()
    for number in range(100):
        programs.pose(message("pose", {**POSE, "frame": "f" * (number % 40)}), holder)
        programs.mode(MODE_DATA, holder)
        programs.arm(ARM_DATA, holder)
    lanes = holder.lanes_
    assert sum(len(lanes.memory[lane]) for lane in range(len(lanes.plan.strides))) < 4096


def test_encoders_write_each_wire():
    programs = begun()
    for wire, data in (("pose", POSE_DATA), ("arm", ARM_DATA), ("mode", MODE_DATA)):
        programs[wire](data)
    assert encoders()(programs.holder) == {"pose": POSE_DATA, "arm": ARM_DATA, "mode": MODE_DATA}
    assert encoders().arm(programs.holder) == ARM_DATA == rj.Encoder("robot.mapping", schema=FILES, wire="arm")(programs.holder)
    assert encoders().holder_type is programs.holder_type
    assert programs.mapping.laws is not None


def test_wires_may_have_other_encodings():
    files = {
        name.replace("lab/", "lab/msg/"): text.replace("lab/Point", "Point").replace("lab/Joint", "Joint") for name, text in SCHEMAS.items()
    }
    files["robot.mapping"] = MAPPING.replace("lab/", "lab/msg/")
    made = rj.Encoders("robot.mapping", schema=files, encodings={"pose": "cdr2"}, backend="python")
    cdr = rj.Encoder("robot.mapping", schema=files, wire="pose", backend="python")
    holder = made.holder_type.from_dict({"frame": "map", "joined": [1.0, 2.0, 3.0, 4.0, 5.0]})
    assert made.pose(holder)[:4] != cdr(holder)[:4]
    assert rj.Decoder("robot.mapping", schema=files, wire="pose", encoding="cdr2", backend="python")(made.pose(holder)).frame == "map"
    with pytest.raises(rj.MappingError, match="no wire `pise`"):
        rj.Encoders("robot.mapping", schema=files, encodings={"pose": "cdr2", "pise": "cdr"})


def test_copies_begin_anew():
    programs = begun()
    programs.pose(POSE_DATA)
    for again in (pickle.loads(pickle.dumps(programs)), copy.copy(programs)):  # noqa: S301 - our own
        assert again.ages["pose"] is None
        assert again.pose(POSE_DATA).frame == "map"
        assert again.holder is not programs.holder
    assert pickle.loads(pickle.dumps(programs.pose))(POSE_DATA).frame == "map"  # noqa: S301 - our own


def test_each_thread_has_a_holder():
    programs = decoders()
    programs.pose(POSE_DATA)
    found = []
    thread = threading.Thread(target=lambda: found.extend([programs.arm(ARM_DATA), programs.mode(MODE_DATA)]))
    thread.start()
    thread.join()
    assert found[0] is found[1] is not programs.holder
    assert found[0].frame == ""
    assert found[0].raw == b"abc"
    assert programs.holder.raw == b""


def test_what_needs_whole_messages_is_refused():
    programs = begun()
    for use in (
        lambda: programs.pose.many([POSE_DATA]),
        lambda: programs.pose.to(dict, POSE_DATA),
        lambda: programs.pose.into(POSE_DATA, {}),
        lambda: programs.pose.kernel,
    ):
        with pytest.raises(ValueError, match=r"several wires|keeps state"):
            use()
    wire = {"schema": FILES, "wire": "pose"}
    for make, text in (
        (lambda: rj.Decoder("robot.mapping", schema=FILES), "several wires, `pose`, `arm` and `mode`"),
        (lambda: rj.Decoder("robot.mapping", schema=FILES, wire="poze"), "did you mean `pose`"),
        (lambda: rj.Decoder("robot.mapping", borrow=True, **wire), "cannot borrow"),
        (lambda: rj.Bridge("robot.mapping", None, decode=wire), "a bridge cannot join"),
        (lambda: rj.Decoders("ros1/imu.mapping"), "one wire, which has no name"),
        (lambda: rj.Decoder("ros1/imu.mapping", wire="imu"), "one, which has no name"),
        (lambda: rj.Decoder.of("lab/Pose", imports=["lab/Pose.msg"], **wire), "one, which has no name"),
    ):
        with pytest.raises(rj.ReportError, match=text):
            make()
    with pytest.raises(AttributeError, match="the wires are pose, arm, mode"):
        programs.pise  # noqa: B018 - to ask for it raises


SMALL = """import "mode.proto"
data-holder: lab.Mode
wire-schema left: lab.Mode
wire-schema right: lab.Mode
rules:
  .kind <-> .left.kind
  .gain <-> .left.gain
  .why <-> .right.why
unpack-rules:
  ignore rest
  default .spread
pack-rules:
  ignore rest
  default rest
"""


def test_the_command_line(tmp_path, capsysbinary):
    for name, text in {"mode.proto": SCHEMAS["mode.proto"], "small.mapping": SMALL}.items():
        (tmp_path / name).write_text(text)
    mapping, data = str(tmp_path / "small.mapping"), tmp_path / "mode.bin"
    data.write_bytes(b"\x08\x05")
    assert main(["check", mapping]) == 0
    assert main(["decode", mapping, str(data), "--wire", "left", "--json"]) == 0
    printed = capsysbinary.readouterr().out
    assert json.loads(printed)["kind"] == 5
    (tmp_path / "holder.json").write_bytes(printed)
    assert main(["encode", mapping, str(tmp_path / "holder.json"), "--wire", "left"]) == 0
    assert capsysbinary.readouterr().out == b"\x08\x05"
    assert main(["decode", mapping, str(data)]) == 1
    assert b"`--wire left` that of one" in capsysbinary.readouterr().err
    assert main(["explain", mapping]) == 0
    assert b"each wire has one of its own: `--wire left` shows" in capsysbinary.readouterr().out
    assert main(["explain", mapping, "--wire", "right"]) == 0
    assert main(["prove", mapping, "--summary"]) == 0
    assert main(["compile", mapping, "--direction", "decode"]) == 0
    assert main(["dump", mapping, "--wire", "right"]) == 0
    assert b"keeps lanes [0" in capsysbinary.readouterr().out
    assert main(["generate", mapping, "--wire", "left", "--directions", "borrow", "-o", str(tmp_path)]) == 1
    assert b"such source cannot join" in capsysbinary.readouterr().err
    assert main(["generate", mapping, "--wire", "left", "--directions", "encode", "-o", str(tmp_path)]) == 0


def test_a_misspelt_wire_is_told_with_the_others():
    decode = rj.Decoders("joined/odometry.mapping", backend="interpreter")
    with pytest.raises(KeyError, match="no wire 'pos'; the wires are pose, velocity"):
        decode["pos"]
    assert "pos" not in decode
