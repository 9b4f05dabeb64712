"""Code written against protobuf's classes, run on them and on ours."""

from __future__ import annotations

import copy
import math
import pickle

import numpy as np
import pytest


def test_defaults_of_what_is_absent(everything):
    message = everything()
    assert (message.i32, message.i64, message.u64, message.fl, message.flag) == (0, -7, 0, 1.5, True)
    assert (message.text, message.data, message.color, message.outside) == ("hé", b"\0x", 3, 4)
    assert message.inner.x == 0
    assert message.inner.deep.d == 0.0
    assert message.child.child.child.i64 == -7
    assert not message.HasField("child")
    assert list(message.ints) == []
    assert len(message.inners) == 0


def test_types_of_what_is_read(everything):
    message = everything(i32=1, fl=0.5, flag=False, text="a", data=b"b", color=1)
    read = [message.i32, message.fl, message.flag, message.text, message.data, message.color]
    assert [type(value) for value in read] == [int, float, bool, str, bytes, int]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("i32", -(2**31)), ("i64", 2**63 - 1), ("u32", 2**32 - 1), ("u64", 2**64 - 1), ("s32", -5), ("s64", -(2**63)), ("f32", 9),
        ("f64", 2**64 - 1), ("sf32", -9), ("sf64", -10), ("fl", 0.25), ("fl", math.inf), ("db", 1e300), ("db", 3), ("flag", False),
        ("flag", 1), ("text", "π\0"), ("text", b"bytes"), ("text", ""), ("data", b"\xff\0"), ("color", 7), ("color", "GREEN"),
        ("outside", 0), ("number", 4), ("word", "w"), ("chosen", 1), ("i32", np.int8(3)), ("db", np.float32(0.5)), ("f32", np.uint64(3)),
    ],
)  # fmt: skip
def test_assigned_values_are_read_back(everything, name, value):
    message = everything()
    setattr(message, name, value)
    expected = {"GREEN": 1, b"bytes": "bytes"}.get(value, value) if isinstance(value, str | bytes) else value
    assert getattr(message, name) == expected
    assert message.HasField(name)
    message.ClearField(name)
    assert not message.HasField(name)
    assert getattr(message, name) == getattr(everything(), name)


@pytest.mark.parametrize(
    ("name", "value", "error"),
    [
        ("i32", 2**31, ValueError), ("i32", -(2**31) - 1, ValueError), ("u32", -1, ValueError), ("u64", 2**64, ValueError),
        ("i64", 2**63, ValueError), ("i32", 1.0, TypeError), ("i32", "1", TypeError), ("i32", True, TypeError), ("i32", None, TypeError),
        ("fl", "1", TypeError), ("db", None, TypeError), ("db", b"1", TypeError), ("flag", 1.0, TypeError), ("flag", "x", TypeError),
        ("text", 1, TypeError), ("text", b"\xff", ValueError), ("text", "\udc80", ValueError), ("data", "a", TypeError),
        ("data", 1, TypeError), ("color", 2, ValueError), ("color", "BLUE", ValueError), ("color", 1.0, TypeError),
        ("outside", 1, ValueError), ("inner", None, AttributeError), ("ints", [1], AttributeError), ("inners", [], AttributeError),
        ("counts", {}, AttributeError), ("nothing", 1, AttributeError), ("child", 1, AttributeError),
    ],
)  # fmt: skip
def test_wrong_values_are_refused(everything, name, value, error):
    message = everything()
    with pytest.raises(error):
        setattr(message, name, value)
    assert message == everything()


def test_unknown_names(everything):
    message = everything()
    with pytest.raises(AttributeError):
        _ = message.nothing
    for call in (message.HasField, message.ClearField, message.WhichOneof):
        with pytest.raises(ValueError, match="nothing"):
            call("nothing")
    with pytest.raises(ValueError, match="presence"):
        message.HasField("ints")
    with pytest.raises(ValueError, match="nothing"):
        everything(nothing=1)


def test_names_in_messages(everything):
    message = everything(text="")
    assert "text" in message
    assert "inner" not in message
    assert "word" not in message
    for name in ("ints", "nothing", 5):
        with pytest.raises(ValueError, match=r"presence|nothing|non-string"):
            _ = name in message


def test_keywords(everything):
    message = everything(
        i32=3, color="GREEN", ints=(1, 2), texts=["a"], inner={"x": 4, "names": ["n"]}, inners=[{"x": 1}, everything.Inner(x=2)],
        child=everything(i32=9), counts={"a": 1}, by_id={5: everything.Inner(x=6)}, word="w", text=None,
    )  # fmt: skip
    assert (message.i32, message.color, message.inner.x, message.inner.names[0], message.child.i32) == (3, 1, 4, "n", 9)
    assert [each.x for each in message.inners] == [1, 2]
    assert list(message.ints) == [1, 2]
    assert dict(message.counts) == {"a": 1}
    assert message.by_id[5].x == 6
    assert not message.HasField("text")
    for wrong, error in [({"ints": 1}, TypeError), ({"inner": 1}, TypeError), ({"i32": "x"}, TypeError), ({"u32": -1}, ValueError)]:
        with pytest.raises(error):
            everything(**wrong)


def test_writing_to_a_nested_message_makes_it_present(everything):
    message = everything()
    message.inner.deep.d = 2.5
    assert message.HasField("inner")
    assert message.inner.HasField("deep")
    message.child.child.i32 = 1
    assert message.child.child.i32 == 1
    assert not message.child.child.HasField("child")
    message.ClearField("child")
    assert message.child.child.i32 == 0
    message.child.SetInParent()
    assert message.HasField("child")


def test_views_see_what_others_write(everything):
    message = everything()
    first, second = message.child, message.child
    first.i32 = 5
    assert second.i32 == 5
    element = message.inners.add()
    for _ in range(50):
        message.inners.add().names.append("x")
        message.children.add().children.add(i32=2)
    element.x = 7
    element.names.extend(["a", "b"])
    assert (message.inners[0].x, list(message.inners[0].names)) == (7, ["a", "b"])
    assert [each.children[0].i32 for each in message.children] == [2] * 50


def test_oneof(everything):
    message = everything()
    assert message.WhichOneof("choice") is None
    assert not message.HasField("choice")
    message.number = 4
    message.message.x = 3
    assert message.WhichOneof("choice") == "message"
    assert (message.number, message.HasField("number"), message.HasField("choice")) == (0, False, True)
    message.word = "w"
    assert message.message.x == 0
    message.message.SetInParent()
    assert message.message.x == 0
    message.ClearField("number")
    assert message.WhichOneof("choice") == "message"
    message.ClearField("choice")
    assert message.WhichOneof("choice") is None
    message.chosen = 7
    assert everything(number=0).WhichOneof("choice") == "number"


def filled(everything):
    message = everything(i32=1, text="t", ints=[1, 2], texts=["a"], inner={"x": 1, "names": ["p"]}, counts={"a": 1}, word="w")
    message.children.add(i32=4).child.i32 = 5
    message.by_id[1].x = 1
    message.grouped.y = 3
    message.several.add(z=4)
    return message


def test_merge(everything):
    message = filled(everything)
    other = everything(i32=2, ints=[3], inner={"names": ["q"]}, counts={"a": 9, "b": 2}, number=3, by_id={1: {"names": ["n"]}})
    other.children.add(i32=8)
    message.MergeFrom(other)
    assert (message.i32, message.text, list(message.ints)) == (2, "t", [1, 2, 3])
    assert (message.inner.x, list(message.inner.names)) == (1, ["p", "q"])
    assert dict(message.counts) == {"a": 9, "b": 2}
    assert (message.by_id[1].x, list(message.by_id[1].names)) == (0, ["n"])
    assert message.WhichOneof("choice") == "number"
    assert [each.i32 for each in message.children] == [4, 8]
    assert message.children[0].child.i32 == 5


def test_copies_are_equal_and_independent(everything):
    message = filled(everything)
    copies = [everything(), copy.copy(message), copy.deepcopy(message)]
    copies[0].CopyFrom(message)
    for copied in copies:
        assert copied == message
        copied.children[0].child.i32 = 6
        assert copied != message
    message.CopyFrom(message)
    assert message == filled(everything)
    for wrong in (1, None, everything.Inner()):
        with pytest.raises(TypeError):
            message.CopyFrom(wrong)
        with pytest.raises(TypeError):
            message.MergeFrom(wrong)


def test_copies_into_what_contains_them(ours):
    """Protobuf's own classes crash here."""
    message = filled(ours("second.All"))
    message.child.CopyFrom(message)
    assert message.child.children[0].child.i32 == 5
    message.CopyFrom(message.child)
    assert message == filled(ours("second.All"))
    message.children[0].child.MergeFrom(message)
    assert message.children[0].child.children[0].child.i32 == 5


def test_equality(everything):
    assert everything() == everything()
    assert everything(i32=0) != everything()
    assert everything(ints=[1]) != everything(ints=[2])
    assert everything(counts={"a": 1, "b": 2}) == everything(counts={"b": 2, "a": 1})
    assert everything() != 1
    assert everything() != everything.Inner()
    assert everything(inner={}) != everything()
    with pytest.raises(TypeError):
        hash(everything())


def test_clear(everything):
    message = filled(everything)
    message.inner.Clear()
    assert message.HasField("inner")
    assert message.inner.x == 0
    message.Clear()
    assert message == everything()


def test_listed_fields(everything):
    message = filled(everything)
    listed = message.ListFields()
    names = [field.name for field, _ in listed]
    assert names == ["i32", "text", "inner", "ints", "texts", "children", "word", "counts", "by_id", "grouped", "several"]
    assert [field.number for field, _ in listed] == [1, 14, 18, 20, 24, 28, 31, 40, 41, 50, 51]
    assert listed[0][1] == 1
    assert everything().ListFields() == []


def test_required_fields(message_class):
    needy = message_class("second.Needy")
    message = needy()
    message.other.SetInParent()
    message.others.add().others.add(must=1)
    assert not message.IsInitialized()
    assert message.FindInitializationErrors() == ["must", "other.must", "others[0].must"]
    message.must = message.other.must = message.others[0].must = 1
    assert message.IsInitialized()
    assert message.FindInitializationErrors() == []


def test_constants_and_enums(everything):
    assert (everything.RED, everything.ALIAS, everything.Color.GREEN) == (3, 7, 1)
    assert everything.Color.Value("GREEN") == 1
    assert everything.Color.Name(3) == "RED"
    assert everything.Color.keys() == ["RED", "GREEN", "ALIAS"]
    assert everything.Color.values() == [3, 1, 7]
    assert everything.Color.items()[0] == ("RED", 3)
    assert everything.I32_FIELD_NUMBER == 1
    with pytest.raises(ValueError, match="9"):
        everything.Color.Name(9)
    with pytest.raises(ValueError, match="q"):
        everything.Color.Value("q")
    assert isinstance(everything().inner, everything.Inner)
    assert isinstance(everything().inner.deep, everything.Inner.Deep)
    assert isinstance(everything().inners.add(), everything.Inner)
    assert everything.Inner(x=1).x == 1


def described(descriptor):
    def default(field):
        return None if field.message_type is not None else field.default_value

    return {
        "names": (descriptor.name, descriptor.full_name),
        "oneofs": [(each.name, [field.name for field in each.fields]) for each in descriptor.oneofs if not each.name.startswith("_")],
        "enums": sorted((name, [(v.name, v.number) for v in enum.values]) for name, enum in descriptor.enum_types_by_name.items()),
        "fields": sorted(
            (each.number, each.name, each.full_name, each.type, each.is_repeated, each.is_required, each.has_presence, each.index,
             each.message_type and each.message_type.full_name, each.enum_type and each.enum_type.full_name, str(default(each)),
             each.has_default_value)
            for each in descriptor.fields
        ),
    }  # fmt: skip


@pytest.mark.parametrize("name", ["second.All", "second.All.Inner", "second.Needy"])
def test_descriptors_say_the_same(native, ours, name):
    assert described(ours(name).DESCRIPTOR) == described(native(name).DESCRIPTOR)


def test_text_is_the_same(native, ours):
    texts = []
    for everything in (native("second.All"), ours("second.All")):
        message = filled(everything)
        message.fl, message.db, message.flag, message.color, message.data = 0.1, 1e300, False, 7, b"\0\xff'a\\"
        message.text, message.i64, message.u64 = 'é\n"\x7f', -5, 2**64 - 1
        message.floats.extend([1, 2.5, 2**31, math.inf, -math.inf, math.nan, 1 / 3])
        message.colors.append(1)
        message.message.names.append("in")
        texts.append(str(message))
    assert texts[0].splitlines() == texts[1].splitlines()


def test_proto3(plain):
    message = plain()
    assert (message.i, message.kind, message.maybe) == (0, 0, 0)
    message.kind = 99
    message.maybe = 0
    assert message.kind == 99
    assert message.HasField("maybe")
    with pytest.raises(ValueError, match="presence"):
        message.HasField("i")
    message.i, message.s, message.d = 0, "", -0.0
    assert [field.name for field, _ in message.ListFields()] == ["d", "kind", "maybe"]
    message.part.SetInParent()
    message.left = 0
    message.named["k"].x = 4
    other = plain(i=5, part={"x": 1}, kind="SOME", numbers=[1])
    other.MergeFrom(message)
    assert (other.i, other.part.x, other.kind, other.maybe, other.left) == (5, 1, 99, 0, 0)
    assert other.WhichOneof("either") == "left"
    assert other.named["k"].x == 4
    assert plain(i=0) == plain()
    other.ClearField("i")
    assert other.i == 0


def test_pickles(ours):
    message = filled(ours("second.All"))
    assert pickle.loads(pickle.dumps(message)) == message  # noqa: S301
    assert pickle.loads(pickle.dumps(message.inner)) == message.inner  # noqa: S301


def test_clearing_a_message_makes_it_present(everything):
    message = everything()
    message.child.ClearField("i32")
    message.inner.Clear()
    assert message.HasField("child")
    assert message.HasField("inner")
