"""The pieces of a log: read one by one, in any grouping, they give the messages that the whole gives; also where the index lies."""

from __future__ import annotations

import pickle
import struct
import warnings

import pytest

import rosetta_jit as rj
from rosetta_jit.logs.base import Wanted
from rosetta_jit.logs.lcm import reader as lcm_reader

from .made import time_of, write_bag, write_lcm, write_mcap
from .test_damage import chunk_at

COUNT = 60


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("pieces")


@pytest.fixture(scope="module", params=["chunked.mcap", "loose.mcap", "unfinished.mcap", "a.bag", "a.lcmlog"])
def path(request, folder):
    made = folder / request.param
    match request.param:
        case "loose.mcap":
            return write_mcap(made, COUNT, chunked=False)
        case "a.bag":
            return write_bag(made, COUNT)
        case "a.lcmlog":
            return write_lcm(made, COUNT)
        case _:
            return write_mcap(made, COUNT, chunk_size=300, finish=request.param != "unfinished.mcap")


def raw(log, pieces=None, **wanted):
    """Channel, time and bytes of messages."""
    for block in log.blocks(Wanted(pieces=pieces, **wanted)):
        rows = block.rows
        for number, time, begin, end in zip(*(each.tolist() for each in (rows.channels, rows.log_ns, rows.begins, rows.ends)), strict=True):
            yield number, time, bytes(block.data[begin:end])


def by_pieces(log, step=1, **wanted):
    for first in range(0, len(log.pieces), step):
        yield from raw(log, range(first, min(first + step, len(log.pieces))), **wanted)


def opened(path):
    return rj.open(path, check=False, on_problem=list[object]().append)


def test_every_message_is_in_one_piece(path, monkeypatch):
    monkeypatch.setattr(lcm_reader, "PIECE", 500)
    monkeypatch.setattr(lcm_reader, "WINDOW", 300)
    log = opened(path)
    whole = list(raw(log))
    assert len(whole) == COUNT + COUNT // 5 - (path.name == "unfinished.mcap")
    assert len(log.pieces) > 1 or path.name == "loose.mcap"
    assert list(by_pieces(log)) == whole
    assert list(by_pieces(log, 3)) == whole
    assert not list(raw(log, range(0)))
    late = {"start_ns": time_of(20), "end_ns": time_of(40)}
    assert list(by_pieces(log, **late)) == list(raw(log, **late))
    assert sum(each.size for each in log.pieces) <= path.stat().st_size


def test_pieces_say_what_is_in_them(folder):
    log = opened(write_mcap(folder / "told.mcap", COUNT, chunk_size=300))
    for place, piece in enumerate(log.pieces):
        found = list(raw(log, range(place, place + 1)))
        times = [time for _, time, _ in found]
        assert piece.times == ((min(times), max(times)) if times else None)
        assert piece.connections is None or piece.connections == {number for number, _, _ in found}


@pytest.mark.parametrize("off", [1, 5, 40, -3, 1 << 30])
def test_an_index_that_lies_moves_no_message_into_two_pieces(folder, off):
    data = write_mcap(folder / "true.mcap", COUNT, chunk_size=300).read_bytes()
    whole = list(raw(opened(folder / "true.mcap")))
    at = chunk_at(data)
    second = at + 9 + int.from_bytes(data[at + 1 : at + 9], "little")
    while data[second] != 6:
        second += 9 + int.from_bytes(data[second + 1 : second + 9], "little")
    for place in (at, second):
        told = data.rindex(struct.pack("<Q", place))
        path = folder / "lies.mcap"
        path.write_bytes(data[:told] + struct.pack("<Q", place + off) + data[told + 8 :])
        log = opened(path)
        assert list(by_pieces(log)) == whole
        assert list(by_pieces(log, 2)) == whole
        assert log.problems


def test_logs_and_channels_are_pickled_by_their_names(path):
    log = opened(path)
    with warnings.catch_warnings(action="ignore", category=rj.LogWarning):
        again, channel = pickle.loads(pickle.dumps((log, log["/a"])))  # noqa: S301 - they are our own
    assert list(raw(again)) == list(raw(log))
    assert (channel.topic, channel.type, channel.count) == ("/a", log["/a"].type, log["/a"].count)
    if path.suffix != ".lcmlog":
        assert channel["x"].tolist() == [number / 4 for number in range(log["/a"].count)]


def test_standard_input_cannot_be_opened_twice(path, monkeypatch):
    log = opened(path)
    log.name = "-"
    with pytest.raises(TypeError, match="standard input"):
        pickle.dumps(log)
