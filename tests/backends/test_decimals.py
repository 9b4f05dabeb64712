"""Floats in decimal: every backend against Python's own, and against exact rationals."""

from __future__ import annotations

import math
import random
import struct
from fractions import Fraction

import numpy as np
import pytest

from rosetta_jit.kernel import decimals
from rosetta_jit.kernel.nodes import Binary, Digits, Load, Nearest, Place, Require, Return, Scale, SetField, Wire
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index
from tests.backends import kernels
from tests.backends.engines import ENGINES, outcome
from tests.backends.holders import rows

EDGES = [0.0, -0.0, 0.1, 1.0, 123.456, 5e-324, 2.2250738585072014e-308, 1e22, 1e23, 9007199254740993.0, 1.7976931348623157e308]
EDGES += [2.0**exponent for exponent in (-97, -44, -24, 89, 305)]


def random_floats(type_, count):
    rng = random.Random(4)
    form, bits = ("<f", 32) if type_ == "f32" else ("<d", 64)
    return [struct.unpack(form, rng.getrandbits(bits).to_bytes(bits // 8, "little"))[0] for _ in range(count)]


def written(type_):
    value = Load(type_, BEGIN)
    fields = (
        SetField(Place(0, ROW, 0), Digits(value)),
        SetField(Place(0, ROW, 8), Scale(value)),
        SetField(Place(0, ROW, 16), Digits(value, 3)),
    )
    return kernels.kernel((Require(BEGIN, index(8), kernels.failure(1)), *fields, Return(END)), strides=(24,), name=f"written_{type_}")


@pytest.mark.parametrize("type_", ["f64", "f32"])
@pytest.mark.parametrize("backend", ENGINES)
def test_written_numbers(backend, type_):
    kernel, form = written(type_), "<d" if type_ == "f64" else "<f"
    least = [float("inf"), float("-inf"), float("nan")]
    for value in [*(each for each in EDGES if type_ == "f64" or abs(each) < 1e30), *least, *random_floats(type_, 200)]:
        holder = rows(kernel, 1)
        outcome(backend, kernel, struct.pack(form, value).ljust(8, b"\0"), holder)
        digits, scale, fixed = (int(word) for word in holder.lanes[0].view("<u8")[:3])
        scale -= 1 << 64 if scale >> 63 else 0
        held = float(np.float32(value)) if type_ == "f32" else value
        assert (digits, scale) == decimals.shortest(type_, held)
        assert fixed == decimals.digits(type_, held, 3)


@pytest.mark.parametrize("type_", ["f64", "f32"])
def test_as_python_and_numpy_write_them(type_):
    """Above powers of two, the nearest digits may not be among those that read back."""
    single, exponents = type_ == "f32", range(-149, 128) if type_ == "f32" else range(-1074, 1024)
    for value in filter(math.isfinite, [*random_floats(type_, 3000), *(2.0**each for each in exponents), *([] if single else EDGES)]):
        digits, scale = decimals.shortest(type_, value)
        assert float(f"{digits}e{scale}") == abs(value) or single
        shown = str(abs(np.float32(value))) if single else repr(abs(value))
        assert str(digits).strip("0") == "".join(each for each in shown.partition("e")[0] if each.isdigit()).strip("0")


READ = [
    ("0", 0),
    ("000", 5),
    ("1", 400),
    ("1", -400),
    ("9007199254740993", 0),
    ("9007199254740992" + "9" * 30, -30),
    ("1.5x", -1),
    ("0." + "0" * 900 + "25", -902),
    (str(Fraction(5e-324) * 10**1074 // 2), -1074),
    (str(Fraction(5e-324) * 10**1074 // 2) + "0" * 200 + "1", -1275),
    ("179769313486231580793" + "0" * 288, 0),
    ("7" * 2000, -1990),
]


@pytest.mark.parametrize(("text", "exponent"), READ)
@pytest.mark.parametrize("backend", ENGINES)
def test_read_numbers(backend, text, exponent):
    value = Nearest(Wire(add(BEGIN, 8)), Binary("sub", END, add(BEGIN, 8)), Load("i64", BEGIN))
    body = (
        Require(BEGIN, index(8), kernels.failure(1)),
        Require(add(BEGIN, 8), Binary("sub", END, add(BEGIN, 8)), kernels.failure(1)),
        SetField(Place(0, ROW), value),
        Return(END),
    )
    kernel = kernels.kernel(body, strides=(8,), name="read")
    holder = rows(kernel, 1)
    outcome(backend, kernel, struct.pack("<q", exponent) + text.encode(), holder)
    digits = "".join(each for each in text if each.isdigit())
    assert holder.lanes[0].view("<f8")[0] == np.float64(float(f"{digits}e{exponent}"))
