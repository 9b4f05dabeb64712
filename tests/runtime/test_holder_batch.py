"""Batches: columns without copies, rows as views."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from rosetta_jit.errors import InvalidHolder
from rosetta_jit.kernel.state import VALID
from rosetta_jit.runtime.batches.batch import Batch

sys.path.insert(0, str(Path(__file__).parent))
from schemas import flat, whole


@pytest.fixture
def batch():
    batch = Batch.new(flat(), 4)
    for index, message in enumerate(batch):
        message.small = index
        message.angles = [index + 0.5] * index
        message.text = "s" * index
        message.data = bytes([index])
        message.part.x = index
        message.parts = [{"x": index, "values": [index]}] * index
        message.fixed = [index, 0, 1]
        message.counts[index] = 1
        if index % 2:
            message.maybe = index
            message.left = index
    return batch


def test_columns(batch):
    assert len(batch) == 4
    assert batch.small.tolist() == [0, 1, 2, 3]
    assert batch.column("part.x").tolist() == [0, 1, 2, 3]
    assert batch.mask("maybe").tolist() == [False, True, False, True]
    assert batch.mask("left").tolist() == [False, True, False, True]
    assert batch.mask("small").all()
    assert batch.mask("part.x").all()
    assert batch.text.to_list() == ["", "s", "ss", "sss"]
    assert batch.data.to_list() == [b"\0", b"\1", b"\2", b"\3"]
    assert batch.column("parts.x").to_list() == [[], [1], [2, 2], [3, 3, 3]]
    assert batch.column("parts.values")[2].to_list() == [[2.0], [2.0]]
    assert batch.counts[3]["key"].tolist() == [3]
    assert set(batch.part) == {"x", "name", "values"}
    batch.small[2] = 9
    assert batch[2].small == 9


def test_ragged_arrays(batch):
    angles = batch.angles
    assert (len(angles), angles.offsets.tolist(), angles.counts.tolist()) == (4, [0, 0, 1, 3, 6], [0, 1, 2, 3])
    assert angles.flat().tolist() == [1.5, 2.5, 2.5, 3.5, 3.5, 3.5]
    assert angles[3].tolist() == [3.5, 3.5, 3.5]
    with pytest.raises(ValueError, match="lengths"):
        angles.to_numpy()
    assert np.shares_memory(batch.fixed.to_numpy(), batch.fixed.values)
    assert batch.fixed.to_numpy().tolist() == [[0, 0, 1], [1, 0, 1], [2, 0, 1], [3, 0, 1]]
    batch[1].angles = [1, 2, 3]
    assert batch.angles.flat().tolist() == [1, 2, 3, 2.5, 2.5, 3.5, 3.5, 3.5]
    assert Batch.new(flat(), 0).angles.to_numpy().shape == (0, 0)


def test_borrowed_columns(batch):
    span = flat()().access_.record.entries["data"].node.span
    words = batch.lanes.cells[span.key]
    words[span.step + span.index], words[span.step + span.index + 1] = 1, ~2
    batch.lanes.source[0] = b"xyz"
    assert batch.data.to_list() == [b"\0", b"yz", b"\2", b"\3"]
    assert bytes(batch.data.flat()) == b"\0yz\2\3"
    assert batch[1].data == b"yz"


def test_rows(batch):
    assert batch[-1] == batch[3]
    assert batch[1].to_dict()["left"] == 1
    assert batch[2].new().small == 0
    with pytest.raises(IndexError):
        _ = batch[4]
    with pytest.raises(AttributeError):
        _ = batch.nothing
    with pytest.raises(KeyError):
        batch.column("nothing")
    batch.reset(2)
    assert len(batch) == 2
    assert batch[1] == flat()()
    batch.lanes.words[VALID] = 0
    with pytest.raises(InvalidHolder):
        batch.column("small")
    with pytest.raises(InvalidHolder):
        _ = batch[0].small


def test_recursive_messages_have_rows_but_no_columns():
    batch = Batch.new(whole(), 3)
    batch[1].children.append({"small": 4})
    batch[2].child.small = 5
    assert (batch[1].children[0].small, batch[2].child.small) == (4, 5)
    assert batch.small.tolist() == [0, 0, 0]
    with pytest.raises(TypeError):
        batch.column("children.small")
    batch.lanes.unsettle()
