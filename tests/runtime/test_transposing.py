"""Rows of words as columns: the same as numpy makes of them, and tables that keep no more memory than they show."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from mcap.writer import Writer

import rosetta_jit as rj
from rosetta_jit.runtime.batches import transposing
from rosetta_jit.runtime.batches.transposing import LEAST, WORTH_COMPILING, Steady, prepare, transposed
from rosetta_jit.runtime.rows import numpys

sys.path.insert(0, str(Path(__file__).parent))
from test_arrow import filled

SCHEMA = "string name\nfloat64 x\nint32 small\nfloat64[3] fixed\nint64 number\nbool flag"


@pytest.fixture(autouse=True)
def _compiled():
    prepare(WORTH_COMPILING)


@pytest.mark.parametrize("count", [LEAST + rest for rest in range(9)])
@pytest.mark.parametrize(("first", "words"), [(0, 1), (2, 5), (0, 19)])
def test_columns_are_those_of_numpy(count, first, words):
    rows = np.random.default_rng(count).integers(-(2**62), 2**62, (count, 19))[:, first : first + words]
    columns = transposed(rows, numpys)
    assert columns is not None
    assert [each.tolist() for each in columns] == rows.T.tolist()
    assert len({each.ctypes.data for each in columns}) == words


@pytest.mark.parametrize("rows", [np.zeros((LEAST - 1, 3), np.int64), np.broadcast_to(np.int64(1), (LEAST, 3))])
def test_numpy_makes_the_others(rows):
    assert transposed(rows, numpys) is None


def table(count, first=0):
    decoder = rj.Decoder.of("t/msg/X", encoding="cdr", schema=SCHEMA)
    encoder = rj.Encoder.of("t/msg/X", encoding="cdr", schema=SCHEMA)
    holder = decoder.new()
    messages = []
    for number in range(count):
        holder.name, holder.x, holder.small, holder.number, holder.flag = f"n{number}", number / 7, -number, number << 40, number % 3 == 0
        holder.fixed = [number, 2 * number, 3 * number]
        messages.append(encoder(holder))
    return decoder.many(messages)[first:].to_arrow()


@pytest.mark.parametrize("first", [0, 5])
def test_tables_are_the_same_without_the_code(monkeypatch, first):
    count = LEAST + 8
    found = table(count, first)
    found.validate(full=True)
    assert found.num_rows == count - first
    monkeypatch.setattr(transposing, "_is_there", lambda: False)
    assert found.equals(table(count, first))
    assert found.column("x").to_pylist() == [number / 7 for number in range(first, count)]


def test_a_table_keeps_what_it_shows():
    """Places of texts and arrays are not kept, and a column that goes takes its memory with it."""
    before, found = pa.total_allocated_bytes(), table(LEAST)
    kept = pa.total_allocated_bytes() - before
    assert kept < 1.1 * found.nbytes
    found = found.select(["x"])
    assert pa.total_allocated_bytes() - before <= 8 * LEAST + 128


def test_few_messages_compile_nothing(monkeypatch, tmp_path):
    """In a process that is the first one of a machine, numpy is done sooner."""
    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path))
    transposing._library.cache_clear()
    transposing._transpose.cache_clear()
    rows = np.arange(3 * LEAST).reshape(LEAST, 3)
    assert transposed(rows, numpys) is None
    assert not list(tmp_path.glob("*.kernel"))
    prepare(WORTH_COMPILING)
    assert len(list(tmp_path.glob("*.kernel"))) == 1
    assert transposed(rows, numpys) is not None


def test_a_long_log_compiles_it(monkeypatch, tmp_path):
    prepared = []
    monkeypatch.setattr("rosetta_jit.logs.channel.prepare", prepared.append)
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        topic = writer.register_channel("/x", "cdr", writer.register_schema("t/msg/X", "ros2msg", b"uint8 x"))
        for number in range(7):
            writer.add_message(topic, log_time=number, publish_time=number, data=b"\0\1\0\0" + bytes([number]))
        writer.finish()
    assert rj.open(path)["/x"].to_arrow()["x"].to_pylist() == list(range(7))
    assert prepared == [7]


@pytest.mark.parametrize("options", [{}, {"flatten": True}, {"octets": "binary"}, {"columns": "every second"}])
def test_all_kinds_of_fields_are_the_same_without_the_code(monkeypatch, options):
    """Unions, absent fields, enums, maps and arrays of structs, in rows that lie anywhere."""
    monkeypatch.setattr(transposing, "LEAST", 64)
    batch = filled(101, 3)
    options = {name: list(batch._family.tree.root.entries)[::2] if name == "columns" else value for name, value in options.items()}
    found = batch.to_arrow(**options)
    found.validate(full=True)
    monkeypatch.setattr(transposing, "_is_there", lambda: False)
    assert found.equals(batch.to_arrow(**options))


def test_nothing_is_written_for_words_that_grow_steadily():
    rows = np.random.default_rng(0).integers(-(2**62), 2**62, (LEAST + 5, 4))
    rows[:, 1], rows[:, 3] = 7 + 9 * np.arange(LEAST + 5), 9
    first, places, third, counts = transposed(rows, numpys, [(1, 9), (3, 0)])
    assert (places, counts) == (Steady(7, 9, LEAST + 5), Steady(9, 0, LEAST + 5))
    assert places.values().tolist() == rows[:, 1].tolist()
    assert [first.tolist(), third.tolist()] == rows[:, [0, 2]].T.tolist()


@pytest.mark.parametrize("row", [1, 7, 8, LEAST - 1, LEAST, LEAST + 4])
@pytest.mark.parametrize("bit", [0, 63])
def test_words_that_do_not_grow_as_was_likely_are_written(row, bit):
    """In whole blocks of rows and behind the last, by the lowest bit and by the highest."""
    rows = np.stack([9 * np.arange(LEAST + 5), np.arange(LEAST + 5), 3 * np.arange(LEAST + 5)], axis=1)
    rows[row, 0] ^= np.int64(np.uint64(1 << bit).view(np.int64))
    wrong, plain, steady = transposed(rows, numpys, [(0, 9), (2, 3)])
    assert wrong.tolist() == rows[:, 0].tolist()
    assert plain.tolist() == rows[:, 1].tolist()
    assert steady == Steady(0, 3, LEAST + 5)


def test_arrays_of_fixed_length_anywhere_are_the_same_without_the_code(monkeypatch):
    """Of messages that could not be decoded there are none; those that were written to lie elsewhere."""
    decoder, encoder = (kind.of("t/msg/X", encoding="cdr", schema=SCHEMA) for kind in (rj.Decoder, rj.Encoder))
    holder = decoder.new()
    messages = []
    for number in range(LEAST + 20):
        holder.fixed = [number, 2 * number, 3 * number]
        messages.append(encoder(holder))
    messages[11] = messages[LEAST + 13] = b"\0\1\0\0\0"
    masked = decoder.many(messages, on_error="mask")
    found = masked.to_arrow()
    assert found["fixed"].to_pylist()[10:13] == [[10, 20, 30], [0, 0, 0], [12, 24, 36]]
    kept = np.delete(np.arange(LEAST + 20), [11, LEAST + 13])
    skipped = decoder.many(messages, on_error="skip").to_arrow()
    assert skipped.equals(found.take(kept))
    monkeypatch.setattr(transposing, "_is_there", lambda: False)
    assert found.equals(masked.to_arrow())
    assert skipped.equals(decoder.many(messages, on_error="skip").to_arrow())


def test_an_array_outside_of_its_lane_is_refused():
    batch = rj.Decoder.of("t/msg/X", encoding="cdr", schema="float64[3] fixed").many([b"\0\1\0\0" + bytes(24)] * LEAST)
    batch.to_arrow()
    words = batch.lanes.row_words(0, 0, LEAST)
    words[:, 0] += 1
    with pytest.raises(ValueError, match="an array leaves its lane"):
        batch.to_arrow()
