"""The words of all that can be wrong with a log, in one golden file: who changes one sees it beside the others."""

from __future__ import annotations

import inspect

import rosetta_jit.catalogue.logs as words  # the module itself, not what loads it when a word is needed
from rosetta_jit.diagnostics import render
from tests.golden import GOLDEN, check_golden

EXAMPLES = {
    "name": "drive.mcap",
    "topic": "/imu",
    "type_": "sensor_msgs/msg/Imu",
    "types": ["a/A", "b/B"],
    "table": "topics",
    "tables": [".parquet", ".csv"],
    "topics": ["/imu", "/tf"],
    "known": ["/imu", "/tf"],
    "suffixes": [".mcap", ".bag"],
    "encoding": "cdr",
    "encodings": ["cdr", "json"],
    "details": " (fingerprint 0x0123)",
    "carried": "messages of ROS 1 alone",
    "why": "it is cut short",
    "what": "schema 3",
    "file": "part_2.db3",
    "field": "angular_velocity.q",
    "folder": "drive",
    "path": "drive/_conversion.json",
    "package": "zstandard",
    "extra": "logs",
    "version": "#ROSBAG V1.2",
    "at": 4096,
    "size": 17,
    "index": 3,
    "count": 2,
    "channel": 5,
    "schema": 9,
    "promised": 20,
    "found": 18,
    "time_ns": -1,
    "wire": "pose",
    "can_be_drafted": True,
}


def test_all_words():
    functions = [each for _, each in inspect.getmembers(words, inspect.isfunction) if each.__module__ == words.__name__]
    texts = [render(each(**{name: EXAMPLES[name] for name in inspect.signature(each).parameters})) for each in functions]
    check_golden(GOLDEN / "logs.err", "\n\n".join(texts) + "\n")
