"""Arrays whose type fixes their length are there from the start, bounds are kept, and matrices are numpy's."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

from rosetta_jit.errors import ValuesError
from rosetta_jit.kernel.state import UNSETTLED, VALID
from rosetta_jit.model.expr import Member, Path
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct, Union
from rosetta_jit.runtime.batches.batch import Batch
from rosetta_jit.runtime.holder import holder_class

POINT = Struct("t.Point", (Field("xy", Array(Float(64), 2)), Field("id", Bytes("octet", 3))))
NODE = Struct("t.Node", (Field("at", Array(Int(16), 2)), Field("next", Optional(Ref("t.Node"))), Field("nodes", Array(Ref("t.Node")))))
FIXED = Struct(
    "t.Fixed",
    (
        Field("cov", Array(Float(64), 9)),
        Field("matrix", Array(Array(Float(64), 4), 3)),
        Field("cube", Array(Array(Array(Int(8), 2), 3), 2)),
        Field("points", Array(Ref("t.Point"), 2)),
        Field("names", Array(String(), 2)),
        Field("flags", Array(Bool(), 2)),
        Field("point", Ref("t.Point")),
        Field("more", Array(Ref("t.Point"))),
        Field("by_name", Map(String(), Ref("t.Point"))),
        Field("maybe", Optional(Ref("t.Point"))),
        Field("either", Union("t.Fixed.either", (Field("left", Array(Int(32), 2)), Field("right", Ref("t.Point"))))),
        Field("node", Optional(Ref("t.Node"))),
        Field("grids", Array(Array(Array(Float(32), 2), 2))),
    ),
)
SCHEMA = Schema({"t.Point": POINT, "t.Node": NODE, "t.Fixed": FIXED})
POINT_ZERO = {"xy": [0.0, 0.0], "id": b"\0\0\0"}


@pytest.fixture
def fixed():
    return holder_class(Ref("t.Fixed"), SCHEMA)()


def struct(*fields):
    return holder_class(Struct("t.Own", fields), SCHEMA)


def test_born_with_their_elements(fixed):
    plain = fixed.to_dict()
    assert plain["cov"] == [0.0] * 9
    assert plain["matrix"] == [[0.0] * 4] * 3
    assert plain["cube"] == [[[0, 0]] * 3] * 2
    assert plain["points"] == [POINT_ZERO] * 2
    assert plain["names"] == ["", ""]
    assert plain["flags"] == [False, False]
    assert plain["point"] == POINT_ZERO
    assert plain["more"] == []
    assert "maybe" not in plain
    fixed.cov[3] = 2.0
    fixed.point.xy[1] = 3.0
    assert fixed.to_dict()["cov"] == [0, 0, 0, 2.0, 0, 0, 0, 0, 0]
    assert type(fixed)().cov.tolist() == [0.0] * 9


def test_born_when_they_come(fixed):
    fixed.more.append({"id": b"abc"})
    fixed.more.extend([{}] * 20)
    assert fixed.more[0].xy.tolist() == [0.0, 0.0]
    assert fixed.to_dict()["more"][1:] == [POINT_ZERO] * 20
    fixed.by_name["a"] = {}
    assert fixed.by_name["a"].id == b"\0\0\0"
    assert fixed.maybe.xy.tolist() == [0.0, 0.0]
    with pytest.raises(ValueError, match="read-only"):
        fixed.maybe.xy[0] = 1
    fixed.maybe.id = b"123"
    fixed.maybe.xy[0] = 1
    assert fixed.to_dict()["maybe"] == {"xy": [1.0, 0.0], "id": b"123"}
    fixed.right.id = b"abc"
    assert fixed.right.xy.tolist() == [0.0, 0.0]
    fixed.left = [1, 2]
    fixed.right = {}
    assert fixed.to_dict()["right"] == POINT_ZERO


def test_recursive_structs_are_born(fixed):
    assert fixed.node.next.next.at.tolist() == [0, 0]
    fixed.node.next.nodes.append({})
    fixed.node.next.nodes[0].at[1] = 7
    zero = {"at": [0, 0], "nodes": []}
    assert fixed.to_dict()["node"] == zero | {"next": zero | {"nodes": [zero | {"at": [0, 7]}]}}


def test_arrays_without_end_begin_empty():
    endless = Schema({"t.E": Struct("t.E", (Field("x", Int(8)), Field("both", Array(Ref("t.E"), 2))))})
    holder = holder_class(Ref("t.E"), endless)()
    assert holder.to_dict() == {"x": 0, "both": [{"x": 0, "both": []}] * 2}
    holder.both = [{"x": 1}, {"x": 2}]
    assert holder.both[1].x == 2


def test_arrays_that_are_too_large_begin_empty():
    big = Array(Array(Array(Float(64), 100_000), 100_000), 100_000)
    holder = struct(Field("numbers", Array(Float(64), 10**12)), Field("bytes", Bytes("", 10**12)), Field("big", big), Field("two", big))()
    assert sum(buffer.size for buffer in holder.lanes_.buffers) < 10_000
    assert holder.to_dict()["big"] == []
    assert holder.bytes == b""


def test_copies_and_clearing_keep_them(fixed):
    fixed.cov = range(9)
    fixed.points[1].xy = [5, 6]
    fixed.maybe = {}
    pickled = pickle.loads(pickle.dumps(fixed))  # noqa: S301  our own
    for copied in (copy.copy(fixed), pickled, type(fixed).from_dict(fixed.to_dict())):
        assert copied == fixed
        assert copied.to_dict() == fixed.to_dict()
        copied.clear("points")
        copied.clear("matrix")
        assert copied.to_dict()["points"] == [POINT_ZERO] * 2
        assert copied.matrix.shape == (3, 4)
        copied.clear()
        assert copied == type(fixed)()
        assert copied.matrix.tolist() == [[0.0] * 4] * 3
    assert type(fixed).from_dict({"cov": [], "matrix": [], "points": []}) == type(fixed)()


def test_settling_keeps_them(fixed):
    for count in range(3000):
        fixed.points[count % 2].id = bytes([count % 256] * 3)
        fixed.points = [{"xy": [count, 0]}, {}]
        fixed.left = [1, 2]
        fixed.right = {}
        if fixed.lanes_.words[VALID] == UNSETTLED:
            fixed.materialise()
    assert sum(buffer.size for buffer in fixed.lanes_.buffers) < 1 << 19
    assert fixed.points[0].xy.tolist() == [2999, 0]
    assert fixed.right.xy.size == 2


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("cov", [1.0]), ("cov", []), ("cov", np.zeros((3, 3))), ("matrix", np.zeros((4, 3))), ("matrix", [[1, 2, 3, 4]] * 2),
        ("matrix", [[1, 2, 3]] * 3), ("matrix", [1, 2, 3]), ("matrix", [[1, 2, 3, "a"]] * 3), ("points", [{}]), ("names", ["a"] * 3),
    ],
)  # fmt: skip
def test_other_lengths_are_refused(fixed, name, value):
    before = fixed.to_dict()[name]
    with pytest.raises((ValueError, TypeError)):
        setattr(fixed, name, value)
    if name in {"cov", "matrix"}:
        assert fixed.to_dict()[name] == before
    with pytest.raises((ValueError, TypeError)):
        fixed.points.append({})
    with pytest.raises(ValueError, match="2"):
        del fixed.points[0]
    assert len(fixed.points) == 2


def test_matrices_are_numpy(fixed):
    assert fixed.matrix.shape == (3, 4)
    assert fixed.cube.dtype == np.int8
    fixed.matrix[1, 2] = 7
    fixed.cube = np.arange(12, dtype=np.int8).reshape(2, 3, 2)
    assert fixed.to_dict()["matrix"][1] == [0, 0, 7, 0]
    assert fixed.cube[1, 2, 1] == 11
    fixed.matrix = [[1, 2, 3, 4], range(4), np.ones(4)]
    assert fixed.matrix.tolist() == [[1, 2, 3, 4], [0, 1, 2, 3], [1, 1, 1, 1]]
    assert np.shares_memory(fixed.matrix, fixed.view("matrix"))
    fixed.grids = np.arange(8, dtype=np.float32).reshape(2, 2, 2)
    assert fixed.grids[1].tolist() == [[4, 5], [6, 7]]
    assert copy.copy(fixed) == fixed


def test_rows_that_lie_apart_are_shown_as_a_copy(fixed):
    node = fixed.access_.record.entries["matrix"].node
    fixed.matrix = np.arange(12.0).reshape(3, 4)
    words = fixed.lanes_.row_words(node.lane, 0, 3)
    words[[0, 2]] = words[[2, 0]]
    assert fixed.matrix.tolist() == [[8, 9, 10, 11], [4, 5, 6, 7], [0, 1, 2, 3]]
    with pytest.raises(ValueError, match="read-only"):
        fixed.matrix[0, 0] = 1
    fixed.matrix = np.ones((3, 4))
    fixed.matrix[0, 0] = 5
    assert fixed.matrix.sum() == 16


def test_batches_are_born(fixed):
    batch = Batch.new(type(fixed), 3)
    batch[1].cov[2] = 4
    assert batch.column("cov").to_numpy().sum() == 4
    assert batch[2] == fixed
    batch.reset(2)
    assert batch[1] == fixed


def test_bounds():
    holder = struct(
        Field("text", String("utf-8", "", 3)), Field("wide", String("utf-16", "", 2)), Field("data", Bytes("", None, 2)),
        Field("numbers", Array(Int(8), None, 2)), Field("names", Array(String("utf-8", "", 1), None, 2)), Field("id", Bytes("", 2)),
    )()  # fmt: skip
    for name, value in [("text", "hé!"), ("wide", "abc"), ("data", b"abc"), ("numbers", [1, 2, 3]), ("names", ["a"] * 3), ("id", b"1")]:
        with pytest.raises(ValueError, match="where the type"):
            setattr(holder, name, value)
        with pytest.raises(ValuesError, match="where the type"):
            type(holder).from_dict({name: value})
    holder.text, holder.wide, holder.data, holder.numbers, holder.names, holder.id = "hé", "ab", b"ab", [1, 2], ["a", "b"], b"12"
    with pytest.raises(ValueError, match="3 elements where the type allows 2"):
        holder.names.append("c")
    with pytest.raises(ValueError, match="3 elements where the type allows 2"):
        holder.names.insert(0, "c")
    holder.names[0] = "z"
    with pytest.raises(ValueError, match="2 bytes where the type allows 1"):
        holder.names[0] = "zz"
    assert holder.names == ["z", "b"]


@pytest.mark.parametrize("text", ["", "abc", "hé", "日本", "😀!", "\ud800", "a\udc00\ud83d", "\0"])
def test_utf_16(text):
    holder = struct(Field("wide", String("utf-16")), Field("all", Array(String("utf-16"))), Field("by", Map(String("utf-16"), Int(8))))()
    holder.wide = text
    holder.all = [text, "x", text]
    holder.by[text] = 3
    assert (holder.wide, holder.all, dict(holder.by)) == (text, [text, "x", text], {text: 3})
    assert holder.view("wide").dtype == np.uint16
    assert holder.view("wide").tobytes() == text.encode("utf-16-le", "surrogatepass")
    assert copy.copy(holder) == holder
    with pytest.raises(TypeError):
        holder.wide = b"ab"
    batch = Batch.new(type(holder), 2)
    batch[1].wide = text
    assert batch.column("wide").to_list() == ["", text]


def test_lengths_that_fields_tell_are_variable():
    count = Path("wire", (Member("n"),))
    holder = struct(Field("n", Int(32)), Field("x", Array(Float(64), count)), Field("rows", Array(Array(Float(64), 2), count)))()
    assert holder.to_dict() == {"n": 0, "x": [], "rows": []}
    holder.x = [1, 2]
    holder.rows = np.ones((3, 2))
    assert [each.tolist() for each in holder.rows] == [[1, 1]] * 3


COLOR = Enum("t.Color", (("RED", 0), ("GREEN", 1), ("BLUE", 5)))


def union(discriminator, labels, default=None):
    cases = (Field("l", Int(32)), Field("d", Float(64)), Field("p", Ref("t.Point")), Field("s", String()))
    fields = (Field("_d", discriminator), Field("_u", Union("", cases[: len(labels)], None, "_d", labels, default)))
    schema = Schema({**SCHEMA.types, "t.Color": COLOR, "t.U": Struct("t.U", fields), "t.W": Struct("t.W", (Field("value", Ref("t.U")),))})
    return holder_class(Ref("t.U"), schema), holder_class(Ref("t.W"), schema)


def test_discriminators_follow_cases():
    value, whole = union(Int(32), ((1,), (2, 3), (4,), (7,)))
    holder = value()
    assert holder.to_dict() == {"_d": 0}
    holder.d = 1.5
    assert (holder._d, holder.which("_u"), holder.to_dict()) == (2, "d", {"_d": 2, "d": 1.5})
    holder._d = 3
    holder.d = 2.5
    assert holder.to_dict() == {"_d": 3, "d": 2.5}
    holder._d = 4
    assert holder.to_dict() == {"_d": 4, "p": POINT_ZERO}
    holder.p.xy[0] = 1
    holder._d = 99
    assert holder.to_dict() == {"_d": 99}
    holder.p.id = b"abc"
    assert holder.to_dict() == {"_d": 4, "p": {"xy": [0.0, 0.0], "id": b"abc"}}
    holder.clear("p")
    assert holder.to_dict() == {"_d": 4, "p": POINT_ZERO}
    holder.clear("_d")
    assert holder.to_dict() == {"_d": 0}
    outer = whole.from_dict({"value": {"_d": 3, "d": 1.0}})
    assert copy.copy(outer) == outer
    outer.value = {"s": "x"}
    assert outer.to_dict() == {"value": {"_d": 7, "s": "x"}}
    outer.value._d = 1
    assert outer.to_dict() == {"value": {"_d": 1, "l": 0}}
    outer.clear("value")
    assert outer.to_dict() == {"value": {"_d": 0}}


def test_the_case_of_zero_is_there_from_the_start():
    value, whole = union(Bool(), ((1,), (), (0,)))
    assert value().to_dict() == {"_d": False, "p": POINT_ZERO}
    assert whole().to_dict() == {"value": {"_d": False, "p": POINT_ZERO}}
    holder = value()
    holder.l = 3
    assert holder._d is True
    holder.clear()
    assert holder.to_dict() == {"_d": False, "p": POINT_ZERO}


@pytest.mark.parametrize(
    ("discriminator", "labels", "expected"),
    [
        (Int(32), ((0,), (), (1, 2)), 3), (Int(32), ((0,), (9,), (1, 2)), 9), (Ref("t.Color"), ((0, 1), (), ()), 5),
        (Bool(), ((0,), ()), 1),
        (Int(8), ((-1,), ()), 0), (Bool(), ((0, 1), ()), 0),
    ],
)  # fmt: skip
def test_defaults_take_a_free_value(discriminator, labels, expected):
    value, _ = union(discriminator, labels, default=1)
    holder = value()
    holder.d = 1.0
    assert int(holder._d) == expected
    assert holder.which("_u") == "d"


def test_any_other_value_selects_the_default():
    value, _ = union(Int(32), ((1,), ()), default=1)
    holder = value()
    assert holder.to_dict() == {"_d": 0, "d": 0.0}
    holder.d = 2.0
    holder._d = 77
    assert holder.to_dict() == {"_d": 77, "d": 2.0}
    holder._d = 1
    assert holder.to_dict() == {"_d": 1, "l": 0}
