"""Bottles without a schema: what the real YARP wrote is read and written back, what it should have refused is refused."""

from __future__ import annotations

import json
import struct
from functools import reduce
from operator import or_
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosetta_jit.errors import DecodeError, EncodeError
from rosetta_jit.frameworks.yarp.bottle import read, write
from rosetta_jit.frameworks.yarp.drafting.infer import read_any
from rosetta_jit.frameworks.yarp.limits import MAX_NESTING
from rosetta_jit.frameworks.yarp.tags import DIALECTS, YARP3, YARP4, YARP2012
from rosetta_jit.frameworks.yarp.text import to_text
from rosetta_jit.frameworks.yarp.tree import Dict, List, Value, narrow, specialised, widen

VECTORS = Path(__file__).parents[2] / "vectors" / "yarp"


def vectors(name, *, bottles=True):
    entries = json.loads((VECTORS / f"{name}.json").read_text())
    return [pytest.param(entry, id=entry["name"]) for entry in entries if not bottles or entry.get("tree") is not None]


def plain(item, dialect):
    """An item as the vectors note it."""
    match item:
        case Value("int64" | "vocab64" as tag, number):
            return [tag, str(number)]
        case Value("float32", number):
            return ["float32", narrow(number)[::-1].hex()]
        case Value("float64", number):
            return ["float64", struct.pack(">d", number).hex()]
        case Value(tag, bytes(octets)):
            return [tag, octets.hex()]
        case Value(tag, number):
            return [tag, number]
        case List(items, unit):
            return ["list", 256 + (dialect.tags[unit] if unit else 0), [plain(inner, dialect) for inner in items]]
        case Dict(content):
            return ["dict", to_text(content).decode()]


def noted(entry):
    """The same of an item in a vector, without the forms that are there for people."""
    match entry:
        case ["list", code, items]:
            return ["list", code, [noted(inner) for inner in items]]
        case [("float32" | "float64") as tag, _, bits]:
            return [tag, bits]
        case [tag, value, *_]:
            return [tag, value]


def attempt(data, dialect):
    try:
        return read(data, dialect)
    except DecodeError as error:
        return error


def check_any(data, dialect):
    """Any bytes are refused with a place in them, or are a bottle that is written back."""
    bottle = attempt(data, dialect)
    assert bottle.offset <= len(data) if isinstance(bottle, DecodeError) else write(bottle, dialect) == data


def check_vector(entry, dialect):
    data = bytes.fromhex(entry["hex"])
    bottle = read(data, dialect)
    assert [plain(item, dialect) for item in bottle.items] == [noted(item) for item in entry["tree"]]
    assert write(bottle, dialect) == data
    assert plain(read_any(data)[1], dialect)[2] == plain(bottle, dialect)[2] or entry["name"] == "string_trailing_nul"


@pytest.mark.parametrize("entry", vectors("yarp3"))
def test_reads_and_writes_yarp3(entry):
    check_vector(entry, YARP3)


@pytest.mark.parametrize("entry", vectors("yarp4"))
def test_reads_and_writes_yarp4(entry):
    check_vector(entry, YARP4)


@pytest.mark.parametrize("entry", vectors("yarp2012", bottles=False))
def test_reads_and_writes_yarp2012(entry):
    data = bytes.fromhex(entry["hex"])
    bottle = read(data, YARP2012)
    assert to_text(bottle).decode() == entry["text"]
    assert write(bottle, YARP2012) == data
    assert read_any(data)[1] == bottle


@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_reads_what_thrift_writes(dialect):
    for entry in json.loads((VECTORS / f"thrift-{dialect}.json").read_text()):
        data = bytes.fromhex(entry["hex"])
        if entry["name"] == "struct_All":  # its set<i32> is not a valid bottle
            with pytest.raises(DecodeError):
                read(data, DIALECTS[dialect])
            continue
        bottle = read(data, DIALECTS[dialect])
        assert to_text(bottle).decode() == entry["text"]
        assert write(bottle, DIALECTS[dialect]) == data


SOUND = {
    "blob_len_zero_last",
    "elem_code_128",
    "vocab_spec_list_ok",
    "dict_elem",
    "vector_zero",
    "vector_wrong_tag_int",
    "vector_untyped_list",
}
"""Malformed cases that are valid bottles after all; those of images and matrices are wrong only in what they mean."""


@pytest.mark.parametrize("dialect", ["yarp3", "yarp4"])
def test_refuses_malformed_bottles(dialect):
    for entry in json.loads((VECTORS / f"malformed-{dialect}.json").read_text()):
        data = bytes.fromhex(entry["hex"])
        bottle = attempt(data, DIALECTS[dialect])
        if isinstance(bottle, DecodeError):
            assert 0 <= bottle.offset <= len(data), entry["name"]
            assert entry["name"] not in SOUND - {"elem_code_128"}
        else:
            assert write(bottle, DIALECTS[dialect]) == data
            assert entry["kind"] != "bottle" or entry["name"] in SOUND, entry["name"]
            assert "left" not in entry or (entry["left"] == 0 and to_text(bottle).decode() == entry["text"])


@pytest.mark.parametrize(
    ("octets", "kind", "path", "offset"),
    [
        ("", "truncated", "", 0),
        ("00010000", "truncated", "", 4),
        ("0001000001000000", "truncated", "", 8),
        ("000100000200000001000000050000000100000005", "truncated", "[1]", 20),
        ("0101000000000080", "count", "", 4),
        ("00010000ffffff7f", "truncated", "", 8),
        ("04010000ffffff7f", "truncated", "", 8),
        ("04010000010000000400000061", "truncated", "[0]", 12),
        ("0401000001000000ffffffff61", "length", "[0]", 8),
        ("000100000100000000010100000000000000", "tag", "[0]", 8),
        ("010000000100000001000000", "tag", "", 0),
        ("010100000100000001000000ff", "trailing", "", 12),
        ("0001000001000000000100000100000003000000ff00000000", "tag", "[0][0]", 16),
    ],
)
def test_says_what_is_wrong_and_where(octets, kind, path, offset):
    with pytest.raises(DecodeError) as caught:
        read(bytes.fromhex(octets), YARP3)
    assert (caught.value.kind, caught.value.path, caught.value.offset) == (kind, path, offset)


def test_a_string_of_2012_ends_with_a_nul():
    for octets, kind in (("0401000001000000 01000000 61", "constant"), ("0401000001000000 00000000", "length")):
        with pytest.raises(DecodeError) as caught:
            read(bytes.fromhex(octets), YARP2012)
        assert caught.value.kind == kind


def nested(depth):
    bottle = List((Value("int32", 1),), "int32")
    for _ in range(depth):
        bottle = List((bottle,))
    return bottle


def test_nesting_is_bounded_both_ways():
    assert read(write(nested(MAX_NESTING), YARP3), YARP3) == nested(MAX_NESTING)
    with pytest.raises(EncodeError, match="nesting"):
        write(nested(MAX_NESTING + 1), YARP3)
    deep = struct.pack("<ii", 256, 1) * 1_000_000 + struct.pack("<ii", 256, 0)
    with pytest.raises(DecodeError, match="nesting"):
        read(deep, YARP3)


@pytest.mark.parametrize("unit", [0, 1, 4, 12, 32])
def test_a_huge_count_allocates_nothing(unit):
    import tracemalloc

    data = struct.pack("<ii", 256 | unit, 2**31 - 1) + bytes(64)
    tracemalloc.start()
    with pytest.raises(DecodeError):
        read(data, YARP3)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 65536


def test_nan_payloads_survive():
    for bits in ("0100807f", "ffffbfff", "0000c07f"):
        data = bytes.fromhex("80010000010000" + "00" + bits)
        assert write(read(data, YARP3), YARP3) == data
    for bits in ("010000000000f07f", "ffffffffffffffff"):
        data = bytes.fromhex("0a01000001000000" + bits)
        assert write(read(data, YARP3), YARP3) == data


@given(st.integers(0, 2**32 - 1))
def test_widening_loses_no_bit(bits):
    assert narrow(widen(bits)) == struct.pack("<I", bits)


@pytest.mark.parametrize(
    "item",
    [
        Value("int8", 128),
        Value("int32", 1.5),
        Value("float32", 1e300),
        Value("vocab64", 1),
        Value("string", 5),
        Value("int32", b"abcd"),
        Value("list", 1),
    ],
)
def test_refuses_to_write_what_has_no_bytes(item):
    with pytest.raises(EncodeError):
        write(List((item,)), YARP3)


def test_refuses_to_write_a_foreign_item_into_a_specialised_list():
    with pytest.raises(EncodeError, match="specialised"):
        write(List((Value("int32", 1), Value("int8", 1)), "int32"), YARP3)


def test_codes_of_scalars_lie_in_the_masks_of_yarp():
    assert [reduce(or_, dialect.tags.values()) for dialect in (YARP3, YARP4)] == [0xFF, 0x7F]


def test_detects_dialects():
    assert read_any(write(specialised([Value("float64", 0.5), Value("int32", 1)]), YARP3))[0] is YARP3
    assert read_any(write(specialised([Value("float32", 0.5)] * 3), YARP4))[0] is YARP4
    assert read_any(write(specialised([Value("string", b"ab")]), YARP2012))[0] is YARP2012
    assert read_any(write(specialised([Value("int32", 5)]), YARP4))[0] is YARP3
    with pytest.raises(DecodeError):
        read_any(b"\0" * 64)


WIDTHS = {"int8": 8, "int16": 16, "int32": 32, "int64": 64, "vocab32": 32}
SCALARS = st.one_of(
    *[st.builds(Value, st.just(tag), st.integers(-(2 ** (n - 1)), 2 ** (n - 1) - 1)) for tag, n in WIDTHS.items()],
    st.builds(Value, st.just("float32"), st.floats(width=32, allow_nan=False)),
    st.builds(Value, st.just("float64"), st.floats(allow_nan=False)),
    st.builds(Value, st.sampled_from(["string", "blob"]), st.binary(max_size=9)),
)
LISTS = st.recursive(
    SCALARS,
    lambda items: st.one_of(
        st.lists(items, max_size=4).map(specialised),
        st.lists(items, max_size=4).map(lambda found: List(tuple(found))),
        st.lists(items, max_size=3).map(lambda found: Dict(specialised(found))),
    ),
    max_leaves=12,
)
BOTTLES = st.lists(LISTS, max_size=5).map(specialised)


@given(BOTTLES, st.sampled_from([YARP3, YARP4]))
def test_reading_inverts_writing(bottle, dialect):
    assert read(write(bottle, dialect), dialect) == bottle


@given(BOTTLES, st.data())
def test_broken_bytes_are_refused_or_written_back(bottle, data):
    octets = bytearray(write(bottle, YARP3))
    octets[data.draw(st.integers(0, len(octets) - 1))] = data.draw(st.integers(0, 255))
    for cut in (bytes(octets), bytes(octets[: data.draw(st.integers(0, len(octets)))])):
        check_any(cut, YARP3)


@given(st.binary(max_size=80))
def test_any_bytes_are_read_or_refused(data):
    for dialect in DIALECTS.values():
        check_any(data, dialect)
