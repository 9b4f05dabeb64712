"""Fields that compiled functions assign: the holder is as if Python had assigned them."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit
from numba.core.errors import NumbaTypeError, TypingError

import rosetta_jit as rj

SCHEMA = {
    "a.proto": """
    syntax = "proto2"; package a;
    enum Closed { ONE = 1; TWO = 2; }
    message Inner { optional double x = 1; optional int32 n = 2; repeated float many = 3; }
    message M {
      optional int32 n = 1; optional float f = 2; optional bool flag = 3; optional Closed closed = 4; optional Inner inner = 5;
      repeated Inner inners = 6; oneof pick { double number = 7; Inner chosen = 8; int64 other = 9; } optional string text = 10;
      optional M deeper = 11; required uint64 must = 12;
    }
    """
}
IDL = {
    "u.idl": """
    module u {
      enum Kind { NUMBER, GRID };
      union Value switch (Kind) { case NUMBER: double single; case GRID: float several[3]; };
      struct M { Value v; @optional float cells[2]; sequence<long> counts; };
    };
    """
}


@pytest.fixture(scope="module")
def decoder():
    made = rj.Decoder.of("a.M", schema=SCHEMA)
    assert made.kernel is not None
    return made


def both(decoder, assign):
    """What a function leaves of a new holder, compiled and in Python."""
    compiled, plain = decoder.new(), decoder.new()
    for holder in (compiled, plain):
        holder.inners.add(x=1.0)
        holder.inners.add()
    njit(assign)(compiled)
    assign(plain)
    assert compiled == plain
    compiled.must = plain.must = 1
    assert compiled.SerializeToString() == plain.SerializeToString()
    return compiled


def test_numbers_of_every_kind(decoder):
    def assign(holder):
        holder.n = -5
        holder.f = 2
        holder.flag = True
        holder.closed = 2
        holder.must = 1 << 63

    holder = both(decoder, assign)
    assert (holder.n, holder.f, holder.flag, holder.closed) == (-5, 2.0, True, 2)


def test_what_is_around_becomes_present(decoder):
    def assign(holder):
        holder.inner.n = 0
        for inner in holder.inners:
            inner.n = 3
        holder.inners[-1].x = 7.5

    holder = both(decoder, assign)
    assert holder.HasField("inner")
    assert holder.inner.HasField("n")
    assert [(each.x, each.n) for each in holder.inners] == [(1.0, 3), (7.5, 3)]
    assert not holder.HasField("n")


def test_a_union_has_the_case_that_was_assigned(decoder):
    def assign(holder):
        holder.chosen.x = 4.0
        holder.number = 2.0
        holder.other = 3
        holder.chosen.n = 1

    holder = both(decoder, assign)
    assert holder.WhichOneof("pick") == "chosen"
    assert holder.chosen.x == 0


def test_what_is_read_behind_an_assignment(decoder):
    @njit
    def run(holder):
        before = holder.n, holder.has("inner"), holder.has("number")
        holder.n = 5
        holder.inner.x = holder.n * 0.5
        holder.number = holder.inner.x
        return before, (holder.n, holder.has("inner"), holder.has("number")), holder.number

    assert run(decoder.new()) == ((0, False, False), (5, True, True), 2.5)


def test_elements_of_arrays(decoder):
    def assign(holder):
        for inner in holder.inners:
            for index in range(len(inner.many)):
                inner.many[index] += index

    holder = decoder.new()
    for count in (3, 0, 2):
        holder.inners.add(many=[0.5] * count)
    njit(assign)(holder)
    assert [list(each.many) for each in holder.inners] == [[0.5, 1.5, 2.5], [], [0.5, 1.5]]


def test_a_discriminator_and_something_of_fixed_length():
    decoder = rj.Decoder.of("u::M", schema=IDL, encoding="cdr")
    assert decoder.kernel is not None

    @njit
    def enter(holder, kind):
        holder.v._d = kind
        return len(holder.v.several)

    holder, expected = decoder.new(), decoder.new()
    arrays = []
    for kind, length in ((1, 3), (0, 0), (1, 3)):
        assert enter(holder, kind) == length
        expected.v._d = kind
        assert holder == expected
        arrays.append(holder.v.several)
    for _ in range(300):  # makes the lane grow, again and again
        enter(holder, 0)
        enter(holder, 1)
    assert holder == expected
    assert [list(each) for each in arrays[::2]] == [[0.0] * 3] * 2

    @njit
    def number(holder):
        holder.v.single = 1.5
        return holder.v._d

    assert number(holder) == 0
    encode = rj.Encoder.of("u::M", schema=IDL, encoding="cdr")
    assert decoder(encode(holder)).v.single == 1.5


def test_no_other_value_of_a_closed_enum(decoder):
    @njit
    def run(holder, number):
        holder.closed = number

    holder = decoder.new()
    with pytest.raises(ValueError, match="a closed enum has no such value"):
        run(holder, 3)
    assert not holder.HasField("closed")
    run(holder, 2)
    assert holder.closed == 2


def test_numbers_are_converted_as_elements_of_arrays_are(decoder):
    @njit
    def run(holder, array):
        holder.n = 2**32 + 7
        holder.f = 1e300
        array[0] = 2**32 + 7

    holder, array = decoder.new(), np.zeros(1, np.int32)
    run(holder, array)
    assert holder.n == array[0] == 7
    assert holder.f == np.inf


def test_what_cannot_be_assigned_is_said(decoder):
    def text(holder):
        holder.text = holder.text

    def array(inner, values):
        inner.inner.many = values

    def nothing(holder):
        holder.nothing = 1

    with pytest.raises(NumbaTypeError, match=r"`text` of `a\.M` is no number"):
        njit(text)(decoder.new())
    with pytest.raises(NumbaTypeError, match=r"`many` of `a\.Inner` is no number"):
        njit(array)(decoder.new(), np.zeros(3, np.float32))
    with pytest.raises(TypingError, match="nothing"):
        njit(nothing)(decoder.new())


def test_after_a_failed_decode_nothing_is_assigned(decoder):
    kernel = decoder.kernel

    @njit
    def run(message, holder):
        broken = 0
        try:
            kernel(message, holder)
        except Exception:  # noqa: BLE001 - numba knows no other
            broken = 1
        holder.n = broken

    with pytest.raises(rj.InvalidHolder):
        run(b"\x08", decoder.new())
