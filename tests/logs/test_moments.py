"""Moments as people write them, to the nanosecond."""

from __future__ import annotations

import random
from datetime import UTC, datetime

import numpy as np
import pandas as pd
import pytest

import rosetta_jit as rj
from rosetta_jit.cli import main
from rosetta_jit.logs.moments import moment_of, nanoseconds, shown

from .made import time_of, write_mcap

TEXTS = {
    "1700000000": 1_700_000_000 * 10**9,
    "1.000000001": 1_000_000_001,
    "-1": -(10**9),
    "-1.5": -1_500_000_000,
    "2023-11-14T22:13:20.123456789Z": 1_700_000_000_123_456_789,
    "2023-11-14T22:13:20.1234567+01:00": 1_699_996_400_123_456_700,
    "2023-11-14T22:13:20,000000096": 1_700_000_000_000_000_096,
    "1969-12-31T23:59:59.999999997Z": -3,
}


@pytest.mark.parametrize("text", TEXTS)
def test_texts(text):
    assert moment_of(text) == TEXTS[text]


def test_what_is_shown_is_read():
    dice = random.Random(1)
    for number in (dice.randrange(-(2**61), 2**61) for _ in range(500)):
        assert moment_of(shown(number)) == number
        assert {nanoseconds(pd.Timestamp(number, tz=zone)) for zone in (None, "UTC", "Asia/Tokyo")} == {number}
        assert nanoseconds(np.datetime64(number, "ns")) == number
    assert nanoseconds(datetime(2023, 11, 14, 22, 13, 20, 5, UTC)) == 1_700_000_000_000_005_000


@pytest.mark.parametrize("value", [pd.NaT, np.datetime64("NaT")])
def test_no_time_is_no_moment(value):
    with pytest.raises(ValueError, match="NaT is no moment"):
        nanoseconds(value)


def test_a_time_of_a_table_begins_a_reading(tmp_path):
    """Arrow gives times as those of pandas, which have nanoseconds."""
    channel = rj.open(write_mcap(tmp_path / "a.mcap", 9))["/a"]
    stamp = channel.to_arrow()["publish_time"][4].as_py()
    assert nanoseconds(stamp) == time_of(4) - 7
    assert channel.to_arrow(start=channel.to_arrow()["log_time"][4].as_py()).num_rows == 5


def test_a_command_begins_before_1970(tmp_path, capsys):
    path = str(write_mcap(tmp_path / "a.mcap", 3))
    assert main(["cat", path, "--start=-1", "--topic", "/a"]) == 0
    assert capsys.readouterr().out.count("/a") == 3
    assert main(["cat", path, "--end=-1"]) == 0
    assert not capsys.readouterr().out
