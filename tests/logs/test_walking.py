"""Rows of messages: those of some channels, however many channels are named."""

from __future__ import annotations

import numpy as np
import pytest

from rosetta_jit.logs.reading.walking import FEW, Rows, walk


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


def test_rows_in_memory_that_is_given():
    """A walk writes its rows there, as it does otherwise; they are of no other walk."""
    record = b"\x05" + (25).to_bytes(8, "little") + bytes(range(25))
    data, given = np.frombuffer(bytearray(record * 700), np.uint8), np.full(5 * 800, -1)
    found, stop = walk("mcap", data, 0, memory=lambda size: given[:size])
    own, same = walk("mcap", data, 0)
    assert stop == same
    assert len(found) == 700
    for name in ("channels", "log_ns", "publish_ns", "begins", "ends"):
        assert getattr(found, name).tolist() == getattr(own, name).tolist()
        assert np.shares_memory(getattr(found, name), given)
        assert not np.shares_memory(getattr(own, name), given)
