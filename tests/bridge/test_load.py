"""What a running bridge carries, and what it adds: long runs. As root they go before other programs, and want no machine of their own."""

from __future__ import annotations

import json
import os

import pytest

from bench.bridge_load.endurance import soak
from bench.bridge_load.latency import latency
from bench.bridge_load.throughput import images, shared, topics

pytestmark = pytest.mark.campaign


def test_latency():
    """Over the same bytes from one socket to another in Python."""
    assert latency(9000)["added_p99_us"] <= 50


def test_a_hundred_topics_of_200_bytes_at_a_kilohertz_on_one_core():
    found = topics()
    assert found["bytes"] == 200
    assert (found["lost"], found["not_taken"]) == (0, 0)
    assert found["cpu_us_a_message"] <= 10


def test_images_at_a_gigabyte_a_second():
    """Of the bridge's processor time: who sends and who receives may share the machine with it."""
    found = images()
    assert found["lost"] == 0
    assert found["cpu_us_an_image"] <= 1000


def test_images_at_a_gigabyte_a_second_through_shared_memory():
    pytest.importorskip("iceoryx2")
    found = shared()
    assert found["lost"] == 0
    assert found["cpu_us_an_image"] <= 1000


def test_an_hour_without_growth():
    """`SOAK_SECONDS` makes it shorter; ten minutes are enough to say what an hour would bring."""
    seconds = float(os.environ.get("SOAK_SECONDS", "3600"))
    found = soak(seconds)
    print(json.dumps(found, indent=2))
    assert found["messages"] > 970 * seconds
    assert (found["lost"], found["not_taken"], found["not_arrived"]) == (0, 0, 0)
    assert found["grown_kb"] <= 1024
    assert (found["grown_files"], found["grown_threads"]) == (0, 0)
    assert seconds < 600 or found["growth_kb_an_hour"] <= 1024
