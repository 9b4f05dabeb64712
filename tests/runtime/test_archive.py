"""numpy's archives of tables that come one after another."""

from __future__ import annotations

import weakref
from itertools import pairwise

import numpy as np
import pyarrow as pa
import pytest

from rosetta_jit.runtime.arrow.files import write_tables

ROWS = [
    {"x": 1.5, "n": 7, "name": "a", "xs": [1.0, 2.0], "at": {"s": 1}, "pair": [1, 2], "names": ["p"], "data": b"\1"},
    {"x": -2.0, "n": 8, "name": "longer", "xs": [], "at": {"s": 2}, "pair": [3, 4], "names": [], "data": b""},
    {"x": 0.25, "n": 9, "name": "", "xs": [3.0], "at": {"s": 3}, "pair": [5, 6], "names": ["q", "r"], "data": b"\2\3"},
]
SCHEMA = pa.schema(
    {
        "x": pa.float64(),
        "n": pa.int32(),
        "name": pa.large_string(),
        "xs": pa.large_list(pa.float64()),
        "at": pa.struct({"s": pa.int64()}),
        "pair": pa.list_(pa.uint8(), 2),
        "names": pa.large_list(pa.large_string()),
        "data": pa.large_binary(),
    }
)


def table(rows):
    return pa.Table.from_pylist(rows, schema=SCHEMA)


@pytest.mark.parametrize("parts", [[3], [1, 2], [1, 1, 1], [0, 3], [2, 0, 1]], ids=str)
def test_an_archive_is_the_same_whatever_the_tables(parts, tmp_path):
    ends = np.cumsum([0, *parts])
    write_tables([table(ROWS[begin:end]) for begin, end in pairwise(ends)], tmp_path / "a.npz", ".npz")
    with np.load(tmp_path / "a.npz", allow_pickle=False) as found:
        assert {name: found[name].tolist() for name in found.files} == {
            "x": [1.5, -2.0, 0.25],
            "n": [7, 8, 9],
            "name": ["a", "longer", ""],
            "xs": [1.0, 2.0, 3.0],
            "xs.offsets": [0, 2, 2, 3],
            "at.s": [1, 2, 3],
            "pair": [[1, 2], [3, 4], [5, 6]],
            "names": ["p", "q", "r"],
            "names.offsets": [0, 1, 1, 3],
            "data": ["01", "", "0203"],
        }
        assert (found["n"].dtype, found["pair"].dtype, found["name"].dtype) == (np.int32, np.uint8, np.dtype("<U6"))


def test_an_archive_without_rows(tmp_path):
    write_tables([table([])], tmp_path / "a.npz", ".npz")
    with np.load(tmp_path / "a.npz", allow_pickle=False) as found:
        assert {name: found[name].shape for name in found.files} == {
            name: (1,) if name.endswith("offsets") else (0, 2) if name == "pair" else (0,) for name in found.files
        }
        assert len(found.files) == 10


def test_no_table_is_kept(tmp_path):
    """However many there are: an archive of a long log takes no more memory than one of a short one."""
    given = list[weakref.ref[pa.Table]]()

    def tables():
        for _ in range(5):
            new = table(ROWS)
            given.append(weakref.ref(new))
            yield new
            del new
            assert not [each for each in given[:-1] if each() is not None]

    write_tables(tables(), tmp_path / "a.npz", ".npz")
    assert len(given) == 5
