"""Batches from whatever has Arrow's interface: frames, columns named with dots, and the many forms that arrays have."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from rosetta_jit.errors import EncodeError, ValuesError
from rosetta_jit.model.types import Array, Bool, Enum, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct
from rosetta_jit.runtime.batches.batch import Batch
from rosetta_jit.runtime.holder import holder_class

sys.path.insert(0, str(Path(__file__).parent))
from test_arrow import all_kinds, filled

pa = pytest.importorskip("pyarrow")

POINT = Struct("t.Point", (Field("x", Float(64)), Field("label", Optional(String())), Field("tags", Array(String()))))
MANY = Struct(
    "t.Many",
    (
        Field("number", Int(32)),
        Field("maybe", Optional(Int(64))),
        Field("real", Float(64)),
        Field("single", Float(32)),
        Field("reals", Array(Float(64))),
        Field("text", String()),
        Field("word", Optional(String())),
        Field("words", Array(String())),
        Field("flag", Bool()),
        Field("colour", Enum("t.Colour", (("RED", 0), ("BLUE", 5)))),
        Field("point", Ref("t.Point")),
        Field("place", Optional(Ref("t.Point"))),
        Field("points", Array(Ref("t.Point"))),
        Field("ages", Map(String(), String())),
        Field("places", Map(Int(64), Ref("t.Point"))),
        Field("stamp", Ref("t.Time")),
        Field("key", Array(Int(8), 2)),
    ),
)
TIME = Struct("t.Time", (Field("sec", Int(64)), Field("nanosec", Int(32, signed=False))))


def many():
    return holder_class(MANY, Schema({"t.Point": POINT, "t.Time": TIME, "t.Many": MANY}))


def values(source, *names):
    """What messages made of a source have, name by name."""
    rows = [message.to_dict() for message in Batch.from_arrow(many(), source)]
    return [row.get(names[0]) for row in rows] if len(names) == 1 else [tuple(row.get(name) for name in names) for row in rows]


def view():
    return pa.string_view()


def dictionary(texts, type_):
    encoded = pa.array(texts).dictionary_encode()
    return pa.DictionaryArray.from_arrays(encoded.indices, encoded.dictionary.cast(type_))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("form", ["pandas of Arrow", "polars"])
def test_frames_come_back(form, seed):
    batch = filled(12, seed)
    if form == "polars":
        frame = pytest.importorskip("polars").DataFrame(batch)
    else:
        frame = batch.to_pandas(types_mapper=pytest.importorskip("pandas").ArrowDtype)
    assert Batch.from_arrow(all_kinds(), frame).to_arrow().equals(batch.to_arrow())


POINTS = {"x": 1.5, "label": "\u00e9", "tags": ["", "a"]}, {"x": -0.5, "tags": []}
ROWS = (
    {
        "number": 7,
        "maybe": 1,
        "real": 0.1,
        "reals": [0.5, 1],
        "word": "",
        "words": ["a"],
        "flag": True,
        "colour": "BLUE",
        "point": POINTS[0],
    },
    {
        "place": POINTS[1],
        "points": [*POINTS],
        "ages": {"a": "b"},
        "places": {7: POINTS[0]},
        "stamp": {"sec": -1, "nanosec": 5},
        "key": [1, 2],
    },
    {"maybe": -5, "text": "\0", "point": POINTS[0], "places": {-1: POINTS[1], 2: POINTS[0]}, "stamp": {"sec": -1, "nanosec": 5}},
)


@pytest.mark.parametrize("flatten", [False, True])
@pytest.mark.parametrize("rows", [3, 1, 0])
def test_frames_of_plain_pandas_come_back(rows, flatten):
    """Whose integers with gaps are floats, and whose structs are dicts."""
    pytest.importorskip("pandas")
    batch = Batch.new(many(), rows)
    for message, row in zip(batch, ROWS, strict=False):
        for name, value in row.items():
            setattr(message, name, value)
    assert Batch.from_arrow(many(), batch.to_pandas(flatten=flatten)).to_arrow().equals(batch.to_arrow())


def test_columns_named_with_dots():
    batch = filled(12, 7)
    assert Batch.from_arrow(all_kinds(), batch.to_arrow(flatten=True)).to_arrow().equals(batch.to_arrow())
    chosen = ["part.at.x", "part.name", "part.values", "i8"]
    again = Batch.from_arrow(all_kinds(), batch.to_arrow(chosen))
    assert again.column("part.at.x").tolist() == [message.part.at.x if message.has("part") else 0 for message in batch]
    assert again.mask("part").tolist() == batch.mask("part").tolist()


def test_names_with_dots_that_say_too_little_or_too_much():
    assert values(pa.table({"place.x": [1.0, None], "place.label": [None, None]}), "place") == [{"x": 1.0, "tags": []}, None]
    for table, path in (
        ({"point.x": [1.0], "point": [{"x": 1.0}]}, ".point"),
        ({"point.x.y": [1.0]}, ".point.x.y"),
        ({"point.nothing": [1.0]}, ".point.nothing"),
        ({"nothing.x": [1.0]}, ".nothing.x"),
        ({"point.x": [None]}, ".point.x"),
        ({"place.x": [None], "place.label": ["a"]}, ".place.x"),
    ):
        with pytest.raises(ValuesError) as caught:
            values(pa.table(table), "point")
        assert caught.value.path == path


FORMS = {
    "nulls without a type": lambda: ({"maybe": [None, None], "word": ["a", None]}, [(None, "a"), (None, None)]),
    "lists without elements": lambda: ({"reals": [[], []], "points": [[], []]}, [([], []), ([], [])]),
    "maps without entries": lambda: ({"ages": [[], []], "words": [[], []]}, [({}, []), ({}, [])]),
    "numbers by their place": lambda: ({"number": pa.array([3, 4, 3]).dictionary_encode()[1:]}, [4, 3]),
    "floats by their place": lambda: ({"real": pa.array([3.5, 1.0]).dictionary_encode()}, [3.5, 1.0]),
    "texts by their place": lambda: ({"text": dictionary(["a", "é", "a"], view())[1:]}, ["é", "a"]),
    "absent texts by their place": lambda: ({"word": dictionary(["a", None, "b"], pa.large_string())[1:]}, [None, "b"]),
    "names of an enum as views": lambda: ({"colour": dictionary(["BLUE", "RED"], view())}, ["BLUE", "RED"]),
    "runs": lambda: ({"number": pa.RunEndEncodedArray.from_arrays([2, 3], [7, 8])[1:]}, [7, 8]),
    "views of texts": lambda: ({"word": pa.array(["a", None, "a text of more bytes"], view())[1:]}, [None, "a text of more bytes"]),
    "lists of views": lambda: ({"words": pa.array([["x"], ["é", ""], []], pa.list_(view()))[1:]}, [["é", ""], []]),
    "lists as views": lambda: ({"reals": pa.ListViewArray.from_arrays([2, 0], [1, 2], pa.array([1.0, 2.0, 3.0]))}, [[3.0], [1.0, 2.0]]),
    "structs of views": lambda: (
        {"place": pa.array([{"label": "a"}, None, {"label": None}], pa.struct([("label", view())]))[1:]},
        [None, {"x": 0.0, "tags": []}],
    ),
    "structs of lists of views": lambda: (
        {"points": pa.array([[], [{"x": 1.0, "tags": ["a"]}]], pa.list_(pa.struct([("x", pa.float64()), ("tags", pa.list_view(view()))])))},
        [[], [{"x": 1.0, "tags": ["a"]}]],
    ),
    "maps of views": lambda: ({"ages": pa.array([[("a", "b")], [], [("c", "")]], pa.map_(view(), view()))[1:]}, [{}, {"c": ""}]),
    "fixed lists by their place": lambda: (
        {"key": pa.FixedSizeListArray.from_arrays(pa.array([1, 2, 1, 1, 5, 6]).dictionary_encode(), 2)[1:]},
        [[1, 1], [5, 6]],
    ),
    "texts of JSON": lambda: ({"text": pa.array(["{}"], pa.json_())}, ["{}"]),
    "tensors": lambda: ({"reals": pa.FixedShapeTensorArray.from_numpy_ndarray(np.ones((2, 3)))[1:]}, [[1.0] * 3]),
    "chunks": lambda: (
        {"text": pa.chunked_array([pa.array([], pa.string()), ["a"], ["b"]]), "maybe": pa.chunked_array([[1, None], []])},
        [("a", 1), ("b", None)],
    ),
}


@pytest.mark.parametrize("form", FORMS)
def test_forms_of_arrays(form):
    columns, wanted = FORMS[form]()
    assert values(pa.table(columns), *columns) == wanted


def test_times_of_every_unit():
    """Also those that nanoseconds of 64 bits do not reach."""
    for unit, ticks in (("s", 1), ("ms", 1_000), ("us", 1_000_000), ("ns", 1_000_000_000)):
        stamps = pa.array([-ticks // 2 if unit != "s" else -1, 9_000_000_000 * ticks], pa.timestamp(unit, "UTC"))
        early = {"sec": -1, "nanosec": 500_000_000 if unit != "s" else 0}
        assert values(pa.table({"stamp": stamps}), "stamp") == [early, {"sec": 9_000_000_000, "nanosec": 0}]


def test_nan_in_frames_of_pandas():
    """What is missing there, and what is no number, is the same: the field tells which it is."""
    pandas = pytest.importorskip("pandas")
    nan = float("nan")
    frame = pandas.DataFrame({"real": [1.0, nan], "single": np.float32([nan, 2]), "maybe": [1.0, nan], "number": [1.0, 2.0]})
    frame["reals"] = [np.array([nan, 1.0]), []]
    batch = Batch.from_arrow(many(), frame)
    np.testing.assert_array_equal(batch.column("real"), [1.0, nan])
    np.testing.assert_array_equal(batch.column("single"), [nan, 2.0])
    np.testing.assert_array_equal(batch.column("reals")[0], [nan, 1.0])
    assert batch.column("number").tolist() == [1, 2]
    assert [message.to_dict().get("maybe") for message in batch] == [1, None]
    polars = pytest.importorskip("polars")
    assert np.isnan(Batch.from_arrow(many(), polars.DataFrame({"real": [nan]})).column("real")).all()
    for table, path in ((pandas.DataFrame({"number": [1.5]}), ".number"), (pandas.DataFrame({"number": [1.0, nan]}), ".number")):
        with pytest.raises(ValuesError) as caught:
            values(table, "number")
        assert caught.value.path == path
    with pytest.raises(ValuesError, match="value 0 is null"):
        values(pa.table({"real": [None, 1.0]}), "real")


def test_maps_and_objects_in_frames_of_pandas():
    pandas = pytest.importorskip("pandas")
    ages, places = [[("a", "b")], []], [[(7, {"x": 1.0, "label": None, "tags": ["q"]})], []]
    frame = pandas.DataFrame({"ages": ages, "places": places, "text": pandas.Categorical(["a", "b"])}, index=[5, 6])
    assert values(frame, "ages", "places", "text") == [({"a": "b"}, {7: {"x": 1.0, "tags": ["q"]}}, "a"), ({}, {}, "b")]
    assert values(frame.set_index("text"), "text") == ["a", "b"]
    for column, path in (({"text": ["a", 1]}, ".text"), ({"ages": [[("a", 1)], [3]]}, ".ages"), ({"nothing": [1, "a"]}, ".nothing")):
        with pytest.raises(ValuesError) as caught:
            values(pandas.DataFrame(column), "text")
        assert caught.value.path == path
    twice = pandas.DataFrame([["a", "b"]], columns=["text", "text"])
    with pytest.raises(ValuesError, match="same name"):
        values(twice, "text")


def test_types_that_pyarrow_does_not_know():
    polars = pytest.importorskip("polars")
    with pytest.raises(ValuesError, match="a type that pyarrow does not know"):
        values(polars.DataFrame({"number": polars.Series([1], dtype=polars.Int128)}), "number")


def test_times_in_the_unit_that_is_wanted():
    """Which reaches further than nanoseconds, where no part of a time is lost."""
    batch = Batch.new(many(), 2)
    batch[0].stamp.sec, batch[0].stamp.nanosec = -1, 250_000_000
    batch[1].stamp.sec = 9_300_000_000
    for unit, ticks in (("ms", 1_000), ("us", 1_000_000)):
        table = batch.to_arrow(["stamp"], times={"stamp": unit})
        assert table["stamp"].cast(pa.int64()).to_pylist() == [-3 * ticks // 4, 9_300_000_000 * ticks]
        assert table.schema.field("stamp").type == pa.timestamp(unit)
        assert values(table, "stamp") == [message.stamp.to_dict() for message in batch]
    with pytest.raises(EncodeError, match="time 0 is between two timestamps in s: take a finer unit"):
        batch.to_arrow(["stamp"], times={"stamp": "s"})
    with pytest.raises(EncodeError, match="further from 1970"):
        batch.to_arrow(["stamp"], times=["stamp"])


def test_options_that_are_none():
    batch = Batch.new(many(), 1)
    for error, words, options in (
        (TypeError, r"columns is a list of names: columns=\['text'\]", {"columns": "text"}),
        (TypeError, r"times=\['stamp'\]", {"times": "stamp"}),
        (ValueError, 'is "s", "ms", "us" or "ns", not \'minutes\'', {"times": {"stamp": "minutes"}}),
        (ValueError, 'octets is "string" or "binary", not \'bytes\'', {"octets": "bytes"}),
        (ValueError, "errors='text' is the name of a column", {"errors": "text"}),
        (KeyError, "`points` of `points.x` is an array or a map", {"columns": ["points.x"]}),
        (KeyError, "t.Point has no field `lable`; did you mean `label`?", {"columns": ["point.lable"]}),
    ):
        with pytest.raises(error, match=words.replace("?", r"\?")):
            batch.to_arrow(**options)


OFFSETS = {
    "beyond the values": [0, 2, 1 << 40],
    "falling": [0, 3, 2],
    "falling within": [0, 1 << 20, 3],
    "negative": [-8, 0, 3],
    "negative at the end": [0, 2, -(1 << 62)],
}


def array_of(type_, ends, *children):
    """An array with these offsets, to be changed when Arrow has looked at the first and the last of them."""
    buffers = [None, pa.py_buffer(ends), *([] if children else [pa.py_buffer(b"abc")])]
    return pa.Array.from_buffers(type_, len(ends) - 1, buffers, children=list(children) or None)


def of_kind(kind, ends):
    """A source in which these are the offsets of a column, and its name."""
    numbers, points = pa.array([1.0, 2.0, 3.0]), pa.large_list(pa.struct({"x": pa.float64()}))
    texts = array_of(pa.large_string(), ends)
    match kind:
        case "text":
            return {"text": texts}
        case "words":
            return {"words": array_of(pa.large_list(pa.large_string()), np.array([0, 1, 2]), texts)}
        case "reals":
            return {"reals": array_of(pa.large_list(pa.float64()), ends, numbers)}
        case "points":
            return {"points": array_of(points, ends, pa.StructArray.from_arrays([numbers], ["x"]))}
        case "place":
            return {"place": pa.StructArray.from_arrays([texts], ["label"])}
        case _:
            return {"text": pa.chunked_array([array_of(pa.large_string(), np.array([0, 1, 3])), texts])}


@pytest.mark.parametrize("wrong", OFFSETS)
@pytest.mark.parametrize("kind", ["text", "words", "reals", "points", "place", "chunks", "pandas"])
def test_columns_whose_offsets_leave_their_values(kind, wrong):
    ends = np.array([0, 1, 3])
    if kind == "pandas":
        pandas = pytest.importorskip("pandas")
        name, source = "text", pandas.DataFrame({"text": pandas.arrays.ArrowExtensionArray(of_kind("text", ends)["text"])})
    else:
        columns = of_kind(kind, ends)
        (name,), source = columns, pa.table(columns)
    ends[:] = OFFSETS[wrong]
    with pytest.raises(ValuesError, match="the column is damaged") as caught:
        Batch.from_arrow(many(), source)
    assert caught.value.path == f".{name}"


def test_texts_that_are_none_are_no_column():
    with pytest.raises(ValuesError, match=r"(?i)utf-?8"):
        Batch.from_arrow(many(), pa.table({"text": pa.Array.from_buffers(pa.string(), 1, pa.array([b"\xff"]).buffers())}))
