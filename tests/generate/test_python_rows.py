"""Objects that generated Python makes of rows: each value has the type that its dataclass says."""

from __future__ import annotations

import types
import typing
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import Wishes
from tests.generate.driver import harmed
from tests.generate.python import BOTH, answers_as_the_library, module

ROS = """R[] rows
B[] raw
W[] within
D[5] few
N[] nested
H[] whole
S[] texts
L[] long
Z[] bits
===
MSG: t/R
int16[3] numbers
===
MSG: t/B
uint8[4] data
===
MSG: t/W
R inner
===
MSG: t/D
float64[2] numbers
===
MSG: t/N
R[2] rows
===
MSG: t/H
uint8[1] byte
===
MSG: t/S
string text
===
MSG: t/L
float64[20] numbers
===
MSG: t/Z
bool[18] bits
"""
LCM = """package t;
struct R { int16_t numbers[3]; } struct B { byte data[4]; } struct W { R inner; } struct D { double numbers[2]; }
struct N { R rows[2]; } struct H { byte one[1]; } struct S { string text; }
struct L { double numbers[20]; } struct Z { boolean bits[18]; }
struct T { int32_t n; R rows[n]; B raw[n]; W within[n]; D few[5]; N nested[n]; H whole[n]; S texts[n]; L long[n]; Z bits[n]; }
"""
TYPES = {"ros1": ("t/T", ROS), "cdr": ("t/msg/T", ROS), "lcm": ("t.T", {"t.lcm": LCM})}


def assert_said(value: object, hint: Any, scope: dict[str, Any]) -> None:
    """A value has the type of an annotation, and so has each value in it."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (typing.Union, types.UnionType):
        return
    assert isinstance(value, origin or hint)
    if is_dataclass(hint):
        hints = typing.get_type_hints(hint, scope)
        for each in fields(hint):
            assert_said(getattr(value, each.name), hints[each.name], scope)
    elif origin is list:
        assert isinstance(value, list)
        for each in value:
            assert_said(each, arguments[0], scope)


@pytest.mark.parametrize("arrays", ["", "numpy"])
@pytest.mark.parametrize("encoding", TYPES)
def test_lists_of_structs_that_are_one_array(encoding, arrays):
    """They are structs, not arrays: those of numbers, of bytes, and within others."""
    type_, schema = TYPES[encoding]
    given = {"encoding": encoding, "schema": schema}
    request, programs = type_request("decode", type_, given), (rj.Decoder.of(type_, **given), rj.Encoder.of(type_, **given))
    unit = module(request, BOTH, Wishes(numpy=bool(arrays)))
    made = unit.T(few=[unit.D(numbers=[each, each / 2]) for each in range(5)])
    good = [unit.encode(made)]
    for count in (1, 4):
        rows = [unit.R(numbers=[each, -each, 2 * each]) for each in range(count)]
        made = unit.T(
            rows=rows,
            raw=[unit.B(data=bytes(range(each, each + 4))) for each in range(count)],
            within=[unit.W(inner=row) for row in rows],
            few=made.few,
            nested=[unit.N(rows=[row, unit.R()]) for row in rows],
            texts=[unit.S(text=f"é{each}") for each in range(count)],
            whole=[unit.H(bytes([each])) for each in range(count)],
            long=[unit.L(numbers=[each / 3 + number for number in range(20)]) for each in range(count)],
            bits=[unit.Z(bits=[number % 3 == each for number in range(18)]) for each in range(count)],
        )
        if encoding == "lcm":
            made.n = count
        good.append(unit.encode(made))
        found = unit.decode(good[-1])
        assert found == made
        assert_said(found, unit.T, {**vars(unit), "np": np})
    answers_as_the_library(unit, programs, harmed(good, 24, encoding))


@pytest.mark.parametrize("arrays", ["", "numpy"])
def test_structs_that_are_one_array_and_are_wrong(arrays):
    """The first of them that is wrong is named, also where numpy joins the arrays of all."""
    unit = module(type_request("decode", "t/T", {"encoding": "ros1", "schema": ROS}), BOTH, Wishes(numpy=bool(arrays)))
    wrong = {
        ("count", ".rows[2].numbers"): [unit.R(numbers=[1, 2]), 7],
        ("range", ""): [7, unit.R(numbers=[1, 2])],
    }
    for (kind, path), rows in wrong.items():
        with pytest.raises(unit.EncodeError) as caught:
            unit.encode(unit.T(rows=[unit.R(), unit.R(), *rows, unit.R()]))
        assert (caught.value.kind, caught.value.path) == (kind, path)
    for numbers in ([1, 2, 40000], [1.5, 2, 3], ["1", 2, 3]):
        with pytest.raises(unit.EncodeError, match="range"):
            unit.encode(unit.T(rows=[*(unit.R() for _ in range(5)), unit.R(numbers=numbers)]))


FIXED = {
    "ros1": "P[3] p\nQ[2] q\nR[] r\nO[2] o\nV[2] v\n===\nMSG: t/P\nfloat64 x\nfloat64 y\n===\nMSG: t/Q\nint8 a\nP p\nuint32 b\n===\n"
    "MSG: t/R\nint16 n\nP[2] p\nfloat32 f\nQ[2] q\n===\nMSG: t/O\nbool b\nint64 i\n===\nMSG: t/V\nint32[2] v\n",
    "cdr": "P[3] p\nQ[2] q\nR[] r\nO[2] o\nV[2] v\n===\nMSG: t/P\nfloat64 x\nfloat64 y\n===\nMSG: t/Q\nint8 a\nP p\nuint32 b\n===\n"
    "MSG: t/R\nint16 n\nP[2] p\nfloat32 f\nQ[2] q\n===\nMSG: t/O\nbool b\nint64 i\n===\nMSG: t/V\nint32[2] v\n",
    "lcm": {
        "t.lcm": """package t; struct P { double x; double y; } struct Q { int8_t a; P p; int32_t b; }
struct R { int16_t n; P p[2]; float f; Q q[2]; } struct O { boolean b; int64_t i; } struct V { int32_t v[2]; }
struct T { int32_t n; P p[3]; Q q[2]; R r[n]; O o[2]; V v[2]; P g[n][2]; Q h[2][2]; P k[2][n]; P l[n][1]; }"""
    },
}


@pytest.mark.parametrize("arrays", ["", "numpy"])
@pytest.mark.parametrize("encoding", FIXED)
def test_few_structs_of_numbers(encoding, arrays):
    """Arrays of a fixed length, of structs of numbers: in messages, in rows, in arrays of arrays; those of bools and of arrays besides."""
    type_, given = {"ros1": "t/T", "cdr": "t/msg/T", "lcm": "t.T"}[encoding], {"encoding": encoding, "schema": FIXED[encoding]}
    request, programs = type_request("decode", type_, given), (rj.Decoder.of(type_, **given), rj.Encoder.of(type_, **given))
    unit, numbers = module(request, BOTH, Wishes(numpy=bool(arrays))), iter(range(1, 10_000))

    def points(count):
        return [unit.P(next(numbers) / 2, -next(numbers)) for _ in range(count)]

    def others(count):
        return [unit.Q(next(numbers) % 100, points(1)[0], next(numbers)) for _ in range(count)]

    good = []
    for count in (0, 1, 2, 5):
        made = unit.T(p=points(3), q=others(2), o=[unit.O(b=True, i=next(numbers)), unit.O()])
        made.r = [unit.R(next(numbers), points(2), next(numbers) / 4, others(2)) for _ in range(count)]
        made.v = [unit.V(np.array([each, 7], np.int32) if arrays else [each, 7]) for each in range(2)]
        if encoding == "lcm":
            made.n, made.g, made.h = count, [points(2) for _ in range(count)], [others(2), others(2)]
            made.k, made.l = [points(count), points(count)], [points(1) for _ in range(count)]
        good.append(unit.encode(made))
        found = unit.decode(good[-1])
        assert found == made
        assert_said(found, unit.T, {**vars(unit), "np": np})
    answers_as_the_library(unit, programs, harmed(good, 24, encoding))
