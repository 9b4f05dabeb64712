"""Batches as Arrow: exact types, the values of every message, memory of the table's own."""

from __future__ import annotations

import random
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rosetta_jit.errors import EncodeError, InvalidHolder
from rosetta_jit.kernel.state import VALID
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Ref, Schema, String, Struct, Union
from rosetta_jit.runtime.batches.batch import Batch
from rosetta_jit.runtime.holder import holder_class
from rosetta_jit.runtime.holder.record import Blob, Items, Numbers, Pairs, Record, Scalar, Text

sys.path.insert(0, str(Path(__file__).parent))
from schemas import flat, whole

pa = pytest.importorskip("pyarrow")

CLOSED = Enum("t.Closed", (("RED", 3), ("GREEN", 5), ("ROT", 3)))
OPEN = Enum("t.Open", (("ZERO", 0), ("ONE", 1)), closed=False)
POINT = Struct("t.Point", (Field("x", Float(64)), Field("y", Float(64)), Field("label", String())))
PART = Struct(
    "t.Part",
    (
        Field("x", Optional(Int(64))),
        Field("name", String("octets")),
        Field("values", Array(Float(64))),
        Field("at", Ref("t.Point")),
        Field("three", Optional(Array(Int(16), 3))),
    ),
)
ALL = Struct(
    "t.All",
    (
        Field("i8", Int(8)),
        Field("u64", Optional(Int(64, signed=False))),
        Field("f32", Float(32)),
        Field("flag", Optional(Bool())),
        Field("closed", Optional(Enum(CLOSED.name, CLOSED.values))),
        Field("open", OPEN),
        Field("opens", Array(OPEN)),
        Field("flags", Array(Bool())),
        Field("angles", Optional(Array(Float(32)))),
        Field("nine", Array(Float(64), 9)),
        Field("grid", Array(Array(Int(32), 2), 3)),
        Field("text", String()),
        Field("octets", Optional(String("octets"))),
        Field("wide", String("utf-16")),
        Field("data", Bytes()),
        Field("key", Bytes(length=4)),
        Field("part", Optional(Ref("t.Part"))),
        Field("parts", Array(Ref("t.Part"))),
        Field("pair", Array(Ref("t.Part"), 2)),
        Field("names", Array(String())),
        Field("rows", Array(Array(Int(16)))),
        Field("by_name", Map(String(), Ref("t.Point"))),
        Field("counts", Map(Int(32), Int(64))),
        Field("by_flag", Map(Bool(), String())),
        Field(
            "either",
            Union("t.All.either", (Field("left", Int(32)), Field("right", Ref("t.Part")), Field("word", String()), Field("up", Bytes()))),
        ),
    ),
)


def all_kinds():
    return holder_class(ALL, Schema({"t.Part": PART, "t.Point": POINT, "t.All": ALL}))


def written(node, rng):
    """A random plain value for a node."""
    match node:
        case Scalar(_, Enum(_, values, closed)):
            return rng.choice([number for _, number in values] + ([] if closed else [7, -3]))
        case Scalar(_, Bool()):
            return rng.random() < 0.5
        case Scalar(_, Float()):
            return rng.choice([0.5, -1.0, 3.25])
        case Scalar(_, Int(bits, signed)):
            return rng.randrange(-(2 ** (bits - 1)), 2 ** (bits - 1)) if signed else rng.randrange(2**bits)
        case Text():
            return "".join(rng.choice("aé😀z中") for _ in range(rng.randrange(5)))
        case Blob(_, _, length):
            return rng.randbytes(rng.randrange(5) if length is None else length)
        case Numbers(_, _, type_, length):
            return [written(Scalar(node.span, type_), rng) for _ in range(rng.randrange(4) if length is None else length)]
        case Items():
            return [written(node.element, rng) for _ in range(rng.randrange(4) if node.length is None else node.length)]
        case Pairs():
            return {written(node.key, rng): written(node.value.node, rng) for _ in range(rng.randrange(4))}
        case Record():
            chosen = [name for name in node.entries if rng.random() < 0.6]
            rng.shuffle(chosen)
            return {name: written(node.entries[name].node, rng) for name in chosen}


def expected(node, value):
    """A value of `to_dict` as `to_pylist` has it."""
    match node:
        case Scalar(_, Enum()):
            return str(value)
        case Numbers(_, _, Enum()):
            return [str(each) for each in value]
        case Items():
            return [expected(node.element, each) for each in value]
        case Pairs():
            return [(key, expected(node.value.node, each)) for key, each in value.items()]
        case Record():
            return {name: expected(entry.node, value[name]) if name in value else None for name, entry in node.entries.items()}
        case _:
            return value


def filled(count, seed):
    """Messages that were written to again and again, so that little of them lies where it first did."""
    rng, batch = random.Random(seed), Batch.new(all_kinds(), count)
    root = batch._family.tree.root
    for _ in range(3):
        for message in rng.sample(list(batch), count):
            for name, value in written(root, rng).items():
                setattr(message, name, value)
            if rng.random() < 0.3:
                message.clear(rng.choice(list(root.entries)))
    return batch


def as_lists(batch):
    return [expected(batch._family.tree.root, message.to_dict()) for message in batch]


@pytest.mark.parametrize("seed", range(30))
@pytest.mark.parametrize("copy", [True, False])
def test_every_value_is_that_of_its_message(seed, copy):
    batch = filled(seed, seed)
    table = batch.to_arrow(copy=copy)
    table.validate(full=True)
    assert table.to_pylist() == as_lists(batch)


def test_types():
    types = {
        field.name: str(field).removeprefix("pyarrow.Field<").removesuffix(">") for field in Batch.new(all_kinds(), 0).to_arrow().schema
    }
    point = "struct<x: double not null, y: double not null, label: large_string not null>"
    part = (
        f"struct<x: int64, name: large_string not null, values: large_list<item: double not null> not null, at: {point} not null, "
        "three: fixed_size_list<item: int16 not null>[3]>"
    )
    names = "dictionary<values=string, indices=int32, ordered=0>"
    assert {name: text.partition(": ")[2] for name, text in types.items()} == {
        "i8": "int8 not null",
        "u64": "uint64",
        "f32": "float not null",
        "flag": "bool",
        "closed": names,
        "open": f"{names} not null",
        "opens": f"large_list<item: {names} not null> not null",
        "flags": "large_list<item: bool not null> not null",
        "angles": "large_list<item: float not null>",
        "nine": "fixed_size_list<item: double not null>[9] not null",
        "grid": "fixed_size_list<item: fixed_size_list<item: int32 not null>[2] not null>[3] not null",
        "text": "large_string not null",
        "octets": "large_string",
        "wide": "large_string not null",
        "data": "large_binary not null",
        "key": "fixed_size_binary[4] not null",
        "part": part,
        "parts": f"large_list<item: {part} not null> not null",
        "pair": f"fixed_size_list<item: {part} not null>[2] not null",
        "names": "large_list<item: large_string not null> not null",
        "rows": "large_list<item: large_list<item: int16 not null> not null> not null",
        "by_name": f"map<large_string, {point}> not null",
        "counts": "map<int32, int64> not null",
        "by_flag": "map<bool, large_string> not null",
        "left": "int32",
        "right": part,
        "word": "large_string",
        "up": "large_binary",
    }


def test_names_of_numbers():
    batch = Batch.new(all_kinds(), 3)
    batch[0].open, batch[1].open = -100_000, 1
    batch[2].closed = 5
    table = batch.to_arrow()
    assert table["open"].to_pylist() == ["-100000", "ONE", "ZERO"]
    assert table["open"].chunk(0).dictionary.to_pylist() == ["ZERO", "ONE", "-100000"]
    assert table["closed"].chunk(0).dictionary.to_pylist() == ["RED", "GREEN"]


def test_columns_by_name():
    batch = filled(20, 1)
    table = batch.to_arrow(["part.at.x", "i8"])
    whole_table = batch.to_arrow()
    assert table.column_names == ["part.at.x", "i8"]
    assert table["i8"].equals(whole_table["i8"])
    assert table["part.at.x"].to_pylist() == [None if part is None else part["at"]["x"] for part in whole_table["part"].to_pylist()]
    for name in ("nothing", "parts.x", "part.nothing"):
        with pytest.raises(KeyError):
            batch.to_arrow([name])


def test_a_table_outlives_the_next_decode():
    batch = filled(10, 2)
    table, before = batch.to_arrow(), as_lists(batch)
    batch.reset(10)
    for message in batch:
        message.nine[:] = 7
        message.data = b"overwritten"
    assert table.to_pylist() == before


def test_without_copies_arrays_show_the_lanes():
    batch = Batch.new(flat(), 2)
    table = batch.to_arrow(["fixed"], copy=False)
    batch[1].fixed[2] = 9
    assert table["fixed"].to_pylist() == [[0, 0, 0], [0, 0, 9]]
    del batch
    assert table["fixed"].to_pylist() == [[0, 0, 0], [0, 0, 9]]


@pytest.mark.parametrize("copy", [True, False])
@pytest.mark.parametrize("all_of_them", [True, False])
def test_borrowed_bytes(copy, all_of_them):
    batch = Batch.new(all_kinds(), 3)
    for name in ("data", "octets"):
        node = batch._family.tree.root.entries[name].node
        for row, message in enumerate(batch):
            setattr(message, name, b"own")
            words = batch.lanes.cells[node.span.key]
            at = row * node.span.step + node.span.index
            if all_of_them or row != 1:
                words[at], words[at + 1] = 2 - row, ~(row + 1)
    batch.lanes.source[0] = bytearray(b"wxyz")
    table = batch.to_arrow(copy=copy)
    found = [b"y", b"xy" if all_of_them else b"own", b"wxy"]
    assert table["data"].to_pylist() == [message.data for message in batch] == found
    assert table["octets"].to_pylist() == [str(each, "utf-8") for each in found]


def test_long_arrays_that_lie_apart():
    batch = Batch.new(all_kinds(), 3)
    for row in (2, 0, 1):
        batch[row].data = bytes([row]) * 1000
    assert [set(each) for each in batch.to_arrow()["data"].to_pylist()] == [{0}, {1}, {2}]


def test_text_that_is_none():
    batch = Batch.new(all_kinds(), 3)
    batch[0].octets, batch[1].octets = b"a\xc3", b"\xa9b"  # together they would be one
    with pytest.raises(EncodeError, match="value 0 of the column") as caught:
        batch.to_arrow()
    assert caught.value.path == ".octets"
    assert batch.to_arrow(octets="binary")["octets"].to_pylist() == [b"a\xc3", b"\xa9b", None]
    batch[0].octets = batch[1].octets = "ä"
    batch[2].wide = "\ud800"
    with pytest.raises(EncodeError, match="value 2"):
        batch.to_arrow()
    batch[1].wide, batch[2].wide = "\ud83d", "\ude00"
    with pytest.raises(EncodeError, match="value 1"):
        batch.to_arrow()


def test_of_equal_keys_the_last_counts():
    batch = Batch.new(all_kinds(), 2)
    for message in batch:
        message.counts = {1: 10, 2: 20, 3: 30}
    node = batch._family.tree.root.entries["counts"].node
    keys = batch.lanes.cells[node.key.cell.key]
    for row in (0, 2):
        keys[row * node.key.cell.step + node.key.cell.index] = 2 + row // 2
    assert batch.to_arrow()["counts"].to_pylist() == [[(2, 20), (3, 30)], [(1, 10), (2, 20), (3, 30)]]


def test_messages_that_contain_each_other():
    batch = Batch.new(whole(), 3)
    with pytest.raises(TypeError, match=r"`child`: messages of t\.Whole contain each other.*to_arrow\(columns"):
        batch.to_arrow()
    with pytest.raises(TypeError, match=r"`children\[\]`"):
        batch.to_arrow(["children"])
    assert batch.to_arrow(["small", "part"]).num_rows == 3


def test_what_a_failed_decode_left_is_not_shown():
    batch = Batch.new(flat(), 2)
    batch.lanes.words[VALID] = 0
    with pytest.raises(InvalidHolder):
        batch.to_arrow()


def test_spans_that_leave_their_lane():
    batch = Batch.new(flat(), 2)
    batch[0].angles = [1, 2]
    node = batch._family.tree.root.entries["angles"].node
    words = batch.lanes.cells[node.span.key]
    for start, count in ((1 << 40, 1), (-5, 2), (0, 3), (0, -2)):
        words[node.span.index], words[node.span.index + 1] = start, count
        with pytest.raises(ValueError, match="leaves its lane"):
            batch.to_arrow()


def test_what_many_fills_is_not_gathered():
    """Arrays that lie together are shown where they are: the speed of the whole hangs on it."""
    batch = Batch.new(flat(), 100)
    shown = batch.to_arrow(["fixed"], copy=False)["fixed"].chunk(0).values
    assert shown.buffers()[1].address == batch.lanes.arrays[batch._family.tree.root.entries["fixed"].node.lane].ctypes.data
    assert np.array_equal(shown.to_numpy(), np.zeros(300))


def test_who_reads_arrow_reads_batches():
    batch = filled(20, 3)
    rows = as_lists(batch)
    assert pa.table(batch).equals(batch.to_arrow())
    assert pa.record_batch(batch).to_pylist() == rows
    assert pa.table(Batch.new(all_kinds(), 0)).num_rows == 0


def test_polars():
    polars = pytest.importorskip("polars")
    batch = filled(20, 3)
    frame = polars.DataFrame(batch)
    assert frame["parts"].to_list() == batch.to_arrow()["parts"].to_pylist()
    assert frame["closed"].to_list() == batch.to_arrow()["closed"].to_pylist()
    assert frame.schema["nine"] == polars.Array(polars.Float64, 9)


def test_duckdb():
    duckdb = pytest.importorskip("duckdb")
    batch = filled(20, 3)
    values = batch.to_arrow()["i8"].to_pylist()
    assert duckdb.sql("select sum(i8), count(part.at.x) from batch").fetchall() == [
        (sum(values), batch.to_arrow()["part"].drop_null().length())
    ]


def test_pandas():
    pandas = pytest.importorskip("pandas")
    batch = filled(20, 3)
    assert batch.to_pandas()["text"].tolist() == [message.text for message in batch]
    flat = batch.to_pandas(flatten=True)
    assert {"part.at.x", "part.at.label", "nine"} <= set(flat.columns)
    assert flat["part.at.label"].dropna().tolist() == [message.part.at.label for message in batch if message.has("part")]
    assert batch.to_pandas(["u64"], types_mapper=pandas.ArrowDtype)["u64"].dtype == "uint64[pyarrow]"


def test_pandas_constructor():
    pandas = pytest.importorskip("pandas")
    batch = filled(20, 3)
    frame, wanted = pandas.DataFrame(batch), batch.to_pandas(flatten=True)
    assert list(frame.columns) == list(wanted.columns)
    for name in wanted.columns:
        assert repr(frame[name].tolist()) == repr(wanted[name].tolist()), name
    assert len(pandas.DataFrame(Batch.new(all_kinds(), 0))) == 0
    with pytest.raises(TypeError, match="to_pandas"):
        np.asarray(batch, np.float64)


WITHOUT_PANDAS = r"""
import sys

import numpy as np

import rosetta_jit as rj
from rosetta_jit.runtime.arrow.stamps import with_times
from rosetta_jit.runtime.arrow.tables import taken

schema = 'syntax = "proto3"; message M { enum Colour { RED = 0; GREEN = 1; } Colour colour = 1; int64 time = 2; }'
messages = rj.Decoder.of("M", encoding="protobuf", schema=schema).many([b"\x08\x01\x10\x07", b"\x08\x05"])
table = with_times(messages.to_arrow(times=["time"]), {"log_time": np.array([1_700_000_000_000_000_005, 0])})
assert table["colour"].to_pylist() == ["GREEN", "5"]
assert [str(each) for each in table.schema.types[::2]] == ["timestamp[ns]", "timestamp[ns]"]
assert table["log_time"].cast("int64").to_pylist() == [1_700_000_000_000_000_005, 0]
assert taken(table, np.array([1]))["colour"].to_pylist() == ["5"]
print("pandas" in sys.modules)
"""


def test_pandas_is_not_imported_for_tables():
    """Where it is installed, `pa.array` imports it for whatever it is given: 40 MB, and longer than a small log takes."""
    pytest.importorskip("pandas")
    ran = subprocess.run([sys.executable, "-c", WITHOUT_PANDAS], capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stdout) == (0, "False\n"), ran.stderr
