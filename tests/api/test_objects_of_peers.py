"""Objects of the classes that rosbags, LCM and genpy make."""

from __future__ import annotations

import sys
from types import ModuleType

import pytest

import rosetta_jit as rj
from tests.api.test_objects import SCHEMA, plain


def test_rosbags():
    typesys = pytest.importorskip("rosbags.typesys")
    for store, framework, write, read in (
        (typesys.Stores.ROS1_NOETIC, "ros1", "serialize_ros1", "deserialize_ros1"),
        (typesys.Stores.ROS2_HUMBLE, "cdr", "serialize_cdr", "deserialize_cdr"),
    ):
        types = typesys.get_typestore(store)
        middle = "" if framework == "ros1" else "msg/"
        for name in ("sensor_msgs/JointState", "geometry_msgs/PoseArray", "std_msgs/Empty", "diagnostic_msgs/DiagnosticArray"):
            package, _, short = name.partition("/")
            theirs = f"{package}/msg/{short}"
            own = {"encoding": framework}
            to, of = rj.Decoder.of(f"{package}/{middle}{short}", **own), rj.Encoder.of(f"{package}/{middle}{short}", **own)
            data = of(to.holder_type.from_dict(VALUES[short]))
            value = getattr(types, read)(data, theirs)
            assert of(value) == data
            again = to.to(data, types.types[theirs])
            assert bytes(getattr(types, write)(again, theirs)) == data
            to.into(data, value)
            assert bytes(getattr(types, write)(value, theirs)) == data


_HEADER = {"frame_id": "world"}
VALUES = {
    "JointState": {"header": _HEADER, "name": ["a", "b"], "position": [0.5, 1.5], "velocity": [], "effort": [3.0]},
    "PoseArray": {"header": _HEADER, "poses": [{"position": {"x": 1.5}}, {"orientation": {"w": 1.0}}]},
    "Empty": {},
    "DiagnosticArray": {"header": _HEADER, "status": [{"level": 1, "name": "n", "values": [{"key": "k", "value": "v"}]}]},
}


def test_lcm(tmp_path):
    pytest.importorskip("lcm")
    from tests.frameworks.lcm.lcm_files import IDL, Generated

    with Generated(tmp_path, IDL / "lcm" / "rjtest" / "inner_t.lcm", IDL / "lcm" / "rjtest" / "everything_t.lcm") as classes:
        theirs = classes["rjtest.everything_t"]
        encode = rj.Encoder.of("rjtest.everything_t", encoding="lcm")
        decode = rj.Decoder.of("rjtest.everything_t", encoding="lcm")
        empty = theirs()
        assert encode(empty) == empty.encode()
        filled = decode.to(encode(empty), theirs)
        assert filled.encode() == empty.encode()


def test_genpy_by_the_shape_of_its_classes(monkeypatch):
    """As genpy writes them: slots, a constructor without arguments, and a package's module where its classes are found."""
    module, times = ModuleType("p.msg"), ModuleType("genpy")
    exec(GENPY, vars(module))  # noqa: S102 - the text below
    times.Time = module.Time
    monkeypatch.setitem(sys.modules, "p.msg", module)
    monkeypatch.setitem(sys.modules, "genpy", times)
    encode, decode = (each.of("p/Whole", schema=SCHEMA, encoding="ros1", imports=["p/Whole.msg"]) for each in (rj.Encoder, rj.Decoder))
    value = module.Whole()
    assert encode(value) == encode(encode.holder_type())
    decode.into(encode(plain(3)), value)
    assert type(value.parts[0]) is module.Part
    assert type(value.times[0]) is module.Time
    assert encode(value) == encode(plain(3))
    assert encode(decode.to(encode(plain(2)), module.Whole)) == encode(plain(2))
    value.axis = tuple(value.axis)
    assert encode(value) == encode(plain(3))


GENPY = """
class Time:
    __slots__ = ["secs", "nsecs"]
    def __init__(self): self.secs = self.nsecs = 0
class Part:
    __slots__ = ["number", "label", "when"]
    _type = "p/Part"
    def __init__(self): self.number, self.label, self.when = 0, "", Time()
class Whole:
    __slots__ = ["flag", "x", "samples", "axis", "raw", "names", "part", "parts", "times"]
    def __init__(self):
        self.flag, self.x, self.samples, self.axis, self.raw, self.names = False, 0.0, [], [0.0] * 3, b"", []
        self.part, self.parts, self.times = Part(), [], []
"""
