"""Rows of messages: those of some channels, however many channels are named."""

from __future__ import annotations

import numpy as np
import pytest

from rosetta_jit.logs.reading.walking import FEW, Rows


@pytest.mark.parametrize("count", [0, 1, FEW, FEW + 1, 9])
def test_rows_of_channels(count):
    rows = Rows.of(np.random.default_rng(count).integers(0, 10, (5, 300)))
    numbers = frozenset(range(count))
    there = [each in numbers for each in rows.channels.tolist()]
    assert rows.are_of(numbers).tolist() == there
    assert rows.of_channels(numbers).ends.tolist() == [end for end, is_there in zip(rows.ends.tolist(), there, strict=True) if is_there]


def test_rows_of_which_all_are_wanted_are_not_copied():
    rows = Rows.of(np.zeros((5, 3), np.int64))
    assert rows.of_channels(frozenset({0, 7})) is rows
    nothing = rows.only(slice(0, 0))
    assert len(nothing.of_channels(frozenset({1}))) == 0
