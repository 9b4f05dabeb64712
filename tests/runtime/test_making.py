"""Holders that compiled code makes and ends: as the class's own constructor makes them, and never with what another one left."""

from __future__ import annotations

import gc
import sys
import threading
import weakref

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.runtime.attributes.code import OFFSETS as IN_CODE
from rosetta_jit.runtime.attributes.code import library
from rosetta_jit.runtime.holder.objects.taking import Takers
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.limits import MAX_ENDED
from rosetta_jit.runtime.type_specs import slot_offset

pytestmark = pytest.mark.skipif(library() is None, reason="this Python is none that compiled code knows")

OFFSETS = {"arena": 24, "arrays": 40, "buffers": 48, "cells": 56, "hidden": 64, "lock": 80, "memory": 88, "registers": 104, "source": 120}


@pytest.fixture(scope="module")
def decoder():
    return rj.Decoder.of("sensor_msgs/msg/JointState", encoding="cdr")


@pytest.fixture(scope="module")
def joint_state(decoder):
    return decoder.holder_type


@pytest.fixture(scope="module")
def quaternion():
    return rj.Decoder.of("geometry_msgs/msg/Quaternion", encoding="cdr").holder_type


@pytest.fixture
def derived(quaternion):
    class Derived(quaternion):
        ended = ()

        def __init__(self, x=1.0):
            super().__init__()
            self.x = x

        def __del__(self):
            type(self).ended = (*type(self).ended, self.x)

    return Derived


def filled(made):
    made.header.frame_id, made.name, made.position = "base", ["a", "bc"], [1.0, 2.0, 3.0]
    return made


def test_slots_lie_where_compiled_code_seeks_them():
    expected = OFFSETS | {"spares": 128, "state": 136, "words": 144}
    assert {name: slot_offset(vars(Lanes)[name]) for name in expected} == expected
    assert Lanes.__weakrefoffset__ == IN_CODE["LANES_WEAK_LIST"]


def test_a_class_makes_what_its_constructor_makes(quaternion):
    for each in [quaternion() for _ in range(3 * MAX_ENDED)]:
        assert (each.x, each.y, each.z, each.w) == (0.0, 0.0, 0.0, 1.0)
    changed = quaternion(x=2.0)
    assert (changed.x, changed.w) == (2.0, 1.0)
    changed.clear()
    assert changed.w == 0.0
    with pytest.raises(TypeError):
        quaternion(1.0)
    with pytest.raises(TypeError):
        quaternion(a=1.0)


def test_nothing_is_left_of_one_that_has_ended(decoder, joint_state):
    for new in (decoder.new, joint_state, joint_state().new):
        for _ in range(3):
            several = [filled(new()) for _ in range(2 * MAX_ENDED)]
            assert all(each.name[1] == "bc" for each in several)
            del several
        for each in [new() for _ in range(2 * MAX_ENDED)]:
            assert each.to_dict() == joint_state.from_dict({}).to_dict()
            assert each == joint_state.from_dict({})


def test_who_shows_a_holder_that_has_ended_keeps_it(decoder):
    made = filled(decoder.new())
    array, header, names, stamp = made.position, made.header, made.name, made.header.stamp
    del made
    others = [filled(decoder.new()) for _ in range(2 * MAX_ENDED)]
    for each in others:
        each.position, each.header.frame_id, each.header.stamp.sec, each.name = [9.0, 9.0, 9.0], "else", 9, ["x", "y"]
    assert np.array_equal(array, [1.0, 2.0, 3.0])
    assert (header.frame_id, list(names), stamp.sec) == ("base", ["a", "bc"], 0)


def test_a_constructor_of_ones_own_runs(derived):
    assert (derived().x, derived(3.0).x, derived(x=4.0).w) == (1.0, 3.0, 1.0)
    assert derived.ended == (1.0, 3.0, 4.0)


def test_one_that_is_revived_lives(quaternion):
    revived = []

    class Revived(quaternion):
        def __del__(self):
            revived.append(self)

    made = Revived()
    made.x = 5.0
    del made
    assert [each.x for each in revived] == [5.0]
    del Revived.__del__
    revived.clear()
    assert quaternion().x == 0.0


def test_a_class_that_is_given_another_constructor_calls_it():
    made = rj.Decoder.of("geometry_msgs/msg/Vector3Stamped", encoding="cdr").holder_type
    assert made().header.frame_id == made().header.frame_id == ""
    before = made.__init__

    def begin(self):
        before(self)
        self.header.frame_id = "here"

    made.__init__ = begin
    assert [made().header.frame_id for _ in range(3)] == ["here"] * 3
    del made.__init__
    assert made().header.frame_id == ""


def test_weak_references_end_with_a_holder(quaternion):
    told = []
    made = quaternion()
    reference = weakref.ref(made, told.append)
    del made
    assert reference() is None
    assert told == [reference]


def test_classes_and_memory_are_let_go_of(decoder, quaternion):
    filled(decoder.new())
    gc.collect()
    before = sys.getrefcount(quaternion), sys.getrefcount(decoder.holder_type), sys.getrefcount(None)
    for _ in range(500):
        quaternion()
        decoder.new()
    after = sys.getrefcount(quaternion), sys.getrefcount(decoder.holder_type), sys.getrefcount(None)
    assert all(abs(one - other) < 40 for one, other in zip(before, after, strict=True))
    made = quaternion()
    lanes = weakref.ref(made.lanes_)
    del made
    assert lanes() is None, "what somebody has a weak reference to is no other holder's"


def test_holders_that_the_collector_of_garbage_ends(decoder, joint_state):
    """Their lanes are garbage, too, until they are kept for others."""
    for _ in range(3):
        for new in (decoder.new, joint_state):
            circle = [filled(new()) for _ in range(2 * MAX_ENDED)]
            circle.append(circle)
            del circle
            gc.collect()
            made = [new() for _ in range(2 * MAX_ENDED)]
            assert not any(len(each.name) or len(each.position) for each in made)
            assert all(filled(each).name[1] == "bc" for each in made)
            assert all(gc.is_tracked(each.lanes_) for each in made)


def test_holder_classes_that_end_with_their_programs():
    for number in range(4):
        schema = f"int32 a{number}\nstring text\ngeometry_msgs/Point place"
        decode, encode = (each.of(f"test_msgs/Ending{number}", encoding="ros1", schema=schema) for each in (rj.Decoder, rj.Encoder))
        plain = {f"a{number}": 1, "text": "abc", "place": {"x": 1.0, "y": 2.0, "z": 3.0}}
        kept = [decode.holder_type.from_dict(plain), decode.holder_type(), decode.new(), decode.new]
        assert decode(encode(kept[0])) == kept[0]
        circle = [decode, encode, kept, kept[0].place]
        circle.append(circle)
        gone = weakref.ref(decode)
        del decode, encode, kept, circle
        gc.collect()
        assert gone() is None


def test_new_takes_nothing(decoder):
    with pytest.raises(TypeError, match="no arguments"):
        decoder.new(1)
    with pytest.raises(TypeError, match="no arguments"):
        decoder.new(room=1)


def test_what_makes_holders_does_not_keep_its_decoder():
    decoder = rj.Decoder.of("geometry_msgs/msg/Quaternion", encoding="cdr")
    new, gone = decoder.new, weakref.ref(decoder)
    del decoder
    gc.collect()
    assert gone() is None
    assert new().w == 0.0


def test_threads_make_and_end_holders(decoder):
    wrong = []

    def run(number):
        for each in range(400):
            made = decoder.new()
            if len(made.name) or len(made.position):
                wrong.append(made)
            made.name, made.position = [str(number)], [float(each)]
            if list(made.name) != [str(number)] or made.position[0] != each:
                wrong.append(made)

    threads = [threading.Thread(target=run, args=(number,)) for number in range(4)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert not wrong


def test_an_array_of_texts_is_shown_without_what_other_code_asks_of_lanes(joint_state):
    """To make that takes as long as to make what shows the array."""
    made = joint_state()
    names = made.name
    for slot in ("memory", "words", "lock"):
        with pytest.raises(AttributeError):
            object.__getattribute__(made.lanes_, slot)
    names.extend(["a", "bc"])
    assert list(made.name) == ["a", "bc"]


def test_arrays_and_messages_of_a_holder_that_failed_are_refused(decoder, joint_state):
    made = joint_state()
    names, header = made.name, made.header
    with pytest.raises(rj.DecodeError):
        decoder(b"\0\1\0\0", made)
    for read in (lambda: made.name, lambda: names[0], lambda: header.frame_id):
        with pytest.raises(rj.InvalidHolder, match="last decode into this holder failed"):
            read()
    made.clear()
    assert (list(made.name), list(names), header.frame_id) == ([], [], "")


def test_plain_values_become_holders_in_compiled_code_from_the_second_on(monkeypatch):
    """Whether or not somebody has called the class, and again where it has learned that messages need more room."""
    in_python: list[object] = []
    take_plain = Takers.take_plain
    monkeypatch.setattr(Takers, "take_plain", lambda *given: in_python.append(given[2]) or take_plain(*given))
    types = {}  # of no other test, as a process keeps what it has made
    for name in ("of_made", "of_fresh"):
        schema = {f"test_msgs/{name}.msg": f"string name\nfloat32[] values\nuint8 {name}\n"}
        types[name] = rj.Decoder.of(f"test_msgs/{name}", encoding="ros1", schema=schema).holder_type
    types["of_made"]()
    for name, holder_type in types.items():
        values = {"name": "x", "values": [3.5] * 12, name: 3}
        assert [holder_type.from_dict(values).to_dict() for _ in range(4)] == [values] * 4
        assert len(in_python) == 1
        holder_type.from_dict(values).values = [3.5] * 100
        assert [holder_type.from_dict(values).to_dict() for _ in range(4)] == [values] * 4
        assert len(in_python) <= 2
        in_python.clear()
