"""What is proposed for a name that there is not."""

from __future__ import annotations

import pytest

from rosetta_jit.catalogue.suggestions import closest


@pytest.mark.parametrize(
    ("written", "known", "meant"),
    [
        ("nsecs", ["sec", "nanosec"], "nanosec"),  # the wrong one would be taken for right, and hold other values
        ("secs", ["sec", "nanosec"], "sec"),
        ("pitsch", ["yaw", "pitch"], "pitch"),
        ("eader", ["header", "stamp"], "header"),
        ("IMU", ["Imu", "Image"], "Imu"),
        ("velocity", ["effort", "name"], None),
    ],
)
def test_the_closest_name(written, known, meant):
    assert closest(written, known) == meant
