"""Attributes in compiled code do what those in Python do, for every kind of field and whatever they are given."""

from __future__ import annotations

import random
import subprocess
import sys
import warnings
import weakref
from pathlib import Path

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.errors import InUse, InvalidHolder
from rosetta_jit.kernel.state import EPOCH, UNSETTLED, VALID, WASTED
from rosetta_jit.runtime.attributes.code import OFFSETS, SYMBOLS, library, text
from rosetta_jit.runtime.callable import is_native
from rosetta_jit.runtime.cells import SCALARS
from rosetta_jit.runtime.holder.access import raw
from rosetta_jit.runtime.holder.message import Message
from rosetta_jit.runtime.holder.sequence import Sequence
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.type_specs import slot_offset

sys.path.insert(0, str(Path(__file__).parent))
from schemas import flat, whole

needs_code = pytest.mark.skipif(library() is None, reason="no Python that compiled accessors know")

SOURCES = {
    "all.proto": """
        syntax = "proto3";
        package t;
        enum Open { ZERO = 0; ONE = 1; }
        message Inner { int32 number = 1; string name = 2; repeated string names = 3; Inner inner = 4; optional sint64 maybe = 5; }
        message All {
          int32 i32 = 1; int64 i64 = 2; uint32 u32 = 3; uint64 u64 = 4; float single = 5; double twice = 6; bool flag = 7; Open open = 8;
          string name = 9; bytes data = 10; optional int32 maybe = 11; optional string perhaps = 12; Inner inner = 13;
          repeated Inner inners = 14; repeated string names = 15; repeated double doubles = 16; map<string, Inner> by_name = 17;
          oneof choice { int32 left = 18; string right = 19; Inner middle = 20; }
        }
    """,
    "old.proto": """
        syntax = "proto2";
        package t;
        enum Closed { A = 1; B = 2; }
        message Old { optional int32 number = 1 [default = 7]; optional string name = 2 [default = "x"]; required Closed closed = 3; }
    """,
}
IDL = """
    module t {
      enum Colour { RED, GREEN };
      struct Point { double x; float y; int16 z; };
      struct Cell { octet a; Point at; wstring wide; sequence<Point> path; };
      struct All {
        boolean flag; octet byte; char letter; short s; unsigned short us; long l; unsigned long ul; long long ll; unsigned long long ull;
        float f; double d; Colour shade; string<5> brief; string text; sequence<octet> bytes; sequence<double> doubles;
        sequence<long, 3> longs; double matrix[9]; double grid[2][3]; sequence<string> names; sequence<string<3>, 2> few; Cell inner;
        sequence<Cell> cells; sequence<boolean> flags; sequence<unsigned long long> numbers; sequence<Colour> colours;
      };
    };
"""
VALUES = [
    *(0, 1, -1, 7, 127, 128, -128, 255, 256, 32767, -32768, 65535, 1 << 31, (1 << 31) - 1, -(1 << 31), (1 << 32) - 1, 1 << 63),
    *((1 << 63) - 1, -(1 << 63), (1 << 64) - 1, 1 << 64, 1 << 2000, True, False, None, 0.0, -0.0, 1.5, 1e300, -1e39, 3e-50),
    *(float("nan"), float("inf"), np.float64(2.5), np.float32(0.1), np.int8(3), np.bool_(1)),
    *("", "a", "é", "RED", "A", "x" * 100, "\0", "\udc80", "sixbytes"),
    *(b"", b"a", b"\xff\xfe", bytes(100), bytearray(b"xy"), memoryview(b"abc")),
    *([], [1], [1, 2, 3], [1.5, 2], [1, "a"], [None], [1 << 70], [float(each) for each in range(200)], list(range(-5, 5))),
    *(["abc", "xyz"], ["abcd"], ["é", "éé"], ["a", "bc", ""], ["é" * 50] * 20, ["a", 1], ["\udc80"], ("a", "b"), (1, 2)),
    *(np.arange(3.0), np.arange(3), np.arange(9.0), np.arange(6.0).reshape(2, 3), np.arange(10.0)[::2], np.arange(3, dtype=np.int32)),
    *(np.arange(3, dtype=np.float32), np.arange(4, dtype=np.uint8), np.array([True, False]), np.array("x"), np.array(["a"])),
    *(np.arange(3, dtype=">f8"), {}, {"x": 1.0}, {"number": 3, "name": "n"}, [{"x": 1}, {"y": 2.0}], {"k": {"number": 4}}),
    *([{"number": 1}, {"name": "b", "names": ["q"]}],),
]  # fmt: skip


PROTO, CDR, ROS1 = {"schema": SOURCES, "encoding": "protobuf"}, {"schema": {"all.idl": IDL}, "encoding": "cdr"}, {"encoding": "ros1"}
TYPES = {
    "t.All": PROTO, "t.Old": PROTO, "t::All": CDR,
    "sensor_msgs/Imu": ROS1, "sensor_msgs/JointState": ROS1, "diagnostic_msgs/DiagnosticArray": ROS1,
}  # fmt: skip


def made_of(name):
    """The class of a type's holders."""
    own = {"flat": flat, "whole": whole}
    return own[name]() if name in own else rj.Decoder.of(name, **TYPES[name]).holder_type


def in_python(message, name):
    """The Python accessors of a field."""
    return message.access_.getters[name], message.access_.setters[name]


def outcome(do, *arguments):
    """What comes of something: a value, made comparable, or an error."""
    try:
        value = do(*arguments)
    except Exception as error:  # noqa: BLE001 - whatever it is, both must raise it
        return type(error), str(error)
    return plain(value)


def plain(value):
    if hasattr(value, "access_") or isinstance(value, dict):
        return repr(raw(value))
    if isinstance(value, np.ndarray):
        return str(value.dtype), value.shape, value.tobytes()
    if hasattr(value, "node"):
        return [plain(each) for each in value] if not hasattr(value, "keys") else repr(dict(value))
    return type(value), repr(value)


def within(message, depth=3):
    """A message and those in it, as paths."""
    yield ()
    for name, entry in message.access_.record.entries.items():
        kind = type(entry.node).__name__
        if kind in ("Record", "Child") and depth:
            yield from ((name, *path) for path in within(message.access_.getters[name](message), depth - 1))
        if kind == "Items" and not entry.node.shape and type(entry.node.element).__name__ == "Record" and depth:
            shown = message.access_.getters[name](message)
            for index in range(len(shown)):
                yield from ((name, index, *path) for path in within(shown[index], depth - 1))


def follow(message, path):
    for step in path:
        message = message[step] if isinstance(step, int) else getattr(message, step)
    return message


@needs_code
@pytest.mark.parametrize("name", [*TYPES, "flat", "whole"])
def test_compiled_code_does_what_python_does(name):
    live_twice(name, 0)


@needs_code
@pytest.mark.campaign
@pytest.mark.parametrize("name", [*TYPES, "flat", "whole"])
def test_it_does_so_for_long(name):
    for seed in range(1, 100):
        live_twice(name, seed)


def live_twice(name, seed):
    """Two holders live through the same random life, one through its attributes, one through the accessors in Python."""
    made, rng = made_of(name), random.Random(f"{name} {seed}")
    ours, theirs = made(), made()
    refused = 0
    path = ()
    for step in range(1500):
        if step % 10 == 0:
            path = rng.choice(list(within(ours, 2)))
        mine, its = outcome(follow, ours, path), outcome(follow, theirs, path)
        if isinstance(mine, tuple) and isinstance(mine[0], type) and issubclass(mine[0], Exception):
            assert mine == its
            path = ()
        mine, its = follow(ours, path), follow(theirs, path)
        field = rng.choice(list(mine.access_.record.entries))
        value = rng.choice(VALUES)
        get, set_ = in_python(its, field)
        if rng.random() < 0.7:
            found, expected = outcome(setattr, mine, field, value), outcome(set_, its, value)
            refused += isinstance(expected[0], type) and issubclass(expected[0], Exception)
            assert found == expected, (path, field, value)
        assert outcome(getattr, mine, field) == outcome(get, its), (path, field)
        if rng.random() < 0.02:
            ours.clear(), theirs.clear()
            path = ()
    assert repr(raw(ours)) == repr(raw(theirs))
    assert refused > 100


@needs_code
def test_every_accessor_is_compiled():
    assert all(library()[symbol] for symbol in SYMBOLS)
    assert text() == text()


@needs_code
def test_objects_lie_in_memory_as_the_code_expects():
    """The offsets that `rosetta_jit/runtime/attributes/*/*.ll` name."""

    def offsets(made, *names):
        return tuple(slot_offset(vars(made)[name]) for name in names)

    assert offsets(Message, "access_", "entry_", "lanes_", "parent_") == (72, 80, 88, 96)
    assert (Message.__weakrefoffset__, Message.__basicsize__) == (OFFSETS["MESSAGE_WEAK_LIST"], OFFSETS["MESSAGE_END"])
    assert offsets(Sequence, "entry", "message", "node", "spare_one", "spare_two") == (24, 32, 40, 48, 56)
    assert offsets(Lanes, "arrays") == (40,)
    assert (8 * WASTED, 8 * EPOCH, VALID, UNSETTLED) == (120, 8, 0, 2)
    assert (SCALARS.index("i8"), SCALARS.index("u64"), SCALARS.index("f32"), SCALARS.index("f64")) == (1, 8, 9, 10)


def poses(count):
    decode, encode = (program.of("geometry_msgs/PoseArray", encoding="ros1") for program in (rj.Decoder, rj.Encoder))
    holder = decode.new()
    holder.poses = [{"position": {"x": float(each)}} for each in range(count)]
    return decode, encode, holder


def test_views_that_somebody_has_stay_where_they_are():
    _, _, holder = poses(6)
    shown = holder.poses
    first, second = shown[0], shown[1].position
    others = [each.position for each in shown]
    assert [each.position.x for each in shown] == [0, 1, 2, 3, 4, 5]
    assert (first.position.x, second.x, [each.x for each in others]) == (0, 1, [0, 1, 2, 3, 4, 5])
    assert [each.position.x for each in list(shown)] == [0, 1, 2, 3, 4, 5]
    pairs = [(one.position.x, other.position.x) for one in shown for other in shown]
    assert pairs == [(one, other) for one in range(6) for other in range(6)]
    seen = weakref.ref(shown[3])
    assert seen() is None or seen().position.x == 3
    iterator = iter(shown)
    assert (next(iterator).position.x, next(iterator).position.x) == (0, 1)


def test_views_follow_their_element_into_the_next_message():
    decode, encode, holder = poses(4)
    _, _, other = poses(2)
    other.poses[1].position.x = 9.0
    own = decode(encode(holder))
    shown, last, second = own.poses, own.poses[3], own.poses[1].position
    assert decode(encode(other)) is own
    assert (len(shown), second.x, [each.position.x for each in shown]) == (2, 9, [0, 9])
    with pytest.raises(InvalidHolder):
        _ = last.position.x
    with pytest.raises(IndexError):
        shown[2]
    with pytest.raises(rj.DecodeError):
        decode(b"\0")
    for read in (lambda: own.header.seq, lambda: len(shown), lambda: shown[0], lambda: list(shown), lambda: second.x):
        with pytest.raises(InvalidHolder):
            read()


def test_sequences_within_elements():
    decode, encode = (program.of("diagnostic_msgs/DiagnosticArray", encoding="ros1") for program in (rj.Decoder, rj.Encoder))
    holder = decode.new()
    holder.status = [
        {"name": f"n{each}", "values": [{"key": f"k{inner}", "value": str(each)} for inner in range(each)]} for each in range(5)
    ]
    expected = [(f"n{each}", [(f"k{inner}", str(each)) for inner in range(each)]) for each in range(5)]
    for found in (holder, decode(encode(holder))):
        assert [(each.name, [(pair.key, pair.value) for pair in each.values]) for each in found.status] == expected
        kept = [each.values for each in found.status]
        assert [[(pair.key, pair.value) for pair in values] for values in kept] == [values for _, values in expected]
        inner = found.status[4].values[2]
        assert [len(each.values) for each in found.status] == [0, 1, 2, 3, 4]
        assert (inner.key, inner.value) == ("k2", "4")


def test_a_view_keeps_the_lanes_and_not_the_holder():
    _, _, holder = poses(3)
    seen = weakref.ref(holder)
    position, shown = holder.poses[2].position, holder.poses
    del holder
    assert seen() is None
    assert (position.x, len(shown), shown[0].position.x) == (2, 3, 0)


def test_arrays_that_somebody_changed_are_not_given_out_again():
    holder = rj.Decoder.of("sensor_msgs/JointState", encoding="ros1").new()
    holder.position = [1.0, 2.0, 3.0, 4.0]
    for change in (
        lambda array: setattr(array, "shape", (2, 2)),
        lambda array: setattr(array, "dtype", np.int64),
        lambda array: array.setflags(write=False),
    ):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of numpy, which will refuse some of them
            change(holder.position)
        assert (holder.position.tolist(), holder.position.flags.writeable) == ([1, 2, 3, 4], True)
    held = holder.position
    assert holder.position is not held
    assert np.shares_memory(holder.position, held)


def test_texts_of_a_list_that_changes_meanwhile():
    """Making room may collect garbage, and so run anything."""
    holder = rj.Decoder.of("sensor_msgs/JointState", encoding="ros1").new()
    names = [f"joint{each}" for each in range(500)]
    holder.name = names
    assert list(holder.name) == names
    holder.name.extend(names)
    holder.name.append("last")
    assert list(holder.name) == [*names, *names, "last"]
    holder.name = ["a"]
    holder.name = [*names, "b"]
    assert list(holder.name) == [*names, "b"]
    holder.name = []
    assert not list(holder.name)


def test_texts_of_an_array_have_their_own_limit():
    holder = made_of("t::All")()
    holder.few = ["abc"]
    with pytest.raises(ValueError, match="3"):
        holder.few.extend(["abcd"])
    assert list(holder.few) == ["abc"]
    with pytest.raises(ValueError, match="3"):
        holder.few = ["abcd"]


@needs_code
def test_what_is_in_use_is_refused():
    holder = rj.Decoder.of("sensor_msgs/Imu", encoding="ros1").new()
    uses = (
        lambda: holder.header.seq,
        lambda: holder.header.frame_id,
        lambda: holder.orientation_covariance,
        lambda: setattr(holder.header, "seq", 1),
        lambda: setattr(holder.header, "frame_id", "x"),
        lambda: setattr(holder, "orientation_covariance", [0.0] * 9),
    )
    with holder.lanes_:
        for use in uses:
            with pytest.raises(InUse):
                use()
    for use in uses:
        use()


BOTH_WAYS = (
    *("runtime/test_holder*.py", "runtime/test_attributes.py", "runtime/test_names.py", "runtime/test_making.py"),
    *("runtime/test_columns.py", "runtime/test_parts.py", "runtime/test_looks.py"),
    *("frameworks/*/test_*manners*.py", "frameworks/protobuf/test_json_format.py"),
    *("api/test_objects.py", "api/test_steps.py", "frameworks/protobuf/test_objects.py"),
)
"""Tests of holders, which hold of any Python."""


@pytest.mark.skipif(not is_native(), reason="it is so anyway")
def test_everything_holds_without_compiled_accessors(request):
    """Python and its messages as those that no compiled code knows. A campaign runs the long tests, too."""
    found = [sorted(Path(__file__).parents[1].glob(pattern)) for pattern in BOTH_WAYS]
    assert all(found)
    files = [str(path) for some in found for path in some]
    program = (
        "import sys, pytest, rosetta_jit.runtime.callable as known\n"
        "known.is_native = lambda: False\n"
        f"sys.exit(pytest.main(['-q', '-p', 'no:randomly', '-m', {request.config.getoption('markexpr')!r}, *{files!r}]))"
    )
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout[-3000:]


@needs_code
def test_a_float_that_somebody_has_stays_as_it_is():
    """Floats that nobody has any more are given out again."""
    decoder = rj.Decoder.of("geometry_msgs/Quaternion", encoding="ros1")
    quaternion = decoder.new()
    for kept in (0, 1, 7, 8, 9, 40):
        held = []
        for number in range(100):
            quaternion.x, quaternion.y = float(number), number + 0.5
            held.append((quaternion.x, quaternion.y, -quaternion.x))
            assert quaternion.x + quaternion.y == 2 * number + 0.5
            assert [quaternion.x, quaternion.y, quaternion.x] == [number, number + 0.5, number]
            del held[: max(0, len(held) - kept)]
            assert held == [(float(each), each + 0.5, -float(each)) for each in range(number + 1 - len(held), number + 1)]


@needs_code
def test_an_element_is_asked_for_again():
    """The view that nobody has any more is already where it should be; what its parts showed when somebody took them stays."""
    decoder = rj.Decoder.of("geometry_msgs/PoseArray", encoding="ros1")
    array = decoder.holder_type.from_dict({"poses": [{"position": {"x": float(number)}} for number in range(4)]})
    assert [array.poses[1].position.x, array.poses[1].position.x, array.poses[-3].orientation.w] == [1.0, 1.0, 0.0]
    part = array.poses[1].position
    assert array.poses[1].position.x == 1.0
    assert array.poses[2].position.x == 2.0
    assert array.poses[1].position.x == 1.0
    assert part.x == 1.0
    one, other = array.poses[3], array.poses[3]
    one.position.x = 7.0
    assert other.position.x == array.poses[3].position.x == 7.0
    del array.poses[0]
    assert [array.poses[1].position.x, array.poses[2].position.x] == [2.0, 7.0]
    array.poses[1].position.x = 5.0
    assert [each.position.x for each in array.poses] == [1.0, 5.0, 7.0]
    with pytest.raises(IndexError):
        array.poses[3]


def test_parts_of_an_element_follow_it_when_the_message_changes():
    """The view of an element that is asked for again stays, and its parts look for its row."""
    decode, encode, holder = poses(4)
    own = decode(encode(holder))
    for turn in range(1, 4):
        own.poses[2].position.x = 10.0 * turn
        assert own.poses[2].orientation.w == turn - 1
        own.poses[2].orientation.w = turn
        assert (own.poses[2].position.x, own.poses[1].position.x, own.poses[2].orientation.w) == (10 * turn, 1, turn)
    part = own.poses[2].position
    own.poses.insert(0, {"position": {"x": -1.0}})
    assert (own.poses[2].position.x, own.poses[3].position.x, own.poses[3].orientation.w, part.x) == (1, 30, 3, 1)
    own.poses.extend([{"position": {"x": 50.0}}] * 1000)  # the lane lies elsewhere
    assert (own.poses[3].position.x, own.poses[3].orientation.w) == (30, 3)
    assert decode(encode(holder)) is own
    assert (own.poses[3].position.x, own.poses[3].orientation.w) == (3, 0)
    own.poses[3].orientation.w = 8.0
    own.header.frame_id = "base"
    assert [(each.position.x, each.orientation.w) for each in own.poses] == [(0, 0), (1, 0), (2, 0), (3, 8)]
    own.poses = []
    with pytest.raises(IndexError):
        own.poses[3]
    with pytest.raises(InvalidHolder):
        _ = part.x


@needs_code
def test_integers_of_every_size_stay_as_they_are():
    """As of floats; CPython's own small ones are the same objects everywhere."""
    holder = rj.Decoder.of("t.All", **PROTO).new()
    edges = [0, 1, 5, 6, 255, 256, 257, (1 << 30) - 1, 1 << 30, (1 << 59) + 1, (1 << 60) - 1, 1 << 60, (1 << 60) + 1, (1 << 63) - 1]
    values = [*edges, *(-each for each in edges), -(1 << 63)]
    for kept in (0, 3, 8, 100):
        held = []
        for number, value in enumerate(values * 3):
            holder.i64, holder.u64, holder.i32 = value, value % (1 << 64), number
            read = [holder.i64, holder.u64, holder.i32, holder.i64 + 1, -holder.i64]
            assert read == [value, value % (1 << 64), number, value + 1, -value]
            assert str(holder.i64) == str(value)
            assert hash(holder.i64) == hash(value)
            assert {value: 1}[holder.i64] == 1
            assert holder.i64.bit_length() == value.bit_length()
            assert (holder.i64 is holder.i64) or not -5 <= value <= 256
            held.append((holder.i64, value))
            del held[: max(0, len(held) - kept)]
            assert all(one == other for one, other in held)
