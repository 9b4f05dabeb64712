"""Types of LCM in generated Python: those that contain themselves, and arrays of arrays."""

from __future__ import annotations

import struct
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import NO_WISHES, Wishes
from tests.generate.driver import harmed
from tests.generate.python import BOTH, answers_as_the_library, module, source_of

ARRAYS = (NO_WISHES, Wishes(numpy=True))


def lcm(body: str) -> dict[str, Any]:
    return {"encoding": "lcm", "schema": {"t/m.lcm": f"package t; {body}"}}


def text_of(given: dict[str, Any], wishes: Wishes = NO_WISHES) -> str:
    return source_of(type_request("decode", "t.m", given), BOTH, wishes)


def compare(given: dict[str, Any], *values: dict[str, Any]) -> None:
    decode, encode = rj.Decoder.of("t.m", **given), rj.Encoder.of("t.m", **given)
    messages = [bytes(encode(encode.holder_type.from_dict(each))) for each in values]
    for wishes in ARRAYS:
        unit = module(type_request("decode", "t.m", given), BOTH, wishes)
        answers_as_the_library(unit, (decode, encode), harmed(messages, 60, "lcm"))


TREE = """
    struct m { int32_t n; string name; m kids[n]; double place[3]; int16_t k; o others[k]; leaf own; }
    struct o { int8_t n; float numbers[n]; boolean flags[n]; leaf leaves[n]; byte raw[n]; m back[n]; }
    struct leaf { int32_t n; string text; int64_t numbers[n]; int8_t last; }
"""
LEAF = {"n": 2, "text": "é", "numbers": [-1, 2], "last": -3}
NODE = {"n": 0, "name": "leaf", "place": [1.5, -0.5, 0.0], "k": 0, "own": LEAF}
OTHER = {"n": 1, "numbers": [0.5], "flags": [True], "leaves": [LEAF], "raw": b"x", "back": [NODE]}
INNER = {**NODE, "n": 2, "kids": [NODE, {**NODE, "name": ""}], "k": 2, "others": [OTHER, {"n": 0}]}


def test_messages_that_contain_their_own_type_are_read_and_written_by_functions():
    """As lists, of more than one type, with fields behind, and with texts, arrays and lists of structs."""
    given = lcm(TREE)
    for wishes in ARRAYS:
        text = text_of(given, wishes)
        assert "def _read_kids(" in text
        assert "def _encoded_kids(" in text
        assert "state" not in text.partition("class m")[2]
    compare(given, INNER, NODE, {**INNER, "n": 1, "kids": [INNER]})


@pytest.mark.parametrize("number", [-1, 1, 3, 1 << 20, (1 << 31) - 1, -(1 << 31)])
def test_counts_that_cannot_be(number):
    """What is checked of a count is checked where it is not 0, in the same order: of those that other numbers lie before, too."""
    given = lcm("struct m { int32_t n; string name; m kids[n]; int32_t k; m others[k]; m more[n]; double last; }")
    assert "        if count_2 < 0:" in text_of(given)
    decode, encode = rj.Decoder.of("t.m", **given), rj.Encoder.of("t.m", **given)
    leaf = {"name": "leaf", "last": 0.5}
    inner = {**leaf, "n": 1, "kids": [leaf], "more": [leaf], "k": 1, "others": [leaf]}
    message = bytes(encode(encode.holder_type.from_dict({**inner, "kids": [inner]})))
    put = struct.pack(">i", number)
    answers_as_the_library(
        module(type_request("decode", "t.m", given)),
        (decode, encode),
        [message[:at] + put + message[at + 4 :] for at in range(8, len(message))],
    )


def nested(depth: int) -> bytes:
    return struct.pack(">ii", 1, 1) * depth + struct.pack(">ii", 1, 0)


def test_how_deep_they_are():
    """More than 64 within each other are refused, when they are written too; an object that contains itself is no exception."""
    given = lcm("struct m { int32_t v; int32_t n; m kids[n]; }")
    decode, encode = rj.Decoder.of("t.m", **given), rj.Encoder.of("t.m", **given)
    unit = module(type_request("decode", "t.m", given))
    first = bytes(encode(encode.holder_type.from_dict({"v": 1})))[:8]
    answers_as_the_library(unit, (decode, encode), [first + nested(depth) for depth in (0, 1, 63, 64, 65, 66, 200)])
    itself = unit.m(n=1)
    itself.kids = [itself]
    for depth, kind in ((64, None), (65, "nesting")):
        target = unit.m(v=1)
        for _ in range(depth):
            target = unit.m(v=1, n=1, kids=[target])
        if kind is None:
            assert unit.encode(target) == first + nested(depth)
        else:
            for each in (target, itself):
                with pytest.raises(unit.EncodeError, match="nesting") as caught:
                    unit.encode(each)
                assert (caught.value.kind, caught.value.path) == (kind, ".kids[].kids")


def test_what_cannot_be_written():
    unit = module(type_request("decode", "t.m", lcm("struct m { int32_t v; int32_t n; m kids[n]; }")))
    for target, kind, path in (
        (unit.m(n=1), "count", ".kids"),
        (unit.m(n=1, kids=[unit.m(n=1)]), "count", ".kids[].kids"),
        (unit.m(n=1, kids=[unit.m(v=1 << 31)]), "range", ""),
        (unit.m(n=1, kids=[7]), "range", ""),
        (unit.m(n=1, kids=7), "range", ""),
    ):
        with pytest.raises(unit.EncodeError) as caught:
            unit.encode(target)
        assert (caught.value.kind, caught.value.path) == (kind, path)


def test_messages_ask_for_no_more_rows_than_their_size_allows():
    """Structs of no fields take no bytes: their number is bounded for all messages within each other together."""
    given = lcm("struct none { } struct m { int32_t n; none many[n]; int32_t k; m kids[k]; }")
    decode, encode = rj.Decoder.of("t.m", **given), rj.Encoder.of("t.m", **given)
    first = bytes(encode(encode.holder_type.from_dict({})))[:8]
    kids = [first + struct.pack(">ii", 0, 3) + struct.pack(">ii", each, 0) * 3 for each in (1000, 300_000, 500_000)]
    answers_as_the_library(module(type_request("decode", "t.m", given)), (decode, encode), kids)


def test_arrays_of_several_dimensions():
    """They are written from the object, whatever of their dimensions is fixed."""
    given = lcm("""
        struct m { int32_t n; byte a[n][8]; double b[2][2][3]; int8_t c[2][3]; byte d[2][3]; float e[3][n];
            string f[n][2]; boolean g[2][2]; p h[3]; }
        struct p { double x, y; }
    """)
    values = {
        "n": 2,
        "a": [b"abcdefgh", bytes(8)],
        "b": [[[1.0, 2.0, 3.0]] * 2, [[-1.0, 0.5, 0.0]] * 2],
        "c": [[-1, 2, 3], [4, 5, -6]],
        "d": [b"abc", b"def"],
        "e": [[1.0, 2.0]] * 3,
        "f": [["a", "é"], ["", "b"]],
        "g": [[True, False], [False, True]],
        "h": [{"x": 1.0, "y": 2.0}] * 3,
    }
    for wishes in ARRAYS:
        assert "_size_1" not in text_of(given, wishes)
    compare(given, values, {**values, "n": 0, "a": [], "e": [[]] * 3, "f": []})


@pytest.mark.parametrize("name", ["b", "q", "d", "used", "room", "b_lane"])
def test_arrays_are_called_otherwise_than_what_generated_source_has_beside_others(name):
    """A lane `u_b`, of the field `b` of elements of `u`, and the view of `u` as numbers of one byte."""
    body = f"struct s {{ int32_t n; string a; double {name}[n]; int8_t c; s2 more[n]; }} struct s2 {{ int16_t v; double {name}[2][2]; }}"
    given = lcm(f"{body} struct m {{ int32_t n; s u[n]; }}")
    more = {"v": -2, name: [[1.0, 2.0], [3.0, 4.0]]}
    element = {"n": 1, "a": "x", name: [1.5], "c": -3, "more": [more]}
    compare(given, {"n": 2, "u": [element, element]})


def test_an_array_without_numbers_is_a_new_one():
    given = lcm("struct m { int32_t n; double a[n]; int16_t b[n]; byte c[n]; }")
    compare(given, {"n": 0}, {"n": 1, "a": [0.5], "b": [-1], "c": b"x"})
    unit = module(type_request("decode", "t.m", given), BOTH, Wishes(numpy=True))
    first, second = (unit.decode(unit.encode(unit.m())) for _ in range(2))
    for one, other, type_ in ((first.a, second.a, np.float64), (first.b, second.b, np.int16)):
        assert one is not other
        assert (one.dtype, one.shape, one.flags.writeable, one.flags.owndata) == (type_, (0,), True, True)
        one.resize(2, refcheck=False)
    assert second == unit.m()


def test_arrays_of_arrays_whose_lengths_are_fields_are_read_at_once():
    """Short rows and long ones, none, rows that are no numbers; a length that is negative, or too much, is an error at its row."""
    given = lcm(
        "struct m { int32_t n; int32_t k; int32_t a[n][k]; int8_t b[n][k]; double c[2][n][k]; boolean d[n][k]; string e[n][k]; s f[n]; }"
        " struct s { int32_t i; float g[i][i]; }"
    )
    text = text_of(given)
    assert text.count("map(list, _unpack_each(") == 4
    assert text_of(given, Wishes(numpy=True)).count(".reshape(-1, m_k)") == 3
    values: list[dict[str, Any]] = []
    for n, k in ((0, 0), (0, 3), (1, 1), (5, 2), (2, 0), (4, 120)):
        inner = {"i": k % 100, "g": [[row + column / 2 for column in range(k % 100)] for row in range(k % 100)]}
        values.append(
            {
                "n": n,
                "k": k,
                "a": [[row - column for column in range(k)] for row in range(n)],
                "b": [[row - column for column in range(k)] for row in range(n)],
                "c": [[[row / 3 for _ in range(k)] for row in range(n)] for _ in range(2)],
                "d": [[row == column for column in range(k)] for row in range(n)],
                "e": [["x" * column for column in range(k)] for _ in range(n)],
                "f": [inner] * n,
            }
        )
    compare(given, *values)
    decode, encode = rj.Decoder.of("t.m", **given), rj.Encoder.of("t.m", **given)
    unit = module(type_request("decode", "t.m", given))
    good = bytes(encode(encode.holder_type.from_dict(values[3])))
    found = unit.decode(good)
    assert (found.a, found.b, found.c) == (values[3]["a"], values[3]["b"], values[3]["c"])
    lengths = [good[:8] + struct.pack(">ii", n, k) + good[16:] for n in (-1, 0, 3, 65536, 65537) for k in (-1, 0, 1, 3, 99, 100, 2**31 - 1)]
    answers_as_the_library(unit, (decode, encode), [*lengths, *(good[:end] for end in range(len(good)))])


@pytest.mark.parametrize("wishes", ARRAYS)
def test_numbers_of_elements_are_checked_where_they_are_written(wishes):
    """What counts elements is compared with their number, and packed: numbers that do not fit, and what is no integer, are refused."""
    given = lcm("struct m { int32_t n; double numbers[n]; int8_t few; string texts[few][2]; int16_t last; }")
    unit, text = module(type_request("decode", "t.m", given), BOTH, wishes), text_of(given, wishes)
    assert "= target.n\n" in text
    assert "= target.few\n" in text
    good = unit.m(n=1, numbers=[0.5], few=1, texts=[["a", "b"]], last=3)
    assert unit.decode(unit.encode(good)) == good
    assert unit.encode(replace(good, few=True)) == unit.encode(good)
    for name, value, kind in (
        ("n", 2, "count"),
        ("n", 1.0, "range"),
        ("n", "1", "count"),
        ("few", 1 << 40, "count"),
        ("last", 1 << 15, "range"),
    ):
        with pytest.raises(unit.EncodeError) as caught:
            unit.encode(replace(good, **{name: value}))
        assert caught.value.kind == kind


@pytest.mark.parametrize(
    "array",
    ["a[n][k]", "a[n][3]", "a[n][2][k]", "a[n][n][3]", "a[2][n][k]", "a[n][k][k]", "a[n][2][2][k]", "a[n][k][n][2]"],
)
def test_bytes_of_one_size_are_taken_by_one_call(array):
    """Where there are some, none of which is empty: else, and where the message ends too early, a loop finds what there is."""
    given = lcm(f"struct m {{ int32_t n; int32_t k; byte {array}; int8_t last; }}")
    if array != "a[n][2][2][k]":  # two rows at a time are few
        assert "_pieces(" in text_of(given) or "map(list, _unpack_each(" in text_of(given)
    decode, encode = rj.Decoder.of("t.m", **given), rj.Encoder.of("t.m", **given)
    unit, messages = module(type_request("decode", "t.m", given)), list[bytes]()
    for n, k in ((0, 0), (1, 1), (3, 2), (4, 0), (4, 1), (5, 3), (9, 4), (170, 2)):
        sizes = [{"n": n, "k": k}.get(each) or int(each.strip("nk") or 0) for each in array[2:-1].split("][")]
        value = bytes(range(sizes[-1]))
        for size in reversed(sizes[:-1]):
            value = [value] * size
        messages.append(unit.encode(unit.m(n=n, k=k, a=value, last=7)))
    for number, at in product((-1, 5, 1 << 20), (8, 12)):
        messages += [each[:at] + struct.pack(">i", number) + each[at + 4 :] for each in messages[:7]]
    answers_as_the_library(unit, (decode, encode), harmed(messages[:8], 20, array) + messages)


LARGE = """
    struct m { int32_t n; r one; boolean flags[3][n]; r two; double numbers[n][3]; r three[3]; }
    struct r { int32_t n; string names[3][n]; boolean bits[9]; int32_t nine[9]; string last; float rows[n][3]; string others[3][n]; }
"""
ROW = {"n": 1, "names": 3 * [["é"]], "bits": 9 * [True], "nine": [*range(9)], "last": "", "rows": [3 * [0.5]], "others": 3 * [["x"]]}


def test_large_types_are_read_into_lists_and_written_in_parts():
    """Of these passes run but once, and leave conditions around loops that only say that there are rounds."""
    given = lcm(LARGE)
    text = text_of(given)
    assert "_SIZE_SITES" not in text
    assert "bytearray(" not in text.partition("def _borrow_1")[2]
    empty = {**ROW, "n": 0, "names": [[], [], []], "rows": [], "others": [[], [], []]}
    compare(given, {"one": ROW, "flags": [[], [], []], "three": 3 * [empty]}, {"n": 1, "flags": 3 * [[True]], "numbers": [3 * [1.5]]})


def test_few_structs_in_arrays_are_made_by_a_loop():
    """Those of arrays of a constant length, too: of structs with an array, with bytes, with a bool."""
    given = lcm(
        "struct m { int32_t n; a ones[3]; b rows[n][2]; c flags[3]; } struct a { int8_t x[9]; int16_t y[2]; } "
        "struct b { byte raw[4]; } struct c { boolean flag; }"
    )
    assert "bytearray(" not in text_of(given).partition("def _borrow_1")[2]
    one = {"x": [*range(9)], "y": [-1, 2]}
    compare(given, {"n": 1, "ones": 3 * [one], "rows": [2 * [{"raw": b"abcd"}]], "flags": 3 * [{"flag": True}]}, {"ones": 3 * [one]})


def test_fields_that_are_called_as_their_class_have_a_first_value():
    unit = module(type_request("decode", "t.m", lcm("struct m { k k; k j; } struct k { int8_t n; }")))
    assert unit.decode(unit.encode(unit.m())) == unit.m(unit.k(0), unit.k(0))
