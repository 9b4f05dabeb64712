"""What the summary of an MCAP file may leave out: topics, types and messages are the same without it."""

from __future__ import annotations

import struct

import pytest
from mcap.writer import IndexType, Writer

import rosetta_jit as rj

COUNT = 100


def write(path, **options):
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=300, **options)
        writer.start()
        schema = writer.register_schema("t/msg/X", "ros2msg", b"float64 x")
        channels = [writer.register_channel(topic, "cdr", schema) for topic in ("/a", "/b")]
        for number in range(COUNT):
            writer.add_message(channels[number % 2], number, b"\0\1\0\0" + struct.pack("<d", number), number)
        writer.finish()
    return path


@pytest.mark.parametrize("is_chunked", [True, False])
@pytest.mark.parametrize("index", [IndexType.ALL, IndexType.NONE, IndexType.CHUNK, IndexType.MESSAGE])
@pytest.mark.parametrize("has_statistics", [True, False])
@pytest.mark.parametrize("repeated", [(True, True), (True, False), (False, True), (False, False)])
def test_what_is_not_repeated_is_found(tmp_path, repeated, has_statistics, index, is_chunked):
    options = dict(zip(("repeat_channels", "repeat_schemas"), repeated, strict=True))
    path = write(tmp_path / "a.mcap", use_chunking=is_chunked, index_types=index, use_statistics=has_statistics, **options)
    told = list[str]()
    log = rj.open(path, on_problem=lambda problem: told.append(problem.message))
    assert log.topics == ("/a", "/b")
    assert [each.type for each in log.channels] == ["t/msg/X"] * 2
    assert log["/b"].to_arrow()["x"].to_pylist() == list(range(1, COUNT, 2))
    assert [message.x for _, _, message in log.messages()] == list(range(COUNT))
    assert log["/a"].count in (COUNT // 2, None)
    assert not told
