"""What the benchmarks measure is right: ours and every peer that is installed read each message and write it again."""

from __future__ import annotations

from io import BytesIO

import numpy as np
import pytest

from bench import growing
from bench.peers import python_peers
from bench.subjects import ROS_2, SUBJECTS

ALL = {**SUBJECTS, **ROS_2}


@pytest.mark.parametrize("name", ALL)
def test_ours_and_all_peers_give_back_the_message(name):
    subject = ALL[name]
    assert subject.encoder()(subject.decoder()(subject.message)) == subject.message
    for peer in python_peers(subject):
        value = peer.decode(subject.message)
        if peer.encode is not None:
            assert bytes(peer.encode(value)) == subject.message, peer.who


@pytest.mark.parametrize("name", ALL)
def test_peers_that_do_not_write_read_the_same_numbers(name):
    message, holder = ALL[name].message, ALL[name].decoder()(ALL[name].message).to_dict()
    for peer in python_peers(ALL[name]):
        value = None if peer.encode else peer.decode(message)
        if isinstance(value, tuple | np.ndarray):
            (wanted,) = [each for each in holder.values() if np.size(each) > 20]
            assert np.array_equal(value, wanted), peer.who
        elif hasattr(value, "serialize"):
            buffer = BytesIO()
            value.serialize(buffer)
            assert buffer.getvalue() == message, peer.who
        elif hasattr(value, "angles"):
            assert value.angles == list(holder["angles"]), peer.who


@pytest.mark.parametrize("size", [8, 64, 4096])
def test_doubles_have_their_size(size):
    subject = growing.doubles(size)
    assert len(subject.message) == size
    (values,) = subject.decoder()(subject.message).to_dict().values()
    assert len(values) == size // 8 - 1


@pytest.mark.parametrize("make", [growing.fields, growing.optional_fields, growing.required_fields])
def test_fields_are_what_they_say(make):
    subject = make(20)
    holder = subject.decoder()(subject.message)
    assert [getattr(holder, f"field{index}") for index in range(20)] == list(map(float, range(20)))


def test_nested_messages_hold_their_values_at_the_bottom():
    holder = growing.nested(5).decoder()(growing.nested(5).message)
    tagged = growing.nested_tagged(5).decoder()(growing.nested_tagged(5).message)
    for _ in range(4):
        holder, tagged = holder.inner, tagged.inner
    assert np.array_equal(holder.values, np.arange(64.0))
    assert tagged.value == 1.5
