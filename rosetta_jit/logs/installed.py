"""The formats of logs: those that come with rosetta_jit, and those of installed packages."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from rosetta_jit.logs.base import Format
from rosetta_jit.startup.entry_points import loaded

GROUP = "rosetta_jit.logs"
"""The group of entry points by which packages offer formats."""

_HERE = "rosetta_jit.logs"

ROSBAG2_FILES = "*_0.db3", "*_0.mcap", "*_0.db3.zstd", "*_0.mcap.zstd"
"""The first file of a folder: there is no `metadata.yaml` where the recorder was killed."""

FORMATS = (
    Format("mcap", (".mcap",), f"{_HERE}.mcap.reader:McapReader", b"\x89MCAP0\r\n"),
    Format("bag", (".bag", ".bag.active"), f"{_HERE}.bag.reader:open_bag", b"#ROSBAG V"),
    Format("rosbag2", (), f"{_HERE}.rosbag2.reader:Rosbag2Reader", folder=("metadata.yaml", *ROSBAG2_FILES)),
    Format("rosbag2-sqlite", (".db3",), f"{_HERE}.rosbag2.sqlite:SqliteReader", b"SQLite format 3\0"),
    Format("yarpdatadumper", (), f"{_HERE}.yarp.reader:DumperReader", folder="data.log"),
    Format("yarpdatadumper-ports", (), f"{_HERE}.yarp.reader:DumperReader", folder="*/data.log"),
    Format("recording", (".rec", ".rec.xz"), f"{_HERE}.recordings.reader:RecordingReader"),
    Format("tide", (".tide",), f"{_HERE}.tide.reader:TideReader", b"TIDE"),
    Format("delimited", (".delimited", ".pbd", ".binpb.delimited"), f"{_HERE}.delimited.reader:DelimitedReader"),
    Format("lcm", (".lcmlog",), f"{_HERE}.lcm.reader:LcmReader", bytes.fromhex("eda1da01")),
)


@cache
def formats() -> Mapping[str, Format]:
    """Every format by name."""
    return {each.name: each for each in (*FORMATS, *loaded(GROUP))}
