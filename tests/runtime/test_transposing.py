"""Rows of words as columns: the same as numpy makes of them, and tables that keep no more memory than they show."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
import pytest

import rosetta_jit as rj
from rosetta_jit.runtime import transposing
from rosetta_jit.runtime.rows import numpys
from rosetta_jit.runtime.transposing import LEAST, transposed

SCHEMA = "string name\nfloat64 x\nint32 small\nfloat64[3] fixed\nint64 number\nbool flag"


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
    monkeypatch.setattr(transposing, "_transpose", lambda: None)
    assert found.equals(table(count, first))
    assert found.column("x").to_pylist() == [number / 7 for number in range(first, count)]


def test_a_table_keeps_what_it_shows():
    """Places of texts and arrays are not kept, and a column that goes takes its memory with it."""
    before, found = pa.total_allocated_bytes(), table(LEAST)
    kept = pa.total_allocated_bytes() - before
    assert kept < 1.1 * found.nbytes
    found = found.select(["x"])
    assert pa.total_allocated_bytes() - before <= 8 * LEAST + 128
