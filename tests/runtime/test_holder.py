"""Holders: what is written is read, whatever grows, moves, borrows or fails meanwhile."""

from __future__ import annotations

import copy
import gc
import json
import math
import pickle
import sys
import tracemalloc
from pathlib import Path
from types import MemberDescriptorType

import numpy as np
import pytest

from rosetta_jit.errors import EncodeError, InUse, InvalidHolder, ValuesError
from rosetta_jit.kernel.state import CAPACITY, CLEAN, UNSETTLED, USED, VALID, lane_word
from rosetta_jit.model.limits import MAX_SERIAL_DEPTH
from rosetta_jit.model.serial import declared_in, from_plain, to_plain
from rosetta_jit.model.types import Array, Bytes, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct, Union
from rosetta_jit.runtime.holder import holder_class, holder_class_of
from rosetta_jit.runtime.lanes import Lanes

sys.path.insert(0, str(Path(__file__).parent))
from schemas import FLAT, SCHEMA, flat, whole

FULL = {
    "small": -3, "single": 0.5, "maybe": 1.0, "flag": True, "kind": "B", "angles": [1.0, 2.5], "text": "hé", "data": b"\0\xff",
    "part": {"x": 1, "name": "p", "values": [0.1]}, "parts": [{"name": "", "values": []}, {"x": 2, "name": "q", "values": [1.0, 2.0]}],
    "names": ["a", ""], "matrix": [[1, 2], [], [65535]], "fixed": [1, 2, 3], "by_name": {"k": {"x": 7, "name": "", "values": []}},
    "counts": {-1: 2**40}, "right": {"name": "r", "values": []},
}  # fmt: skip


def test_the_data_of_a_type_have_those_of_the_declarations_that_it_reaches():
    """What a nested message is known by is the same, whether it was found in another type's data or made."""
    plain, known = to_plain(Ref("t.Whole"), SCHEMA), {}
    assert len(plain["declared"]) == 3
    for name in plain["declared"]:
        found, made = declared_in(plain, name, known), to_plain(Ref(name), SCHEMA)
        assert json.dumps(found) == json.dumps(made)


def test_dicts_go_in_and_come_out():
    nested = FULL | {"child": FULL | {"children": [FULL | {"children": []}]}, "children": [FULL | {"children": []}] * 2}
    assert flat().from_dict(FULL).to_dict() == FULL
    assert whole().from_dict(nested).to_dict() == nested
    assert flat()().to_dict()["fixed"] == [0, 0, 0]
    assert "maybe" not in flat()().to_dict()


@pytest.mark.parametrize(
    ("values", "path"),
    [
        ({"nothing": 1}, ".nothing"), ({"parts": [{}, {"x": "q"}]}, ".parts[1].x"), ({"small": 128}, ".small"), ({"small": 1.0}, ".small"),
        ({"fixed": [1]}, ".fixed"), ({"text": 1}, ".text"), ({"kind": "C"}, ".kind"), ({"part": 1}, ".part"), ({"parts": 1}, ".parts"),
        ({"parts": "ab"}, ".parts"), ({"by_name": {"a": {"z": 1}}}, ".by_name['a'].z"), ({"counts": {"a": 1}}, ".counts['a']"),
        ({"matrix": [[1], [-1]]}, ".matrix[1]"), ({"angles": ["x"]}, ".angles"), ({"names": ["a", 1]}, ".names[1]"), (3, ""),
        ({"angles": np.zeros((2, 2))}, ".angles"), ({"text": "\udc80"}, ".text"), ({1: 2}, ".1"),
    ],
)  # fmt: skip
def test_wrong_values_are_refused_with_their_path(values, path):
    with pytest.raises(ValuesError) as error:
        flat().from_dict(values)
    assert error.value.path == path


def test_numbers_are_views_of_the_lane():
    holder = flat()()
    holder.angles = [1, 2, 3]
    view = holder.angles
    assert (view.dtype, view.tolist()) == (np.float32, [1, 2, 3])
    view[1] = 7
    assert holder.angles[1] == 7
    assert np.shares_memory(view, holder.angles)
    holder.angles = np.arange(1000, dtype=np.float32)
    assert view.tolist() == [1, 7, 3]
    assert holder.angles.sum() == 499500
    holder.angles = np.arange(3.0)
    assert holder.angles.dtype == np.float32


def test_octets_that_are_no_text_survive():
    holder = flat()()
    holder.part.name = b"\xff\x00a"
    assert holder.part.name == "\udcff\0a"
    holder.part.name = holder.part.name + "b"
    assert bytes(holder.part.view("name")) == b"\xff\x00ab"


def test_images_of_numpy_are_bytes():
    image = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    holder = flat()()
    holder.data = image[:, ::-1]
    assert holder.data == image[:, ::-1].tobytes()
    view = holder.view("data")
    view[0] = 99
    assert holder.data[0] == 99


def test_strings_reuse_their_room():
    holder = flat()()
    for count in range(3000):
        holder.text = "x" * (count % 100)
    assert holder.lanes_.capacity(holder.access_.record.entries["text"].node.lane) < 300


def test_what_is_left_behind_is_tidied_up():
    holder = flat().from_dict({"parts": [{"name": "a"}] * 10})
    for count in range(4000):
        for each in holder.parts:
            each.name = "x" * (count % 90)
        if holder.lanes_.words[VALID] == UNSETTLED:
            holder.materialise()
    assert sum(buffer.size for buffer in holder.lanes_.buffers) < 1 << 18
    assert [each.name for each in holder.parts] == ["x" * (3999 % 90)] * 10


def test_plain_sequences_and_maps():
    holder = flat()()
    holder.parts = [{"x": 1}, {"x": 2}]
    holder.parts.append(holder.parts[0])
    holder.parts[1] = {"x": 9, "name": "n"}
    assert [each.x for each in holder.parts] == [1, 9, 1]
    holder.parts[0:2] = [{"x": 5}]
    assert [each.x for each in holder.parts] == [5, 1]
    del holder.parts[0]
    assert holder.parts.pop().x == 1
    holder.names.extend(["a", "b"])
    holder.names += ["c"]
    assert holder.names == ["a", "b", "c"]
    holder.names = (each for each in holder.names)
    holder.parts = holder.parts
    assert holder.names[::-1] == ["c", "b", "a"]
    holder.matrix = [[1, 2], [3]]
    holder.matrix.append([4])
    assert [each.tolist() for each in holder.matrix] == [[1, 2], [3], [4]]
    holder.by_name["k"] = {"x": 1}
    holder.by_name["k"].name = "v"
    holder.by_name["k"] = {"x": 2}
    assert (holder.by_name["k"].x, holder.by_name["k"].name) == (2, "")
    with pytest.raises(KeyError):
        holder.by_name["z"]
    holder.counts.update({1: 2, 3: 4})
    assert holder.counts == {1: 2, 3: 4}
    assert holder.counts.pop(1) == 2
    with pytest.raises(ValuesError):
        holder.parts.append({"nothing": 1})
    assert len(holder.parts) == 0


def test_presence_and_unions():
    holder = flat()()
    assert (holder.maybe, holder.has("maybe"), holder.has("small")) == (2.5, False, True)
    holder.maybe = 0.0
    assert (holder.maybe, holder.has("maybe")) == (0.0, True)
    holder.clear("maybe")
    assert holder.maybe == 2.5
    assert holder.which("either") is None
    holder.left = 3
    holder.right.name = "r"
    assert (holder.which("either"), holder.left) == ("right", 0)
    holder.left = 4
    assert holder.right.name == ""
    holder.clear()
    assert holder == flat()()
    with pytest.raises(KeyError):
        holder.has("nothing")
    with pytest.raises(AttributeError):
        holder.nothing = 1


def test_an_element_that_is_gone_says_so():
    holder = flat().from_dict({"parts": [{"x": 1}]})
    element = holder.parts[0]
    del holder.parts[0]
    with pytest.raises(InvalidHolder):
        _ = element.x


def test_a_failed_decode_is_noticed():
    holder = flat().from_dict(FULL)
    part, parts = holder.part, holder.parts
    holder.lanes_.words[VALID] = 0
    for name in FULL:
        if isinstance(getattr(type(holder), name), MemberDescriptorType):
            continue  # a view that has been there: to read it fails
        with pytest.raises(InvalidHolder):
            getattr(holder, name)
    for read in (
        holder.to_dict,
        lambda: part.x,
        lambda: parts[0],
        lambda: len(parts),
        lambda: holder == holder.new(),
        lambda: holder.view("data"),
    ):
        with pytest.raises(InvalidHolder):
            read()
    with pytest.raises(InvalidHolder):
        holder.small = 1
    assert "failed" in repr(holder)
    assert isinstance(holder.lanes_.invalid(), InvalidHolder)
    holder.clear()
    assert holder.to_dict() == flat()().to_dict()


def test_a_decode_that_was_done_in_the_meantime_has_not_failed():
    holder = flat().from_dict(FULL)
    assert isinstance(holder.lanes_.invalid(), InUse)  # what was being filled when a reader looked, and is whole now
    holder.lanes_.begin_filling()
    assert isinstance(holder.lanes_.invalid(), InUse)


def test_copies_and_pickles():
    holder = whole().from_dict(FULL | {"child": FULL})
    for other in (copy.copy(holder), copy.deepcopy(holder), pickle.loads(pickle.dumps(holder))):  # noqa: S301
        assert other == holder
        other.child.angles[0] = 9
        other.child.text = "other"
        assert other != holder
    holder.children = [holder, holder]
    assert holder.children[1].child == holder.child
    holder.part = holder.parts[1]
    assert holder.part.x == 2
    assert flat().from_dict({"single": math.nan}) != flat().from_dict({"single": math.nan})


def borrow(holder, source, start, size):
    """As a kernel that borrows leaves it."""
    span = holder.access_.record.entries["data"].node.span
    words = holder.lanes_.cells[span.key]
    words[span.index], words[span.index + 1] = start, ~size
    holder.lanes_.source[0] = source


@pytest.mark.parametrize("source", [b"..abc..", bytearray(b"..abc.."), np.frombuffer(b"..abc..", np.uint8)])
def test_borrowed_bytes(source):
    holder = flat()()
    borrow(holder, source, 2, 3)
    assert (holder.data, holder.to_dict()["data"], bytes(holder.view("data"))) == (b"abc",) * 3
    assert not holder.view("data").flags.writeable
    assert np.shares_memory(holder.view("data"), np.frombuffer(source, np.uint8))
    assert copy.copy(holder) == holder
    other = copy.copy(holder)
    assert other.lanes_.source == [None]
    holder.lanes_.unsettle()
    holder.materialise()
    assert (holder.data, holder.lanes_.source, holder.lanes_.words[VALID]) == (b"abc", [None], CLEAN)
    borrow(holder, source, 2, 3)
    holder.data = b"xy"
    assert holder.data == b"xy"
    borrow(holder, source, 2, 3)
    holder.clear("data")
    assert holder.data == b""


def test_recursive_messages():
    holder = whole()()
    for index in range(5):
        holder.children.append({"small": index, "child": {"small": index + 1}})
    holder.child.small = 1
    holder.children.insert(0, {"small": 9})
    holder.children.reverse()
    expected = holder.to_dict()
    assert [each.small for each in holder.children] == [4, 3, 2, 1, 0, 9]
    assert [each.child.small for each in holder.children] == [5, 4, 3, 2, 1, 0]
    holder.lanes_.unsettle()
    holder.materialise()
    assert holder.to_dict() == expected


def test_depth_is_bounded():
    node_type = Struct("t.Node", (Field("small", Int(32)), Field("child", Optional(Ref("t.Node")))))
    cls = holder_class(Ref("t.Node"), Schema({"t.Node": node_type}))
    holder = cls()

    def deepen():
        node = holder
        for _ in range(100_000):
            node = node.child
            node.small = 1

    with pytest.raises(EncodeError, match="deep"):
        deepen()
    deep = {}
    for _ in range(100_000):
        deep = {"child": deep}
    with pytest.raises((EncodeError, ValuesError), match="deep"):
        cls.from_dict(deep)

    def contain():
        for _ in range(200):
            grown = holder.new()
            grown.child = holder
            holder.child = grown.child

    holder.clear()
    holder.child.small = 1
    with pytest.raises(ValuesError, match="deep"):
        contain()


HOSTILE = (
    "__init__",
    "__class__",
    "__slots__",
    "lanes_",
    "row_",
    "family_",
    "class",
    "to_dict",
    "new",
    "view",
    "a b",
    "'",
    "\n",
    "__import__",
)


def test_hostile_names():
    struct = Struct("t.class.'); import os", tuple(Field(name, Int(32)) for name in HOSTILE))
    cls = holder_class(struct, Schema({}))
    values = {name: index for index, name in enumerate(HOSTILE)}
    holder = cls.from_dict(values)
    assert cls.__dict__["to_dict"].__get__(holder) == HOSTILE.index("to_dict")
    assert copy.copy(holder) == holder
    assert getattr(holder, "'") == HOSTILE.index("'")
    assert holder.new == HOSTILE.index("new")
    assert type(holder) is cls
    assert "to_dict=" in repr(holder)


def test_types_that_cannot_be_held():
    for wrong in (Int(32), Array(Int(8)), Struct("t", (Field("u", Array(Union("u", (Field("a", Int(8)),)))),))):
        with pytest.raises(ValueError, match=r"held|struct"):
            holder_class(wrong, Schema({}))


def test_classes_are_shared_and_rebuilt_from_plain_data():
    plain = json.loads(json.dumps(to_plain(Ref("t.Whole"), SCHEMA)))
    assert holder_class_of(plain) is whole()
    assert from_plain(plain) == (Ref("t.Whole"), SCHEMA)
    numbers = {"is": "Array", "element": {"is": "Int", "bits": 8}}
    wrong = (
        "Int",
        3,
        ["Int"],
        {"is": "Int"},
        {"is": "cast"},
        {"is": "nothing"},
        {"is": "Int", "bits": 8, "bytes": 1},
        {**numbers, "is": "Len"},
    )
    for plain in ({}, {"type": numbers, "declared": 1}, *({"type": each, "declared": {}} for each in wrong)):
        with pytest.raises(ValueError, match="not a type"):
            from_plain(plain)
    for _ in range(MAX_SERIAL_DEPTH):
        numbers = {"is": "Array", "element": numbers}
    with pytest.raises(ValueError, match="nest more than"):
        from_plain({"type": numbers, "declared": {}})


def test_lanes_grow_and_keep_what_they_hold():
    lanes = Lanes.of(flat().family_.layout)
    lane = 1
    before = lanes.arrays[lane]
    before[0] = 5
    lanes.give_back(lane, 1)
    address = lanes.words[lane_word(lane, 0)]
    with lanes:
        lanes.grow(lane, 1000)
    assert lanes.words[lane_word(lane, 0)] != address
    assert lanes.words[lane_word(lane, CAPACITY)] >= 1000
    assert lanes.words[lane_word(lane, USED)] == 1
    assert lanes.arrays[lane][0] == 5
    before[0] = 6
    assert lanes.arrays[lane][0] == 5
    assert all(lanes.words[lane_word(each, 0)] % 64 == 0 for each in range(len(lanes.buffers)))
    with lanes:
        lanes.grow(lane, 10_000)
    assert lanes.words[lane_word(lane, 0)] % 4096 == 0
    with lanes, pytest.raises(MemoryError):
        lanes.grow(lane, 1 << 55)
    assert lanes.arrays[lane][0] == 5


def test_thousands_of_holders_are_small():
    cls = flat()
    gc.collect()
    tracemalloc.start()
    holders = [cls() for _ in range(200)]
    for holder in holders:
        holder.angles = [1.0] * 24
    size, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert size / len(holders) < 20_000


def test_used_types_are_those_of_the_schema():
    assert {type(field.type) for field in FLAT.fields} >= {Array, Bytes, Float, Int, Map, Optional, Ref, String, Union}


def test_what_is_refused_leaves_all_as_it_was():
    """Also where half of the value was right, the lanes have moved meanwhile, or messages around were brought into being."""
    schema = {
        "u.proto": 'syntax = "proto2";\nmessage U { repeated string names = 1; repeated U more = 2; optional U child = 3;\n'
        "optional int32 x = 4; map<string, U> named = 5; repeated string after = 6; }\n"
    }
    from rosetta_jit import Decoder
    from rosetta_jit.runtime.holder import PLAIN

    own = Decoder.of("U", schema=schema, encoding="protobuf", imports=["u.proto"]).holder_type.family_
    made = holder_class(own.type, own.schema, PLAIN)
    value = {"names": ["a", "bc"], "more": [{"x": 1, "names": ["d"]}, {"x": 2}], "named": {"k": {"x": 3}}, "after": ["z"]}
    wrong = {
        "names": ["x" * 3000, 1],
        "more": [{"names": ["y" * 99]}, {"x": "no"}],
        "named": {"a": {"x": 5}, "k": {"x": "no"}},
        "child": {"child": {"names": ["q"], "x": 2.5}},
    }
    message = made.from_dict(value)
    expected = message.to_dict()
    for name, refused in wrong.items():
        for _ in range(3):
            with pytest.raises((ValueError, TypeError)):
                setattr(message, name, refused)
            assert message.to_dict() == expected
    assert not message.has("child")
    with pytest.raises(ValueError, match=r"x"):
        message.child.child.more = [{"x": 1}, {"x": "no"}]
    assert message.to_dict() == expected
    assert not message.has("child")
    message.child.child.more = [{"x": 1}]
    message.names = ["new"]
    assert message.to_dict() == expected | {"names": ["new"], "child": message.child.to_dict()}
    assert message.child.child.more[0].x == 1
