"""Packed and bare structs, typed blobs, and unions: what the wire has for them, and where they are refused."""

from __future__ import annotations

import struct

import pytest

import rosetta_jit as rj
from rosetta_jit.errors import SchemaError

UNION = '("v" (:union ("i" :int) ("d" :double) ("s" :string) ("list" (:list :int)) ("pair" (:bottle ("a" :int) ("b" :string)))))'


def programs(body, backend="interpreter", encoding="yarp4"):
    options = {"schema": {"t.bottle-schema": f'"t.T"\n( {body} )'}, "encoding": encoding, "backend": backend}
    return rj.Decoder.of("t.T", **options), rj.Encoder.of("t.T", **options)


def check(body, values, data, backend="interpreter"):
    decode, encode = programs(body, backend)
    holder = encode.new()
    for name, value in values.items():
        setattr(holder, name, value)
    assert encode(holder) == data
    assert encode(decode(data)) == data


def test_packed_fields_have_no_codes():
    body = ':packed ("a" :int8) ("b" :double (:padding 5)) ("s" :string) ("xs" (:list :int16)) ("p" (:bottle :packed ("c" :uint8)))'
    data = struct.pack("<bd5xi2sii2hB", 1, 2.5, 2, b"hi", 256 | 64, 2, 3, 4, 200)
    check(body, {"a": 1, "b": 2.5, "s": "hi", "xs": [3, 4], "p": {"c": 200}}, data)


def test_any_padding_is_read():
    decode, _ = programs(':packed ("a" :int8 (:padding 3))')
    assert decode(b"\5abc").a == 5


def test_a_bare_struct_has_a_code_and_a_count():
    check(':bare ("a" :int8) ("s" :string)', {"a": 1, "s": "x"}, struct.pack("<iibi1s", 256, 2, 1, 1, b"x"))


def test_a_typed_blob():
    body = '("n" :int) ("head" (:blob (:bottle :packed ("a" :int16) ("b" :double))))'
    check(body, {"n": 7, "head": {"a": 1, "b": 2.0}}, struct.pack("<6ihd", 256, 2, 1, 7, 12, 10, 1, 2.0))


def test_typed_blobs_are_blobs_like_others():
    head = '("head" (:blob (:bottle :packed ("a" :int16))))'
    check(f'("b" :blob) {head}', {"b": b"x", "head": {"a": 1}}, struct.pack("<3i1sih", 256 | 12, 2, 1, b"x", 2, 1))
    check(f':packed {head} ("n" :int8)', {"head": {"a": 1}, "n": 2}, struct.pack("<ihb", 2, 1, 2))
    union = f'("n" :int) ("v" (:union ("i" :int) {head}))'
    check(union, {"n": 7, "v": {"head": {"a": 1}}}, struct.pack("<6ih", 256, 2, 1, 7, 12, 2, 1))


def test_what_came_later_is_empty_before():
    body = '("n" :int) ("new" (:list :int) (:since :yarp4)) ("v" (:union ("i" :int) ("s" :string)))'
    decode, encode = programs(body, encoding="yarp3")
    data = struct.pack("<4i", 257, 2, 7, 5)
    assert decode(data).to_dict()["new"] == []
    assert encode(decode(data)) == data
    newer = decode(data)
    newer.new = [1, 2]
    assert programs(body)[0](programs(body)[1](newer)).to_dict()["new"] == [1, 2]


def test_spread_elements_are_counted_one_by_one():
    body = '("n" :int) ("points" (:list (:bottle ("x" :int) ("y" :int))) :rest :spread)'
    decode, encode = programs(body)
    data = struct.pack("<2i5i", 257, 5, 9, 1, 2, 3, 4)  # all of one type, so that it is told once
    assert decode(data).to_dict() == {"n": 9, "points": [{"x": 1, "y": 2}, {"x": 3, "y": 4}]}
    assert encode(decode(data)) == data
    with pytest.raises(rj.DecodeError, match="1 more than a multiple of 2"):
        decode(struct.pack("<2i4i", 257, 4, 9, 1, 2, 3))


CASES = [
    ({"i": 5}, struct.pack("<4i", 257, 2, 7, 5)),  # the case makes all elements of one type
    ({"d": 0.5}, struct.pack("<5id", 256, 2, 1, 7, 20, 0.5)),
    ({"s": "ab"}, struct.pack("<6i2s", 256, 2, 1, 7, 4, 2, b"ab")),
    ({"list": [1, 2]}, struct.pack("<8i", 256, 2, 1, 7, 257, 2, 1, 2)),
    ({"pair": {"a": 3, "b": "c"}}, struct.pack("<10i1s", 256, 2, 1, 7, 256, 2, 1, 3, 4, 1, b"c")),
]


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_the_code_of_an_element_tells_the_case(backend):
    for case, data in CASES:
        check(f'("n" :int) {UNION}', {"n": 7, "v": case}, data, backend)


def test_a_specialised_case_is_read_from_either_form():
    decode, _ = programs(f'("n" :int) {UNION}')
    assert decode(struct.pack("<6i", 256, 2, 1, 7, 1, 5)).v.i == 5
    with pytest.raises(rj.DecodeError, match=r"tag|constant"):
        decode(struct.pack("<5iq", 256, 2, 1, 7, 17, 5))


def test_a_union_alone():
    for case, data in [({"i": 5}, struct.pack("<3i", 257, 1, 5)), ({"s": "ab"}, struct.pack("<3i2s", 260, 1, 2, b"ab"))]:
        check(UNION, {"v": case}, data)


def test_a_dict_of_anything():
    body = '("n" :int) ("x" (:dict (:union ("i" :int) ("s" :string))))'
    entry = struct.pack("<iii1si1s", 260, 2, 1, b"k", 1, b"v") + struct.pack("<iiii1sii", 256, 2, 4, 1, b"m", 1, 5)
    data = struct.pack("<4iiii", 256, 2, 1, 7, 768, 256, 2) + entry
    decode, encode = programs(body)
    holder = decode(data)
    assert (holder.x["k"].s, holder.x["m"].i) == ("v", 5)
    assert encode(holder) == data


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ('("p" (:bottle :packed ("a" :int)))', "packed-element"),
        ('("b" (:blob (:bottle ("s" :string))))', "blob-of-any-size"),
        (f'{UNION} ("n" :int)', "misplaced-union"),
        (f'("x" (:list (:bottle {UNION}))) ("y" (:list (:union ("i" :int))))', "misplaced-union"),
        (f'("n" :int) ("u" (:union ("b" (:bottle {UNION}))))', "misplaced-union"),
        ('("n" :int) ("u" (:union ("a" :vocab) ("b" :bool)))', "like-cases"),
        (':packed ("u" (:union ("a" :int)))', "misplaced-union"),
        ('("n" :int) ("xs" (:list :int) :rest :spread)', "not-spread"),
        ('("n" :int) ("xs" (:list (:bottle ("y" (:list :int) :rest))) :rest :spread)', "not-spread"),
    ],
)
def test_what_has_no_bytes(body, words):
    with pytest.raises(SchemaError, match=rf"\[{words}\]"):
        programs(body)


def test_an_element_by_a_difference_that_may_be_anything():
    """An element lies at its number times a step, which the message tells: codes stand before each of them, or once."""
    schema = {
        "s.bottle-schema": '"s.S" (("xs" (:list :double)) ("t" :string) ("i" :int64) ("j" :int16) ("b" :bool))',
        "d.idl": "struct Dst { double v; };",
        "m.mapping": 'import "s.bottle-schema"\nimport "d.idl"\ndata-holder: Dst\nwire-schema: s.S\n'
        "unpack-rules:\n.v = .xs[integer(.t) - (.i if .b else .j)]\n",
    }
    decode = rj.Decoder("m.mapping", encoding="yarp4", schema=schema)
    encode = rj.Encoder.of("s.S", encoding="yarp4", schema=schema, imports=["s.bottle-schema"])
    values = {"xs": [0.5, 1.5, 2.5], "t": "9", "i": 7, "j": 9, "b": True}
    assert decode(encode(values)).v == 2.5
    assert decode(encode({**values, "b": False})).v == 0.5
    for wrong in ({"xs": []}, {"i": -(1 << 62)}, {"i": 10}):
        with pytest.raises(rj.DecodeError) as found:
            decode(encode({**values, **wrong}))
        assert found.value.path.startswith(".xs[")


@pytest.mark.parametrize("backend", ["interpreter", "python", "llvm"])
@pytest.mark.parametrize("encoding", ["yarp3", "yarp"])
def test_a_bottle_of_one_length_is_known_by_it(encoding, backend):
    """What is longer or shorter is left to the general form, which says what is wrong, and where."""
    schema = {"t.bottle-schema": '"t.T"\n( ("a" :double) ("b" :double) )'}
    decode = rj.Decoder.of("t.T", schema=schema, encoding=encoding, backend=backend)
    assert "body 0:\n  expect ((begin + 24) == end)" in decode.stage("kernel")
    usual, other = struct.pack("<iidd", 256 | 10, 2, 1.5, -2.0), struct.pack("<iiidid", 256, 2, 10, 1.5, 10, -2.0)
    assert decode(usual).to_dict() == decode(other).to_dict() == {"a": 1.5, "b": -2.0}
    where = {0: "byte 0", 4: "byte 4", 8: "`.a`, byte 8", 16: "`.b`, byte 16"}
    for cut in range(len(usual)):
        place = where[max(each for each in where if each <= cut)]
        with pytest.raises(rj.DecodeError, match=f"^truncated: .*{place}$"):
            decode(usual[:cut])
    with pytest.raises(rj.DecodeError, match=r"^trailing: .* at byte 24"):
        decode(usual + b"\0")
    assert decode(usual).b == -2.0


def test_a_form_that_is_the_only_one_says_itself_what_is_wrong():
    decode, _ = programs(':packed ("a" :double) ("b" :double)')
    assert "body 1" not in decode.stage("kernel")
    with pytest.raises(rj.DecodeError, match=r"^truncated: .*`.b`, byte 8"):
        decode(bytes(8))


NARROW = 'syntax = "proto3"; package t; message Narrow { int32 a = 1; int32 b = 2; }'
NARROWED = """
import "t.bottle-schema"
import "narrow.proto"

data-holder: t.Narrow
wire-schema: t.T

unpack-rules:
  .a = int32(.a)
  .b = int32(.b)
"""


@pytest.mark.parametrize("backend", ["interpreter", "python", "llvm"])
def test_a_rule_that_fails_in_the_usual_form_says_so(backend):
    """The general form does not read again what the usual one has: nothing would be told there."""
    schema = {"t.bottle-schema": '"t.T"\n( ("a" :double) ("b" :double) )', "narrow.proto": NARROW, "t.mapping": NARROWED}
    decode = rj.Decoder("t.mapping", schema=schema, encoding="yarp3", backend=backend)
    forms = (struct.pack("<iidd", 256 | 10, 2, 1, 1e300), struct.pack("<iiidid", 256, 2, 10, 1, 10, 1e300))
    told = []
    for data in forms:
        with pytest.raises(rj.DecodeError, match=r"^range: ") as found:
            decode(data)
        told.append(found.value.path)
    assert told == [".b", ".b"]


@pytest.mark.parametrize("backend", ["interpreter", "python", "llvm"])
@pytest.mark.parametrize("encoding", ["yarp3", "yarp"])
def test_a_list_of_any_length_is_read_in_both_forms(encoding, backend):
    schema = {"t.bottle-schema": '"t.T"\n( ("xs" (:list :double) :rest) )'}
    decode = rj.Decoder.of("t.T", schema=schema, encoding=encoding, backend=backend)
    usual, other = struct.pack("<iidd", 256 | 10, 2, 1.5, -2.0), struct.pack("<iiidid", 256, 2, 10, 1.5, 10, -2.0)
    for data in (usual, other):
        assert list(decode(data).xs) == [1.5, -2.0]
        for cut in range(len(data)):
            with pytest.raises(rj.DecodeError, match=r"^truncated: "):
                decode(data[:cut])
        with pytest.raises(rj.DecodeError, match=rf"^trailing: .* at byte {len(data)}"):
            decode(data + b"\0")
    with pytest.raises(rj.DecodeError, match=r"^tag: must be"):
        decode(struct.pack("<ii", 5, 0))
