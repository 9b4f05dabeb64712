"""Tables as batches: what `to_arrow` makes comes back, and what a field cannot hold exactly is refused with its path."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.errors import ValuesError
from rosetta_jit.model.types import Array, Bytes, Field, Float, Int, Optional, Ref, Schema, String, Struct, Union
from rosetta_jit.runtime.batches.batch import Batch
from rosetta_jit.runtime.holder import holder_class

sys.path.insert(0, str(Path(__file__).parent))
from schemas import flat, whole
from test_arrow import all_kinds, filled

pa = pytest.importorskip("pyarrow")


def plain(batch):
    return [message.to_dict() for message in batch]


@pytest.mark.parametrize("seed", range(20))
def test_tables_come_back(seed):
    batch = filled(seed, seed)
    again = Batch.from_arrow(all_kinds(), batch.to_arrow())
    assert plain(again) == plain(batch)
    assert again.to_arrow().equals(batch.to_arrow())


def test_slices_and_chunks_come_back():
    batch = filled(20, 5)
    table = batch.to_arrow()
    assert plain(Batch.from_arrow(all_kinds(), table[7:15])) == plain(batch[7:15])
    chunks = pa.concat_tables([table[3:4], table[:0], batch[10:].to_arrow(), table[5:]])
    assert plain(Batch.from_arrow(all_kinds(), chunks)) == plain(batch[3:4]) + plain(batch[10:]) + plain(batch[5:])
    assert len(Batch.from_arrow(all_kinds(), table[:0])) == 0
    assert plain(Batch.from_arrow(all_kinds(), pa.record_batch(batch[:3]))) == plain(batch[:3])


def test_columns_may_be_missing():
    batch = Batch.from_arrow(all_kinds(), pa.table({"i8": [1, 2], "text": ["a", "b"]}))
    new = all_kinds()().to_dict()
    assert plain(batch) == [{**new, "i8": 1, "text": "a"}, {**new, "i8": 2, "text": "b"}]
    assert batch.column("grid")[1].to_list() == [[0, 0]] * 3
    batch[1].nine[3] = 5
    assert batch[0].nine[3] == 0


@pytest.mark.parametrize("library", ["polars", "pandas", "duckdb"])
def test_frames(library):
    module = pytest.importorskip(library)
    names = ["i8", "text", "angles", "data", "names", "parts", "nine", "closed"]
    batch = filled(15, 4)
    table = batch.to_arrow(names)
    match library:
        case "polars":
            frame = module.DataFrame(table)
        case "duckdb":
            frame = module.sql("select i8, text, angles, data, names, parts, nine, closed from batch")
        case _:
            frame = table.to_pandas(types_mapper=module.ArrowDtype)
            frame.index = range(100, 115)
    again = Batch.from_arrow(all_kinds(), frame)
    assert [[row.get(name) for name in names] for row in plain(again)] == [[row.get(name) for name in names] for row in plain(batch)]


def test_plain_pandas():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"i8": np.int64([1, 2]), "nine": [np.arange(9.0)] * 2, "text": ["a", "b"]}, index=[7, 3])
    batch = Batch.from_arrow(all_kinds(), frame)
    assert batch.i8.tolist() == [1, 2]
    assert batch.nine.to_numpy()[1].tolist() == list(range(9))


PART = {"x": 1, "name": "n", "values": [1.0], "at": {"x": 1.0, "y": 2.0, "label": ""}, "three": [1, 2, 3]}


@pytest.mark.parametrize(
    ("name", "values", "path", "detail"),
    [
        ("nothing", [1], ".nothing", "no such field"),
        ("i8", [1, 128], ".i8", "out of range.*128"),
        ("i8", [1.0], ".i8", "expected integers, found a column of double"),
        ("i8", ["1"], ".i8", "expected integers"),
        ("i8", [1, None], ".i8", "value 1 is null, and the field cannot be absent"),
        ("u64", [-1], ".u64", "out of range"),
        ("f32", [0.5, 0.1], ".f32", "value 1, 0.1, is none of float32; cast the column"),
        ("f32", [2**24 + 1], ".f32", "is none of float32"),
        ("f32", [True], ".f32", "expected numbers"),
        ("flag", [1], ".flag", "expected booleans"),
        ("closed", [4], ".closed", "invalid enumerator 4"),
        ("closed", ["RED", "BLUE"], ".closed", 'unknown enum label "BLUE"'),
        ("closed", ["3"], ".closed", "unknown enum label"),
        ("opens", [["ONE", None]], ".opens[]", "value 1 is null"),
        ("open", [1 << 31], ".open", "out of range"),
        ("nine", [[1.0] * 9, [1.0] * 8], ".nine", "value 1 has 8 elements where the type has 9"),
        ("nine", [1.0], ".nine", "expected lists"),
        ("grid", [[[1, 2]] * 2], ".grid", "value 0 has 2 elements where the type has 3"),
        ("grid", [[[1, 2], [1], [1, 2]]], ".grid[]", "value 1 has 1 elements"),
        ("text", [b"x"], ".text", "expected texts"),
        ("data", ["x"], ".data", "expected bytes"),
        ("key", [b"12345"], ".key", "value 0 has 5 elements where the type has 4"),
        ("part", [3], ".part", "expected a struct"),
        ("part", [{**PART, "name": None}], ".part.name", "value 0 is null"),
        ("parts", [[PART, {**PART, "more": 1}]], ".parts[].more", "no such field"),
        ("parts", [[PART, None]], ".parts[]", "value 1 is null"),
        ("parts", [[PART], [{**PART, "three": [1]}]], ".parts[].three", "value 1 has 1 elements"),
        ("names", [["a", None]], ".names[]", "value 1 is null"),
        ("by_name", [[{"key": "a", "value": None}]], ".by_name[].value", "value 0 is null"),
    ],
)
def test_what_a_field_cannot_hold(name, values, path, detail):
    with pytest.raises(ValuesError, match=detail) as caught:
        Batch.from_arrow(all_kinds(), pa.table({name: values}))
    assert caught.value.path == path


def test_what_it_holds_exactly():
    table = pa.table(
        {
            "i8": pa.array([1, 2], pa.uint64()),
            "f32": pa.array([1, -7], pa.int16()),
            "u64": pa.array([None, 2**64 - 1], pa.uint64()),
            "closed": pa.array([None, 5], pa.int64()),
            "open": ["-12", "ONE"],
            "octets": [b"\xff", None],
            "angles": pa.array([[float("nan")], [float("inf")]], pa.list_(pa.float64())),
            "wide": ["aé😀", "中"],
            "by_name": pa.array([[], [{"key": "k", "value": PART["at"]}]]),
        }
    )
    first, second = plain(Batch.from_arrow(all_kinds(), table))
    assert (first["i8"], first["f32"], first["open"], first["octets"], first["wide"]) == (1, 1.0, -12, "\udcff", "aé😀")
    assert np.isnan(first["angles"]).all()
    assert (second["u64"], second["closed"], second["open"], second["angles"]) == (2**64 - 1, "GREEN", "ONE", [float("inf")])
    assert second["by_name"] == {"k": PART["at"]}
    assert "closed" not in first


def test_text_that_is_none_is_refused():
    broken = pa.Array.from_buffers(pa.string(), 1, [None, pa.py_buffer(np.int32([0, 1])), pa.py_buffer(b"\xff")])
    with pytest.raises(ValuesError, match="UTF8"):
        Batch.from_arrow(all_kinds(), pa.table({"text": broken}))


def test_a_union_has_one_case():
    table = pa.table({"left": [None, 1, None, 2], "word": ["a", None, None, "b"]})
    with pytest.raises(ValuesError, match="value 3 is a second case of one union") as caught:
        Batch.from_arrow(all_kinds(), table)
    assert caught.value.path == ".word"
    batch = Batch.from_arrow(all_kinds(), table[:3])
    assert [message.which("either") for message in batch] == ["word", "left", None]


def test_a_discriminator_and_its_case_agree():
    cases = (Field("number", Int(32)), Field("three", Array(Float(64), 3)))
    union = Union("t.U", cases, discriminator="tag", labels=((0, 4), (7,)))
    cls = holder_class(Struct("t.S", (Field("tag", Int(32)), Field("u", union))), Schema({}))
    read = Batch.from_arrow(cls, pa.table({"number": [5, None, None], "three": [None, [1.0, 2.0, 3.0], None]}))
    assert plain(read) == [{"tag": 0, "number": 5}, {"tag": 7, "three": [1, 2, 3]}, {"tag": 0, "number": 0}]
    again = Batch.from_arrow(cls, pa.table({"tag": [4, 7, 9], "number": [5, None, None], "three": [None, [1.0, 2.0, 3.0], None]}))
    assert plain(again) == [{"tag": 4, "number": 5}, {"tag": 7, "three": [1, 2, 3]}, {"tag": 9}]
    assert plain(Batch.from_arrow(cls, again.to_arrow())) == plain(again)
    with pytest.raises(ValuesError, match="of value 1 the discriminator"):
        Batch.from_arrow(cls, pa.table({"tag": [0, 7], "number": [1, 1]}))


def test_bounds():
    fields = (
        Field("s", String(maximum=3)),
        Field("a", Array(Int(8), maximum=2)),
        Field("b", Bytes(maximum=1)),
    )
    cls = holder_class(Struct("t.B", fields), Schema({}))
    for name, values in (("s", ["abc", "éé"]), ("a", [[1, 2], [1, 2, 3]]), ("b", [b"", b"12"])):
        with pytest.raises(ValuesError, match="elements where the type allows"):
            Batch.from_arrow(cls, pa.table({name: values}))


def test_what_is_no_table():
    with pytest.raises(TypeError, match="not list"):
        Batch.from_arrow(flat(), [1])
    with pytest.raises(ValuesError, match="same name"):
        Batch.from_arrow(flat(), pa.Table.from_arrays([pa.array([1])] * 2, ["small", "small"]))
    with pytest.raises(TypeError, match=r"`child`: messages of t\.Whole contain each other"):
        Batch.from_arrow(whole(), pa.table({"child": [{"small": 1}]}))


def test_encoders_take_tables():
    encode, decode = (program.of("sensor_msgs/Imu", encoding="ros1") for program in (rj.Encoder, rj.Decoder))
    holder = decode.new()
    holder.header.frame_id, holder.orientation_covariance[4] = "base", 0.5
    message = encode(holder)
    batch = decode.many([message] * 5)
    for source in (batch.to_arrow(), batch.to_pandas()):
        written, offsets = encode.many(source)
        assert bytes(written) == message * 5
        assert offsets.tolist() == [len(message) * number for number in range(6)]
    with pytest.raises(TypeError, match="a batch, a list of messages, or a table or frame"):
        encode.many(message)


TIME = Struct("t.Time", (Field("sec", Int(32)), Field("nanosec", Int(32, signed=False))))
MICROS = Struct("t.Micros", (Field("seconds", Int(64)), Field("usec", Int(32))))
STAMPED = Struct(
    "t.Stamped",
    (
        Field("stamp", Optional(Ref("t.Time"))),
        Field("micros", Ref("t.Micros")),
        Field("utime", Int(64, signed=False)),
        Field("stamps", Array(Ref("t.Time"))),
        Field("seconds", Float(64)),
    ),
)


def stamped():
    return holder_class(STAMPED, Schema({"t.Time": TIME, "t.Micros": MICROS, "t.Stamped": STAMPED}))


def test_times():
    batch = Batch.new(stamped(), 2)
    batch[0].stamp.sec, batch[0].stamp.nanosec, batch[0].micros.usec, batch[0].utime = -1, 5, 7, 3_000_001
    batch[1].stamps = [{"sec": 1}, {"nanosec": 2}]
    table = batch.to_arrow(times={"stamp": "ns", "micros": "ns", "utime": "us", "stamps": "ns"})
    assert [str(table[name].type) for name in ("stamp", "micros", "utime", "stamps")] == [
        "timestamp[ns]",
        "timestamp[ns]",
        "timestamp[us]",
        "large_list<item: timestamp[ns] not null>",
    ]
    assert table["stamp"].cast(pa.int64()).to_pylist() == [-999_999_995, None]
    assert table["micros"].cast(pa.int64()).to_pylist() == [7000, 0]
    assert table["utime"].cast(pa.int64()).to_pylist() == [3_000_001, 0]
    assert table["stamps"].chunk(0).flatten().cast(pa.int64()).to_pylist() == [1_000_000_000, 2]
    assert batch.to_arrow(["utime"], times=["utime"])["utime"].type == pa.timestamp("ns")
    assert plain(Batch.from_arrow(stamped(), table.drop_columns(["utime"]))) == [{**row, "utime": 0} for row in plain(batch)]


def test_what_is_no_time():
    batch = Batch.new(stamped(), 1)
    with pytest.raises(TypeError, match="`seconds` is no time"):
        batch.to_arrow(times=["seconds"])
    for name in ("nothing", "stamp.nothing", "utime.sec"):
        with pytest.raises(KeyError):
            batch.to_arrow(times=[name])
    batch[0].micros.seconds = 1 << 40
    batch[0].utime = (1 << 64) - 1
    for name in ("micros", "utime"):
        with pytest.raises(rj.EncodeError, match="further from 1970"):
            batch.to_arrow(times=[name])
    late = pa.table({"stamp": pa.array([1 << 40], pa.timestamp("s"))})
    for table, path in ((late, ".stamp.sec"), (pa.table({"micros": pa.array([1], pa.timestamp("ns"))}), ".micros")):
        with pytest.raises(ValuesError) as caught:
            Batch.from_arrow(stamped(), table)
        assert caught.value.path == path
    early = pa.table({"stamp": pa.array([-(1 << 32)], pa.timestamp("s"))})
    with pytest.raises(ValuesError, match="out of range"):
        Batch.from_arrow(stamped(), early)
