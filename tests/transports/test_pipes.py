"""Pipes and files: what is sent arrives, a later reader is found, and a full pipe holds up nothing else."""

from __future__ import annotations

import contextlib
import os
import struct

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import TransportError
from tests.transports.free import free_port, until

MESSAGES = [b"", b"a", bytes(range(256)), b"x" * 300_000, b"end"]


def test_a_named_pipe_ends_with_its_writer(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with rj.subscribe(f"pipe:{tmp_path}/pipe") as source:
        with rj.publish(f"pipe:{tmp_path}/pipe") as sink:
            for each in MESSAGES:
                sink.send(each)
        assert [each.data for each in source] == MESSAGES


def test_a_named_pipe_without_a_reader_is_said_and_one_that_comes_back_is_found(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    place = f"pipe:{tmp_path}/pipe"
    with pytest.raises(TransportError, match="nobody reads the pipe"):
        rj.publish(place, timeout=0.05)
    first = rj.subscribe(place)
    with rj.publish(place) as sink:
        assert sink.send(b"1")
        assert first.take(5).data == b"1"
        first.close()
        assert not sink.send(b"2")
        assert (sink.connections, dict(sink.lost)) == (0, {"nobody reads the pipe": 1})
        with rj.subscribe(place) as second:
            assert sink.send(b"3")
            assert second.take(5).data == b"3"
        assert (sink.reconnects, sink.messages) == (1, 2)


def test_a_full_pipe_holds_up_no_sockets(tmp_path):
    """What comes by a socket is sent in the thread that serves all of them."""
    os.mkfifo(tmp_path / "pipe")
    source, other = f"tcp:{free_port()}", f"tcp:{free_port()}"
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    try:
        with (
            rj.publish(f"pipe:{tmp_path}/pipe?linger=0.05") as pipe,
            rj.subscribe(source, lambda message: pipe.send(message.data)) as arrived,
            rj.subscribe(other) as quick,
            rj.publish(source) as robot,
            rj.publish(other) as another,
        ):
            for size in (10, *[1 << 20] * 24, 10):
                robot.send(bytes(size))
            until(lambda: arrived.messages == 26)
            another.send(b"meanwhile")
            assert quick.take(5).data == b"meanwhile"
            read = b""
            while len(read) < 2 << 20:
                with contextlib.suppress(BlockingIOError):
                    read += os.read(reader, 1 << 20)
            assert read[:18] == b"\n\0\0\0" + bytes(10) + struct.pack("<I", 1 << 20)
            assert 5 < pipe.lost["the reader is too slow"] < 12
            too_slow = pipe.lost["the reader is too slow"]
            pipe.close()
            assert 12 <= pipe.lost["closed before it was sent"] <= 25 - too_slow
    finally:
        os.close(reader)


def test_a_file_that_is_cut_says_so(tmp_path):
    (tmp_path / "cut").write_bytes(b"\3\0\0\0abc\5\0\0\0ab")
    with rj.subscribe(f"pipe:{tmp_path}/cut") as source:
        assert [each.data for each in source] == [b"abc"]
        assert source.lost == {"the pipe ended in the middle of a message": 1}
