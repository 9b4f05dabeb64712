"""The reference semantics."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosetta_jit.kernel import arithmetic, interpret
from rosetta_jit.kernel.nodes import Binary, Const, Convert, Let, Load, Local, Place, Require, Return, SetField
from rosetta_jit.kernel.state import ERROR_INDICES, ERROR_OFFSET, ERROR_SITE, GROW, GROW_LANE, GROW_ROWS, USED, lane_word
from rosetta_jit.kernel.terms import BEGIN, ROW, add, index
from tests.kernel import kernels
from tests.kernel.kernels import Holder


def run(kernel, message, holder, begin=0):
    return interpret.run(kernel, message, begin, len(message), holder.state, holder.lanes, 0)


def tagged(*values):
    return b"".join(struct.pack("<id", 10, value) for value in values)


def test_fixed_struct():
    kernel, holder = kernels.tagged_doubles(3), Holder((24,))
    assert run(kernel, tagged(1.0, 2.0, 3.0), holder) == 36
    assert struct.unpack_from("<3d", holder.lanes[0]) == (1.0, 2.0, 3.0)


def test_failure_leaves_offset_and_site():
    kernel, holder = kernels.tagged_doubles(3), Holder((24,))
    assert run(kernel, tagged(1.0, 2.0)[:20], holder, begin=0) == -2
    assert (holder.state[ERROR_OFFSET], holder.state[ERROR_SITE]) == (16, 1)
    wrong = bytearray(tagged(1.0, 2.0, 3.0))
    wrong[12] = 11
    assert run(kernel, wrong, holder) == -3
    assert holder.state[ERROR_OFFSET] == 12


def test_list_grows_and_counts_only_on_return():
    kernel, holder = kernels.counted_list(), Holder((64, 8), rows=2)
    message = struct.pack("<i3q", 3, 7, 8, 9)
    assert run(kernel, message, holder) == GROW
    assert (holder.state[GROW_LANE], holder.state[GROW_ROWS]) == (1, 1)
    assert run(kernel, message[:-1], Holder((64, 8))) == -5
    holder = Holder((64, 8))
    assert run(kernel, message[:-1], holder) == -5
    assert holder.state[ERROR_INDICES] == 2
    assert holder.state[lane_word(1, USED)] == 0
    assert run(kernel, message, holder) == 28
    assert holder.state[lane_word(1, USED)] == 3


def test_the_attempt_that_came_farthest_is_reported():
    holder = Holder((24,))
    assert run(kernels.ALL["attempts"], tagged(1.0, 2.0), holder) == -2
    assert holder.state[ERROR_OFFSET] == 24
    assert run(kernels.ALL["attempts"], b"\x02\x01\x02\x07", holder) == 4


def test_varints_and_switch():
    holder = Holder((8,))
    assert run(kernels.varints(), bytes([5, 0x80, 1]), holder) == 3
    assert struct.unpack_from("<Q", holder.lanes[0]) == (5 ^ 128,)
    holder = Holder((16,))
    assert run(kernels.choice(), b"\x02\xff\xfe", holder) == 3
    assert struct.unpack_from("<q", holder.lanes[0]) == (-2,)


@pytest.mark.parametrize(("type_", "bits"), [("f32", 0x7F800001), ("f64", 0x7FF0000000000001)])
@pytest.mark.parametrize("order", "<>")
def test_signalling_nan_moves_unchanged(type_, bits, order):
    width = 4 if type_ == "f32" else 8
    message = bits.to_bytes(width, "little" if order == "<" else "big")
    kernel = kernels.kernel((SetField(Place(0, ROW), Load(type_, BEGIN, order)), Return(index(0))))
    holder = Holder((64, 8))
    assert run(kernel, message, holder) == 0
    assert int.from_bytes(holder.lanes[0][:width], "little") == bits


def test_broken_obligations_are_assertions():
    beyond = kernels.kernel((Let("x", Load("i64", add(BEGIN, 1))), Return(index(0))))
    with pytest.raises(AssertionError, match="outside the message"):
        run(beyond, bytes(8), Holder((64, 8)))
    wrapping = kernels.kernel((Let("x", Binary("add", Const("i64", 2**63 - 1), index(1))), Return(index(0))))
    with pytest.raises(AssertionError, match="wrapped"):
        run(wrapping, b"", Holder((64, 8)))


def test_require_refuses_extents_that_would_wrap():
    huge = kernels.kernel((Require(index(2**63 - 1), index(2**63 - 1), kernels.fail(1)), Return(index(0))))
    assert run(huge, b"", Holder((64, 8))) == -2


@given(st.integers(-(2**63), 2**63 - 1), st.integers(-(2**63), 2**63 - 1).filter(bool))
def test_division_truncates(a, b):
    if (a, b) != (-(2**63), -1):
        quotient, rest = arithmetic.binary("i64", "div", a, b), arithmetic.binary("i64", "rem", a, b)
        assert quotient * b + rest == a
        assert abs(rest) < abs(b)
        assert rest == 0 or (rest < 0) == (a < 0)


@given(st.integers(-(2**63), 2**63 - 1))
def test_integers_to_f32_round_once(value):
    assert arithmetic.convert("f32", value) == np.array([value], np.int64).astype(np.float32)[0]


@pytest.mark.parametrize(
    ("value", "type_", "expected"),
    [(float("nan"), "i32", 0), (1e300, "i32", 2**31 - 1), (-1e300, "u8", 0), (float("inf"), "u64", 2**64 - 1), (-1.9, "i8", -1)],
)
def test_floats_saturate(value, type_, expected):
    assert arithmetic.convert(type_, np.float64(value)) == expected


def test_f32_arithmetic_is_f32():
    third = Convert("f64", Binary("div", Const("f32", 1.0), Const("f32", 3.0)))
    kernel = kernels.kernel((Let("x", third), SetField(Place(0, ROW), Local("f64", "x")), Return(index(0))))
    holder = Holder((64, 8))
    assert run(kernel, b"", holder) == 0
    assert struct.unpack_from("<d", holder.lanes[0])[0] == float(np.float32(1) / np.float32(3))
