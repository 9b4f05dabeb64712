"""What protocols ask for is given to them whole, wherever a read ends."""

from __future__ import annotations

import struct
import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rosetta_jit.transports.feeding import SOME, Between, Feed, Frames, ProtocolError, Until


def fed(asked, pieces):
    """What a generator gets that asks for these things, again and again."""
    got = []

    def machine():
        while True:
            for each in asked:
                got.append(bytes((yield each)))  # noqa: PERF401 - no comprehension yields

    feed = Feed(machine())
    for piece in pieces:
        feed.feed(piece)
    return got, feed


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(st.binary(max_size=150), st.lists(st.integers(1, 50), min_size=1, max_size=4), st.lists(st.integers(1, 40), min_size=1, max_size=5))
def test_lengths(data, sizes, reads):
    pieces, rest = [], data
    while rest:
        size = reads[len(pieces) % len(reads)]
        pieces.append(rest[:size])
        rest = rest[size:]
    got, _ = fed(sizes, pieces)
    at = 0
    for number, each in enumerate(got):
        assert each == data[at : at + sizes[number % len(sizes)]]
        at += len(each)
    assert len(data) - at < sizes[len(got) % len(sizes)]


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.binary(max_size=60).map(lambda line: line.replace(b"\r\n", b"")), max_size=8), st.integers(1, 50))
def test_delimiters_of_two_bytes(lines, size):
    data = b"".join(each + b"\r\n" for each in lines)
    got, _ = fed([Until(b"\r\n", 100)], [data[at : at + size] for at in range(0, len(data), size)])
    assert b"".join(got) == data
    assert all(each.endswith(b"\r\n") for each in got)


def test_large_messages_grow_the_buffer_as_they_come():
    got, feed = fed([1 << 22], [])
    feed.feed(b"x" * 1000)
    assert feed.size == 1 << 16
    feed.feed(b"x" * ((1 << 22) - 1000))
    assert len(got[0]) == 1 << 22
    feed.feed(b"y" * (1 << 22))
    assert got[1] == b"y" * (1 << 22)
    assert feed.size <= 1 << 23


def test_a_line_without_end_is_refused():
    with pytest.raises(ProtocolError, match="within 100 bytes"):
        fed([Until(b"\n", 100)], [b"x" * 50, b"x" * 51])


def test_many_short_lines_at_once_are_quick():
    _, feed = fed([1 << 22, *[Until(b"\n", 100)] * 100_000], [])
    began = time.perf_counter()
    feed.feed(b"x" * (1 << 22) + b"\n" * 100_000)
    assert time.perf_counter() - began < 3


def test_some_is_all_that_is_there():
    got, _ = fed([SOME], [b"abc", b"d"])
    assert got == [b"abc", b"d"]


def test_where_a_stream_may_end():
    for asked, pieces, may in (
        ([Between(4), 2], [], True),
        ([Between(4), 2], [b"a"], False),
        ([Between(4), 2], [b"abcd"], False),
        ([4], [], False),
    ):
        assert fed(asked, pieces)[1].is_between == may


LENGTH = struct.Struct("<H")


def framed(*messages):
    return b"".join(LENGTH.pack(len(each)) + each for each in messages)


def reader(got, most=1000):
    """What reads a greeting of two bytes, and frames behind it."""

    def machine():
        got.append(bytes((yield 2)))
        yield Frames(LENGTH, lambda data: got.append(bytes(data)), most)

    return Feed(machine())


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.binary(max_size=60), max_size=8), st.integers(1, 50))
def test_frames_arrive_whole_wherever_a_read_ends(messages, size):
    got = []
    feed, stream = reader(got), b"hi" + framed(*messages)
    for at in range(0, len(stream), size):
        feed.feed(stream[at : at + size])
    assert got == [b"hi", *messages]
    assert feed.is_between
    feed.feed(framed(b"abc")[:-1])
    assert not feed.is_between
    assert got == [b"hi", *messages]


def test_a_large_frame_grows_the_buffer_as_it_comes_and_no_more_than_it_takes():
    got = []
    length = struct.Struct("<I")

    def machine():
        yield Frames(length, lambda data: got.append(len(data)), 1 << 24)

    feed = Feed(machine())
    feed.feed(length.pack(1 << 22) + bytes(1000))
    assert feed.size == 1 << 16
    feed.feed(bytes((1 << 22) - 1000) + length.pack(3) + b"abc")
    assert got == [1 << 22, 3]
    assert feed.size <= 1 << 23


def test_a_frame_above_the_limit_is_refused_behind_those_before_it():
    got = []
    with pytest.raises(ProtocolError, match="a message of 1001 bytes, more than max_message=1000"):
        reader(got).feed(b"hi" + framed(b"good", bytes(1001)))
    assert got == [b"hi", b"good"]


def test_who_closes_while_it_takes_a_frame_gets_no_other_one():
    got = []

    def take(data):
        got.append(bytes(data))
        feed.close()

    def machine():
        yield Frames(LENGTH, take, 1000)

    feed = Feed(machine())
    feed.feed(framed(b"one", b"two"))
    feed.feed(framed(b"three"))
    assert got == [b"one"]
    assert feed.is_between
