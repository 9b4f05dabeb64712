"""Rules that read several wires: at which messages they run, and what they know of the others."""

from __future__ import annotations

from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rosetta_jit as rj

SCHEMAS = {
    "lab/Scan.msg": "string frame\nfloat32[] ranges\nuint8 level\nbool good\n",
    "lab/Pose.msg": "float64 x\nint64 seq\nfloat64[2] sigma\n",
    "lab/Tilt.msg": "float32 angle\nint8 step\n",
    "lab.proto": """syntax = "proto3"; package lab;
message Seen {
  string frame = 1; double lead = 2; repeated double ranges = 3; optional int64 count = 4; double least = 5; bool ready = 6;
  double tilt = 7; repeated double joined = 8; int64 steps = 9; string kind = 10; double pick = 11; repeated string names = 12;
}""",
}
MAPPING = """import "lab/Scan.msg"
import "lab/Pose.msg"
import "lab/Tilt.msg"
import "lab.proto"
state steps: int64 = 0
data-holder: lab.Seen
wire-schema scan: lab/Scan
wire-schema pose: lab/Pose
wire-schema tilt: lab/Tilt
unpack-rules:
  ignore .scan.level
  .frame = .scan.frame
  .lead = .pose.x - .tilt.angle
  .ranges[] = .scan.ranges[] + .pose.x
  when .scan.good
    .count = .pose.seq + len(.scan.ranges)
  end
  .least = (min(.scan.ranges[]) if len(.scan.ranges) > 0 else 0.0) if .pose.seq > 0 else 0.0
  .ready = .scan.frame == "map" and .tilt.step > 0
  .tilt = .tilt.angle
  len(.joined) = 2
  .joined[0] = .pose.sigma[1]
  .joined[1] = .pose.sigma[0] * .tilt.step
  len(.names) = 3
  .names[0] = .scan.frame
  .names[1] = text(.pose.seq)
  .names[2] = "step " + text(.tilt.step) if .tilt.step > 0 else ""
  .steps = steps
  .kind = .scan.frame + "!" if .pose.x > 0.0 else "none"
  when .scan.good
    .pick = .pose.x
  else
    .pick = .tilt.angle
  end
  state steps = steps + .pose.seq + .tilt.step
  reject "{.scan.frame}: too far from {.pose.x}" when .scan.level > .pose.x + 100
"""
FILES = {**SCHEMAS, "seen.mapping": MAPPING}
WIRES = {"scan": "lab/Scan", "pose": "lab/Pose", "tilt": "lab/Tilt"}
WRITE = {wire: rj.Encoder.of(name, schema=FILES, imports=[f"{name}.msg"], backend="python") for wire, name in WIRES.items()}
WHOLE = st.integers(-4, 4)
MESSAGES = {
    "scan": st.fixed_dictionaries(
        {
            "frame": st.sampled_from(["map", "odom", ""]),
            "ranges": st.lists(WHOLE.map(float), max_size=3),
            "level": st.integers(96, 105),
            "good": st.booleans(),
        }
    ),
    "pose": st.fixed_dictionaries({"x": WHOLE.map(float), "seq": WHOLE, "sigma": st.lists(WHOLE.map(float), min_size=2, max_size=2)}),
    "tilt": st.fixed_dictionaries({"angle": WHOLE.map(float), "step": st.integers(-1, 2)}),
}
ARRIVALS = st.lists(st.sampled_from(list(WIRES)).flatmap(lambda wire: st.tuples(st.just(wire), MESSAGES[wire])), max_size=9)


def message(wire, values):
    return WRITE[wire](WRITE[wire].holder_type.from_dict(values))


@cache
def made(backend="llvm"):
    return rj.Decoders("seen.mapping", schema=FILES, backend=backend)


class Model:
    """What the mapping means, in plain Python."""

    def __init__(self):
        self.last, self.fields, self.joined, self.names, self.steps = {}, {}, [0.0, 0.0], [""] * 3, 0

    def take(self, wire, values):
        """What a message makes of the holder; False if it is refused."""
        last = {**self.last, wire: values}
        scan, pose, tilt = (last.get(each) for each in WIRES)
        if wire == "scan" and pose and scan["level"] > pose["x"] + 100:
            return False
        self.last, found = last, {}
        if wire == "scan":
            found = {"frame": scan["frame"], "ranges": [each + pose["x"] for each in scan["ranges"]] if pose else [], "count": None}
            self.names[0] = scan["frame"]
            found["kind"] = (scan["frame"] + "!" if pose["x"] > 0 else "none") if pose else ""
            if pose and scan["good"]:
                found["count"] = pose["seq"] + len(scan["ranges"])
        if wire == "tilt":
            found["tilt"] = tilt["angle"]
            self.names[2] = f"step {tilt['step']}" if tilt["step"] > 0 else ""
        if wire in ("pose", "tilt"):
            found["lead"] = pose["x"] - tilt["angle"] if pose and tilt else 0.0
            self.joined[1] = pose["sigma"][0] * tilt["step"] if pose and tilt else self.joined[1]
        if wire == "pose":
            self.joined[0] = pose["sigma"][1]
            self.names[1] = str(pose["seq"])
            found["count"] = pose["seq"] + len(scan["ranges"]) if scan and scan["good"] else None
        if wire in ("scan", "pose"):
            known = scan and pose and pose["seq"] > 0 and scan["ranges"]
            found["least"] = min(scan["ranges"]) if known else 0.0
        if wire in ("scan", "tilt"):
            found["ready"] = bool(scan and tilt and scan["frame"] == "map" and tilt["step"] > 0)
        found["pick"] = (pose["x"] if scan["good"] else tilt["angle"]) if scan and pose and tilt else 0.0
        self.fields = {**self.fields, **found, "joined": list(self.joined), "names": list(self.names), "steps": self.steps}
        if wire in ("pose", "tilt") and pose and tilt:
            self.steps += pose["seq"] + tilt["step"]
        return True

    def holder(self, holder_type):
        return holder_type.from_dict({name: value for name, value in self.fields.items() if value is not None})


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter", "numba"])
@settings(max_examples=15, deadline=None)
@given(ARRIVALS)
def test_a_rule_that_reads_several_wires_runs_when_all_have_come(backend, arrivals):
    programs, model, broken = made(backend), Model(), False
    programs.reset()
    for wire, values in arrivals:
        before = dict(model.fields)
        if not model.take(wire, values):
            with pytest.raises(rj.DecodeError, match="too far from"):
                programs[wire](message(wire, values))
            model.fields, broken = before, True
            continue
        programs[wire](message(wire, values))
        broken = broken and wire != "scan"
        if not broken:
            assert programs.holder == model.holder(programs.holder_type)
        assert programs.state == {"steps": model.steps}


def test_what_is_kept_is_of_the_last_good_message():
    programs = made()
    programs.reset()
    pose, tilt = message("pose", {"x": 3.0, "seq": 7, "sigma": [1.0, 2.0]}), message("tilt", {"angle": 1.0, "step": 2})
    assert programs.pose(pose).lead == 0.0
    assert programs.tilt(tilt).lead == 2.0
    with pytest.raises(rj.DecodeError):
        programs.pose(pose[:-1])
    own = programs.new()
    assert programs.tilt.into(message("tilt", {"angle": -1.0, "step": 2}), own).lead == 4.0
    assert programs.ages == {"scan": None, "pose": 2, "tilt": 0}
    programs.reset()
    assert programs.tilt(tilt).lead == 0.0


def test_what_cannot_be_kept_is_refused():
    for rule in (
        ".frame = .scan.frame + text(.pose.seq) if .other.frame == .scan.frame else .other.frame",
        ".frame = .scan.frame + .other.frame",
    ):
        text = MAPPING.replace("wire-schema pose", "wire-schema other: lab/Scan\nwire-schema pose").replace(".frame = .scan.frame", rule, 1)
        with pytest.raises(rj.MappingError, match="at once") as caught:
            rj.Decoders("seen.mapping", schema={**FILES, "seen.mapping": text})
        assert "numbers and bools, which are kept" in str(caught.value)
