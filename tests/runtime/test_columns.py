"""Columns of one message, and columns for whoever reads DLPack."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from rosetta_jit.runtime.batch import Batch

sys.path.insert(0, str(Path(__file__).parent))
from schemas import flat, whole
from test_arrow import all_kinds


def test_arrays_of_structs_of_one_message():
    holder = flat()()
    holder.parts = [{"x": index, "name": "n" * index, "values": [index] * index} for index in range(4)]
    columns = holder.column("parts")
    assert columns["x"].tolist() == [0, 1, 2, 3]
    assert columns["name"].to_list() == ["", "n", "nn", "nnn"]
    assert holder.column("parts.values").to_list() == [[], [1], [2, 2], [3, 3, 3]]
    holder.column("parts.x")[1:3] = 7
    assert [part.x for part in holder.parts] == [0, 7, 7, 3]
    assert holder.column("small") == 0
    assert holder.column("part")["values"].tolist() == []
    with pytest.raises(KeyError):
        holder.column("parts.nothing")


def test_columns_of_views():
    """A row of a batch, a struct in a list, and a struct that is not there."""
    batch = Batch.new(flat(), 3)
    batch[2].parts = [{"x": 5}]
    assert batch[2].column("parts.x").tolist() == [5]
    assert batch[1].column("parts.x").tolist() == []
    assert batch[2].parts[0].column("x") == 5
    holder = whole()()
    assert holder.child.column("parts.x").tolist() == []
    with pytest.raises(TypeError, match="contain each other"):
        holder.column("children")


def test_arrays_in_arrays_are_one_array():
    batch = Batch.new(all_kinds(), 3)
    batch[1].grid[:] = [[1, 2], [3, 4], [5, 6]]
    grids = batch.grid.to_numpy()
    assert grids.shape == (3, 3, 2)
    assert grids[1].tolist() == [[1, 2], [3, 4], [5, 6]]
    assert np.shares_memory(grids, batch.lanes.buffers[batch.family_.tree.root.entries["grid"].node.element.lane])
    batch[0].rows = [[1, 2], [3, 4]]
    with pytest.raises(ValueError, match="lengths"):
        batch.rows.to_numpy()


def test_dlpack():
    batch = Batch.new(flat(), 3)
    batch[1].fixed = [4, 5, 6]
    for column in (batch.small, batch.fixed):
        shown = np.from_dlpack(column)
        assert np.shares_memory(shown, column if isinstance(column, np.ndarray) else column.values)
    assert np.from_dlpack(batch.fixed).tolist() == [[0, 0, 0], [4, 5, 6], [0, 0, 0]]
    assert batch.fixed.__dlpack_device__() == (1, 0)
