"""Parts of batches, batches put together, and batches that are pickled: by lanes, and always the same messages."""

from __future__ import annotations

import copy
import pickle
import random
import struct
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.errors import InUse, InvalidHolder
from rosetta_jit.kernel.state import VALID
from rosetta_jit.runtime.batches.batch import Batch

sys.path.insert(0, str(Path(__file__).parent))
from schemas import flat, whole


def revived(pickled, **options):
    return pickle.loads(pickled, **options)  # noqa: S301 - our own


def filled(count, seed=0):
    rng, batch = random.Random(seed), Batch.new(whole(), count)
    for _ in range(2):
        for index, message in enumerate(batch):
            message.small = index % 100
            message.angles = [index + 0.5] * rng.randrange(4)
            message.text = "s" * rng.randrange(4)
            message.data = rng.randbytes(rng.randrange(4))
            message.parts = [{"x": index, "values": [index] * rng.randrange(3)}] * rng.randrange(3)
            message.names = ["é" * rng.randrange(3) for _ in range(rng.randrange(3))]
            message.matrix = [[index] * 2] * rng.randrange(3)
            message.by_name = {str(each): {"x": each} for each in range(rng.randrange(3))}
            setattr(message, *rng.choice([("maybe", 1.0), ("left", index), ("right", {"name": "r", "values": [1, 2]}), ("flag", True)]))
            message.children = [{"small": 1, "children": [{"text": "deep"}] * rng.randrange(3)}] * rng.randrange(3)
            if rng.random() < 0.5:
                message.child = {"child": {"angles": [1, 2]}, "children": [{"small": 3}]}
    return batch


def plain(messages):
    return [message.to_dict() for message in messages]


@pytest.mark.parametrize("index", [slice(5, 10), slice(None, None, -3), slice(8, 2), np.arange(20) % 3 == 1, [7, 7, -1], [], np.uint8([3])])
def test_parts(index):
    batch = filled(20)
    part, whole_ = batch[index], plain(batch)
    numbers = np.arange(20)[index if isinstance(index, slice) else np.asarray(index, dtype=None if len(index) else int)]
    assert isinstance(part, Batch)
    assert plain(part) == [whole_[number] for number in numbers]
    for message in part:
        message.angles = [9.0]
        message.children.clear()
    assert plain(batch) == whole_


def test_what_chooses_no_messages():
    batch = filled(4)
    for index in ([4], [-5], np.zeros(3, np.bool_)):
        with pytest.raises(IndexError):
            batch[index]
    for index in ("small", [1.5], np.zeros((2, 2), int), None):
        with pytest.raises(TypeError, match="chosen by"):
            batch[index]


def test_concatenation():
    batches = [filled(3, 1), Batch.new(whole(), 0), filled(5, 2)]
    assert plain(Batch.concatenate(batches)) == [each for batch in batches for each in plain(batch)]
    with pytest.raises(TypeError, match=r"t\.Flat, t\.Whole"):
        Batch.concatenate([Batch.new(flat(), 1), filled(1)])
    with pytest.raises(ValueError, match="no batch"):
        Batch.concatenate([])


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_pickling(protocol):
    batch = filled(20)
    again = revived(pickle.dumps(batch, protocol))
    assert plain(again) == plain(batch)
    again[3].angles = [1, 2, 3, 4]
    assert plain(again[4:]) == plain(batch[4:])
    assert plain(copy.copy(batch)) == plain(copy.deepcopy(batch)) == plain(batch)
    assert len(revived(pickle.dumps(Batch.new(flat(), 0), protocol))) == 0


def test_pickles_hand_on_lanes_without_a_copy():
    buffers = []
    batch = Batch.new(flat(), 1000)
    small = pickle.dumps(batch, 5, buffer_callback=buffers.append)
    assert len(small) < 20_000 <= sum(each.raw().nbytes for each in buffers)
    assert plain(revived(small, buffers=buffers)) == plain(batch)


def test_lanes_of_another_version():
    function, (text, manners, found, *rest) = Batch.new(flat(), 2).__reduce__()
    for wrong in (found[:-1], [found[0][:-1], *found[1:]]):
        with pytest.raises(ValueError, match="another version"):
            function(text, manners, wrong, *rest)


def test_borrowed_bytes_come_along():
    decode = rj.Decoder.of("rst.vision.Image", encoding="protobuf", borrow=True)
    encode = rj.Encoder.of("rst.vision.Image", encoding="protobuf")
    message = b"\x0a\x06\x01\x02\x03\x04\x05\x06\x10\x02\x18\x01"
    buffer = bytearray(message * 3)
    batch = decode.many(buffer, np.arange(4) * len(message))
    part, again = batch[1:], revived(pickle.dumps(batch))
    batch[1].data = b"own"
    both = Batch.concatenate([part, batch])
    buffer[:] = bytes(len(buffer))
    pixels = bytes(range(1, 7))
    assert [bytes(each.data) for each in both] == [pixels, pixels, pixels, b"own", pixels]
    assert [bytes(each.data) for each in again] == [pixels] * 3
    written, offsets = encode.many(again)
    assert bytes(written) == message * 3
    written, offsets = encode.many(batch)
    assert [decode(bytes(written[a:b])).data for a, b in pairwise(offsets)] == [bytes(6), b"own", bytes(6)]


def test_parts_of_messages_that_contain_each_other_are_encoded():
    """Encoders want each row of a recursive lane behind the one that refers to it."""
    schema = {"tree.proto": 'syntax = "proto3"; package t; message Tree { int32 n = 1; repeated Tree trees = 2; Tree one = 3; }'}
    decode, encode = (make.of("t.Tree", encoding="protobuf", schema=schema) for make in (rj.Decoder, rj.Encoder))
    batch = Batch.new(decode.holder_type, 5)
    for number, message in enumerate(batch):
        message.n = number
        for _ in range(number):
            message.trees.add(n=7).trees.add(n=8).one.n = 9
        message.trees.add().one.trees.add(n=number)
    written, offsets = encode.many(batch)
    part, places = encode.many(batch[::-1])
    assert [bytes(part[a:b]) for a, b in pairwise(places)] == [bytes(written[a:b]) for a, b in pairwise(offsets)][::-1]


def test_what_cannot_be_read_has_no_parts():
    batch = Batch.new(flat(), 2)
    with batch.lanes, pytest.raises(InUse):
        batch[:1]
    batch.lanes.words[VALID] = 0
    for read in (lambda: batch[:1], lambda: Batch.concatenate([batch]), lambda: pickle.dumps(batch)):
        with pytest.raises(InvalidHolder):
            read()


def test_a_batch_whose_decode_failed_is_not_encoded():
    message = struct.pack("<ii3d", 266, 3, 1.0, 2.0, 3.0)
    decode = rj.Decoder("yarp/icub/torso_state.mapping")
    batch = decode.many(message, np.array([0, len(message)]))
    with pytest.raises(rj.DecodeError):
        decode.many(message[:-1], np.array([0, len(message) - 1]), into=batch)
    with pytest.raises(InvalidHolder):
        rj.Encoder("yarp/icub/torso_state.mapping", encoding="yarp3").many(batch)


def test_errors_go_with_their_messages():
    """Parts, and batches put together, know which messages could not be decoded."""
    decode, encode = (program.of("std_msgs/String", encoding="ros1") for program in (rj.Decoder, rj.Encoder))
    good, bad = bytes(encode({"data": "a"})), b"\xff"
    masked = decode.many([good, bad, good, bad], on_error="mask")
    part = masked[[3, 0, 2]]
    assert part.mask().tolist() == [False, True, True]
    assert list(part.errors) == [0]
    assert part.to_arrow(errors="why")["why"].is_valid().to_pylist() == [True, False, False]
    skipped = decode.many([good, bad, good, bad], on_error="skip")
    assert skipped[1:].kept.tolist() == [2]
    assert list(skipped[1:].errors) == [1, 3]
    whole = rj.Batch.concatenate([masked, decode.many([good]), skipped, skipped[1:], part])
    assert whole.kept.tolist() == [0, 1, 2, 3, 4, 5, 7, 11, 13, 14, 15]
    assert sorted(whole.errors) == [1, 3, 6, 8, 10, 12, 13]
    assert whole.mask().tolist() == [True, False, True, False, *[True] * 4, False, True, True]
    assert [message.data for message in whole] == ["a", "", "a", "", "a", "a", "a", "a", "", "a", "a"]
    assert rj.Batch.concatenate([masked, part])._kept is None
    with pytest.raises(TypeError, match="batches are needed, not int"):
        rj.Batch.concatenate([masked, 1])
    with pytest.raises(TypeError, match="a batch of String is needed"):
        decode.many([good], into=5)
