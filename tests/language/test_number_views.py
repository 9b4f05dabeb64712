"""Bytes as arrays of numbers, and squares of numbers as triangles: both ways, in every backend."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from tests.language.pairs import BACKENDS, codes, pair

ALL = [*BACKENDS, "llvm"]


@pytest.mark.parametrize("backend", ALL)
@pytest.mark.parametrize(("type_", "big"), [("<f4", ""), ("<f4", ", false"), (">f4", ", true")])
def test_floats_within_bytes(type_, big, backend):
    both = pair('("data" :blob)', "repeated float depth = 1;", f"rules:\n  .depth <-> numbers(.data, float32{big})\n", backend)
    values = np.array([1.5, -2.25, np.inf, 0.0], type_)
    assert both.unpack(data=values.tobytes())["depth"] == values.tolist()
    assert both.pack(depth=values.tolist())["data"] == values.tobytes()
    with pytest.raises(rj.DecodeError) as error:
        both.unpack(data=values.tobytes()[:-1])
    assert error.value.kind == "range"


TYPES = [
    ("int8", "i1", "int32"),
    ("uint16", "<u2", "uint32"),
    ("int32", "<i4", "int32"),
    ("uint64", "<u8", "uint64"),
    ("float64", "<f8", "double"),
]


@pytest.mark.parametrize(("name", "dtype", "field"), TYPES)
def test_every_type_of_numbers(name, dtype, field):
    both = pair('("data" :blob)', f"repeated {field} values = 1;", f"rules:\n  .values <-> numbers(.data, {name})\n")
    values = np.array([0, 1, 100, 17], dtype)
    assert both.unpack(data=values.tobytes())["values"] == values.tolist()
    assert both.pack(values=values.tolist())["data"] == values.tobytes()


@pytest.mark.parametrize("backend", ALL)
def test_the_order_of_bytes_may_depend_on_a_field(backend):
    unpack = "unpack-rules:\n  .depth = numbers(.data, uint16, .big != 0)\n"
    rules = f"{unpack}pack-rules:\n  .big = 1\n  .data = number_bytes(.depth, uint16, true)\n"
    both = pair('("big" :int) ("data" :blob)', "repeated uint32 depth = 1;", rules, backend)
    assert both.unpack(big=0, data=bytes([1, 0, 2, 0]))["depth"] == [1, 2]
    assert both.unpack(big=1, data=bytes([1, 0, 2, 0]))["depth"] == [256, 512]
    assert both.pack(depth=[1, 515])["data"] == bytes([0, 1, 2, 3])


@pytest.mark.parametrize("backend", ALL)
def test_millimetres_in_16_bits_as_metres_in_32(backend):
    rules = "rules:\n  .data <-> number_bytes(numbers(.data, uint16) * 0.001, float32)\n"
    both = pair('("data" :blob)', "required bytes data = 1;", rules, backend)
    depth = np.array([0, 1, 999, 65535], "<u2")
    metres = (depth * 0.001).astype("<f4")
    assert both.unpack(data=depth.tobytes())["data"] == metres.tobytes()
    assert both.pack(data=metres.tobytes())["data"] == depth.tobytes()
    assert both.refused(data=np.array([65.6], "<f4").tobytes()).kind == "range"


@pytest.mark.parametrize("backend", ALL)
def test_each_number_is_computed_with(backend):
    both = pair('("data" :blob)', "repeated double depth = 1;", "rules:\n  .depth[] <-> numbers(.data, uint16) * 0.5 + 1\n", backend)
    assert both.unpack(data=bytes([3, 0, 0, 1]))["depth"] == [2.5, 129.0]
    assert both.pack(depth=[2.5, 129.0])["data"] == bytes([3, 0, 0, 1])


@pytest.mark.parametrize("backend", ALL)
def test_padded_rows_of_numbers_and_their_channels(backend):
    rules = "rules:\n  .w <-> .w\n  .values <-> planar(numbers(rows(.data, 2, .w * 4, .w * 4 + 3), uint16), 2)\n"
    both = pair('("w" :int) ("data" :blob)', "required int32 w = 1; repeated uint32 values = 2;", rules, backend)
    pixels = np.arange(12, dtype="<u2").reshape(2, 6)
    data = b"".join(row.tobytes() + bytes(3) for row in pixels)
    assert both.unpack(w=3, data=data)["values"] == pixels.reshape(-1, 2).T.ravel().tolist()
    assert both.pack(w=3, values=pixels.reshape(-1, 2).T.ravel().tolist())["data"] == data


@pytest.mark.parametrize("backend", ALL)
def test_covariances_as_their_upper_triangle(backend):
    wire = '("covariance" (:list :double (:length 36)))'
    both = pair(wire, "repeated double upper = 1;", "rules:\n  .upper <-> upper_triangle(.covariance, 6)\n", backend)
    full = np.arange(36.0).reshape(6, 6)
    full = full + full.T
    assert both.unpack(covariance=full.ravel().tolist())["upper"] == full[np.triu_indices(6)].tolist()
    assert both.pack(upper=full[np.triu_indices(6)].tolist())["covariance"] == full.ravel().tolist()
    assert both.refused(upper=[0.0] * 20).kind == "rejected"


def test_a_triangle_as_its_square():
    both = pair('("upper" (:list :double))', "repeated double full = 1;", "rules:\n  .full <-> symmetric(.upper, 2)\n")
    assert both.unpack(upper=[1.0, 2.0, 3.0])["full"] == [1.0, 2.0, 2.0, 3.0]
    assert both.pack(full=[1.0, 2.0, 5.0, 3.0])["upper"] == [1.0, 2.0, 3.0]


def test_what_is_wrong():
    def found(wire, rule):
        return codes(wire, "repeated double a = 1;", f"unpack-rules:\n  {rule}\n")

    assert found('("data" :blob)', ".a = numbers(.data, float16)") == ["number-type"]
    assert found('("data" :blob)', ".a = numbers(reversed(.data), float32)") == ["number-bytes"]
    assert found('("data" :blob)', ".a = reversed(number_bytes(.data, int8))") == ["number-bytes"]
    assert found('("n" :int) ("data" :blob)', ".a = upper_triangle(.data, .n)\n  ignore .n") == ["layout-size"]
    assert found('("data" (:list :double))', ".a = numbers(.data, float32)") == ["no-bytes"]


LAWS = {
    ".us <-> numbers(.data, uint16)": ("exact", "exact"),
    ".us <-> numbers(.data, uint16, true)": ("exact", "exact"),
    ".ds <-> numbers(.data, float64)": ("exact", "exact"),
    ".ds[] <-> numbers(.data, uint16) * 0.001": ("exact", "it is rounded to a whole number"),
    ".fs[] <-> float32(numbers(.data, uint16) * 0.001)": ("exact", "it is rounded to a whole number"),
    ".fs[] <-> float32(numbers(.data, uint32) * 0.001)": ("large integers are rounded to a float", "it is rounded to a whole number"),
    ".raw <-> number_bytes(numbers(.data, uint16) * 0.001, float32)": ("exact", "it is rounded to a whole number"),
}


@pytest.mark.parametrize("rule", LAWS)
def test_laws_say_what_becomes_of_numbers_within_bytes(rule):
    field = {
        "us": "repeated uint32 us = 1;",
        "ds": "repeated double ds = 1;",
        "fs": "repeated float fs = 1;",
        "ra": "required bytes raw = 1;",
    }
    made = pair('("data" :blob)', field[rule[1:3]], f"rules:\n  {rule}\n").decode.mapping.laws
    assert tuple(each.losses[0].why if each.losses else each.kind for each in (made.messages, made.holders)) == LAWS[rule]


def test_all_millimetres_come_back():
    both = pair('("data" :blob)', "repeated float m = 1;", "rules:\n  .m[] <-> float32(numbers(.data, uint16) * 0.001)\n", "llvm")
    message = {"data": np.arange(1 << 16, dtype="<u2").tobytes()}
    assert both.pack(**both.unpack(**message)) == message
