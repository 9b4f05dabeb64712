"""The quick ways of generated Python with protobuf say what the library says."""

from __future__ import annotations

import re

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from tests.generate.driver import harmed
from tests.generate.python import answers_as_the_library, module, protobuf, source_of


def test_short_integers_are_read_without_a_call():
    """Tags and lengths of one byte, at the end of a message too; and texts of which one is not ASCII."""
    given = {
        "encoding": "protobuf",
        "schema": {"t.proto": 'syntax = "proto3"; package t; message M { repeated string v = 1; int64 n = 2; }'},
    }
    request = type_request("decode", "t.M", given)
    assert re.search(r"= data\[\w+\] if .*\w+ < end else 128\n", source_of(request, ("decode",)))
    unit, programs = module(request), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    values = [["", "a", "b" * 200], ["é", "", "x"], []]
    good = [bytes(programs[1](programs[1].holder_type.from_dict({"v": each, "n": -1}))) for each in values]
    answers_as_the_library(unit, programs, harmed([*good, b"\x0a", b"\x10", b"\x10\x80", b"\x8a\x00\x01a"], 12, "short"))
    assert [unit.decode(each).v for each in good] == values


def test_bools_behind_tags_are_one_of_two_texts():
    """Those of which each has its own tag, of one byte and of two."""
    given = protobuf("message M { repeated bool v = 1 [packed = false]; repeated bool far = 40 [packed = false]; int32 n = 2; }")
    request = type_request("decode", "t.M", given)
    assert r"[b'\xc0\x02\x01' if each else b'\xc0\x02\x00' for each in far" in source_of(request)
    unit, encode = module(request), rj.Encoder.of("t.M", **given)
    for values in ({"v": [True, False, True], "far": [False, True], "n": 3}, {"v": [], "far": [True]}, {}):
        assert unit.encode(unit.M(**values)) == bytes(encode(encode.holder_type.from_dict(values)))


@pytest.mark.parametrize("type_", [pytest.param("M", marks=pytest.mark.campaign), "Root"])
def test_messages_that_contain_their_own_type_are_written_by_functions(type_):
    """As one, as a list, in a oneof, in a map, in a message between, in a group of their own, and with fields of other lengths."""
    schema = """
        message M { string name = 1; sint32 n = 2; repeated M many = 3; M one = 4; oneof which { M first = 5; bool second = 6; }
            map<string, M> named = 7; repeated Between between = 300; repeated double numbers = 9; Other other = 10; }
        message Between { fixed32 id = 1; M inner = 2; repeated int32 ids = 3; }
        message Other { repeated Other others = 1; M back = 2; repeated bool flags = 3 [packed = false]; }
        message Root { M tree = 1; Other other = 2; int32 n = 3; }
    """
    leaf = {"name": "é" * 100, "n": -5, "numbers": [1.5] * 3}
    between = [{"id": 1, "inner": leaf, "ids": [300, -1]}, {"id": 2}]
    other = {"others": [{"flags": [True, False]}, {"back": {"n": 7}}], "back": leaf}
    tree = {"many": [leaf, {"one": leaf}, {"many": [leaf] * 9}], "one": {"one": {}}, "first": leaf, "between": between}
    values = [{**tree, "other": other, "named": {"a": leaf, "b": {"second": True}}}, leaf, {}]
    cases = values if type_ == "M" else [{"tree": each, "other": other, "n": 4} for each in values]
    request = type_request("decode", f"t.{type_}", protobuf(schema))
    text = source_of(request)
    assert "_encoded_" in text
    assert "_size_1" not in text
    programs = rj.Decoder.of(f"t.{type_}", **protobuf(schema)), rj.Encoder.of(f"t.{type_}", **protobuf(schema))
    messages = [bytes(programs[1](programs[1].holder_type.from_dict(each))) for each in cases]
    answers_as_the_library(module(request), programs, harmed(messages, 12, type_))


MUST_HAVE = {"schema": {"t.proto": 'syntax = "proto2"; package t; message M { required int32 n = 1; map<int32, M> named = 2; }'}}


@pytest.mark.parametrize(
    ("type_", "options"),
    [("google.protobuf.Struct", {}), ("google.protobuf.Value", {}), ("rst.generic.Dictionary", {}), ("t.M", MUST_HAVE)],
)
def test_messages_without_a_byte(type_, options):
    """They are objects of first values, and decoders that begin with much do not begin; but not where a message must have a field."""
    given, is_made_at_once = {"encoding": "protobuf", **options}, not options
    request = type_request("decode", type_, given)
    assert ("if not end:" in source_of(request)) == is_made_at_once
    unit, programs = module(request), (rj.Decoder.of(type_, **given), rj.Encoder.of(type_, **given))
    answers_as_the_library(unit, programs, [b"", b"\x12\x00", b"\x0a"])
    if is_made_at_once:
        assert unit.decode(b"") == unit.decode(unit.encode(unit.decode(b"")))
        assert unit.decode(b"") is not unit.decode(b"")


@pytest.mark.parametrize("type_", ["sint32", "sint64", "int32", "int64", "uint64"])
def test_integers_of_several_bytes(type_):
    """Packed and behind tags, of one byte to ten, cut off anywhere, and of more than ten."""
    given = protobuf(f"message M {{ repeated {type_} v = 1; repeated {type_} apart = 2 [packed = false]; {type_} one = 3; }}")
    request = type_request("decode", "t.M", given)
    assert "_several_bytes(" in source_of(request)
    unit, programs = module(request), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    most = 31 if type_.endswith("32") else 63
    numbers = [sign * (1 << bit) - less for bit in range(most) for sign in (1, -1) for less in (0, 1)]
    numbers = [each for each in numbers if each >= 0 or type_[0] != "u"]
    good = [
        bytes(programs[1](programs[1].holder_type.from_dict({"v": numbers, "apart": numbers[::-1], "one": each}))) for each in numbers[-3:]
    ]
    bad = [tag + b"\x80" * count + last for tag in (b"\x10", b"\x18") for count in range(11) for last in (b"", b"\x01", b"\x7f")]
    packed = [b"\x0a" + bytes([len(each) - 1]) + each[1:] for each in bad]
    beyond = [b"\x0a\x02\x80\x80\x01\x10\x01", b"\x0a\x03\x01\x80\x80\x01"]
    answers_as_the_library(unit, programs, harmed(good, 40, type_) + bad + packed + beyond)
    assert unit.decode(good[0]).v == numbers


def test_texts_that_come_one_by_one_are_read_where_they_are_checked():
    """Of the message, of messages within it, listed and merged, and of those that contain their own type; apart from each other, too."""
    schema = """
        message M { repeated string v = 1; repeated S many = 2; S one = 3; map<string, S> named = 4; repeated string w = 20; M inner = 5;
            string last = 8; }
        message S { repeated string texts = 1; int32 start = 2; }
    """
    given = protobuf(schema)
    request = type_request("decode", "t.M", given)
    assert re.search(
        r"try:\n +v\.append\(data\[\w+ : \w+\]\.decode\(\)\)\n +except UnicodeDecodeError:",
        source_of(request),
    )
    unit, programs = module(request), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    texts = ["", "a", "é" * 70, "b" * 200]
    inner = {"texts": texts, "start": 1}
    value = {"v": texts, "many": [inner, {"texts": ["c"]}, inner], "one": inner, "w": texts}
    given_values = ({**value, "inner": {**value, "inner": {"v": texts}}}, {**value, "named": {"d": inner, "e": {"texts": ["f"]}}})
    one, mapped = (bytes(programs[1](programs[1].holder_type.from_dict(each))) for each in given_values)
    broken = [one + b"\x0a\x02\xc3", one + b"\x0a\x01\xc3", b"\x0a\x01x\x1a\x03\x0a\x01\xff", b"\x12\x03\x0a\x01\xff"]
    answers_as_the_library(unit, programs, harmed([one, mapped, one + one, b"\x1a\x03\x0a\x01x" + one], 60, "texts") + broken)
    assert unit.decode(one + one).v == texts + texts
    assert unit.decode(one + one).one.texts == texts + texts


def test_entries_without_a_value_have_messages_of_their_type():
    """Types that contain themselves, too, whose values have no row then."""
    schema = "message M { int32 n = 1; map<string, M> own = 2; map<int32, P> others = 3; } message P { P p = 1; }"
    given = protobuf(schema)
    unit, programs = module(type_request("decode", "t.M", given)), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    answers_as_the_library(unit, programs, [b"\x12\x03\x0a\x01a", b"\x12\x00", b"\x1a\x02\x08\x05", b"\x1a\x00"])
    assert unit.decode(b"\x12\x03\x0a\x01a\x1a\x00") == unit.M(own={"a": unit.M()}, others={0: unit.P()})


def test_the_last_entry_of_a_key_stands():
    """In a message field that comes twice, too, whose maps are merged: a dictionary, unlike the library's rows, has each key once."""
    schema = "message M { In i = 1; map<string, In> top = 2; } message In { map<string, int32> m = 1; repeated M inner = 2; }"
    given = protobuf(schema)
    unit, decode, encode = module(type_request("decode", "t.M", given)), rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given)
    a1, a2, b3 = (b"\x0a\x05\x0a\x01" + key + b"\x10" + bytes([value]) for key, value in ((b"a", 1), (b"a", 2), (b"b", 3)))
    for parts, wanted in (((a1 + a2,), {"a": 2}), ((a1, a2), {"a": 2}), ((a2 + b3, a1), {"a": 1, "b": 3})):
        message = b"".join(b"\x0a" + bytes([len(part)]) + part for part in parts)
        found = unit.decode(message)
        assert found.i.m == wanted == dict(decode(message).i.m)
        assert unit.encode(found) == encode(encode.holder_type.from_dict({"i": {"m": wanted}}))
        entry = b"\x0a\x01x\x12" + bytes([len(a1)])
        entries = b"".join(b"\x12" + bytes([len(entry + each)]) + entry + each for each in (a1, b3))
        assert unit.decode(entries).top == {"x": unit.In({"b": 3})}  # the values of entries are not merged


def test_long_messages_of_types_that_contain_themselves():
    """Their bytes stay in parts until the message is whole: around that length, in lists, maps, oneofs and messages between."""
    schema = """
        message M { bytes data = 1; M one = 2; repeated M many = 3; map<string, M> named = 4; oneof which { M first = 5; string text = 6; }
            Between between = 7; }
        message Between { M inner = 1; string text = 2; repeated M inners = 3; }
    """
    given = protobuf(schema)
    unit, programs = module(type_request("decode", "t.M", given)), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    deep = {"data": b"end"}
    for _ in range(60):
        deep = {"data": bytes(3000), "one": deep}
    leaves = [{"data": bytes(size)} for size in (0, 10, 32700, 32760, 32768, 40000, 3_000_000)]
    between = {"inner": leaves[5], "text": "é" * 20000, "inners": leaves[:5]}
    values = [*leaves, deep, {"many": leaves, "one": leaves[6], "first": {"one": leaves[3], "text": "x" * 50000}}]
    values += [{"named": {"a": leaves[6], "b": {"between": between}}, "between": between}, {"between": {"inner": {}}}]
    messages = [bytes(programs[1](programs[1].holder_type.from_dict(each))) for each in values]
    answers_as_the_library(unit, programs, messages)
    wrong = unit.M(one=unit.M(data="text" * 20000), data=bytes(50000))
    for made in (wrong, unit.M(many=[wrong, unit.M(data=7)]), unit.M(many=[unit.M(data=bytes(50000)), 5])):
        with pytest.raises(unit.EncodeError):
            unit.encode(made)


def test_bytes_that_come_one_by_one_are_appended_where_they_are():
    """Of the message, in a list apart, and in messages within it, whose lists are merged."""
    given = protobuf(
        "message M { repeated bytes v = 1; S one = 2; int32 n = 3; repeated bytes w = 20; } message S { repeated bytes v = 1; }"
    )
    request = type_request("decode", "t.M", given)
    assert "v.append(data[" in source_of(request)
    unit, programs = module(request), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    values = [b"", b"a", bytes(200), b"\xff" * 20000]
    good = bytes(programs[1](programs[1].holder_type.from_dict({"v": values, "one": {"v": values}, "n": 1, "w": values})))
    answers_as_the_library(unit, programs, harmed([good, good + good, b"\x0a\x01a\x18\x01\x0a\x01b"], 60, "bytes"))
    assert unit.decode(good + good).v == values + values
    assert unit.decode(good + good).one.v == values + values


def test_lengths_of_several_bytes():
    """Of two to five, those that are too long or too large, and those that end nowhere; of texts, bytes and messages."""
    given = protobuf("message M { string text = 1; bytes data = 2; S one = 3; repeated S many = 4; } message S { string text = 1; }")
    unit, programs = module(type_request("decode", "t.M", given)), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    sizes = [127, 128, 129, 16383, 16384, 2097151, 2097152]
    good = [b"\x12" + unit._varint(size) + bytes(size) for size in sizes] + [b"\x12\x83\x80\x80\x80\x00abc", b"\x0a\x81\x00a"]
    lengths = [b"\x80" * count + last for count in range(1, 11) for last in (b"", b"\x00", b"\x01", b"\x08", b"\x7f")]
    answers_as_the_library(
        unit, programs, good + [tag + each + b"rest" for tag in (b"\x0a", b"\x12", b"\x1a", b"\x22") for each in lengths]
    )


def test_texts_stay_in_the_message_until_they_are_made():
    """Of messages within others, entries of maps and cases of oneofs: empty ones, those that come again, and those that are no UTF-8."""
    schema = """
        message M { string name = 1; S one = 2; repeated S many = 3; map<string, string> names = 4;
            oneof which { string a = 5; int32 b = 6; } }
        message S { string text = 1; optional string note = 2; bytes data = 3; }
    """
    given = protobuf(schema)
    text = source_of(type_request("decode", "t.M", given), ("decode",))
    assert " _text(" not in text[text.index("def _borrow_1") :]
    unit, programs = module(type_request("decode", "t.M", given)), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    inner = {"text": "é" * 70, "note": "", "data": b"\xff"}
    value = {"name": "n", "one": inner, "many": [inner, {}, {"text": "b" * 300}], "names": {"": "x", "k": "", "ü": "v"}, "a": ""}
    one = bytes(programs[1](programs[1].holder_type.from_dict(value)))
    answers_as_the_library(unit, programs, harmed([one, one + b"\x0a\x00\x12\x02\x0a\x00", b"\x2a\x01x\x30\x05"], 80, "where"))
    assert unit.decode(one + b"\x12\x03\x0a\x01z").one == unit.S(text="z", note="", data=b"\xff")


def test_long_messages_within_others_are_not_copied_by_each():
    """Texts and bytes of any length, within messages, entries of maps, and messages that contain their own type."""
    schema = """
        message Leaf { string text = 1; bytes raw = 2; int32 n = 3; repeated string texts = 4; }
        message Flat { Leaf one = 1; repeated Leaf many = 2; map<string, Leaf> named = 3; map<string, bytes> raws = 4; string last = 5; }
        message Root { Flat a = 1; repeated Flat b = 2; Chain c = 3; string text = 4; Only d = 5; }
        message Chain { Chain next = 1; string text = 2; bytes raw = 3; map<string, Chain> named = 4; map<string, string> texts = 5; }
        message Only { Only next = 1; string text = 2; }
    """
    long = [{"text": each * size, "raw": b"r" * size, "n": 1, "texts": ["", each * size]} for each in "aé" for size in (10, 9000, 70000)]
    flat = {
        "one": long[2],
        "many": long,
        "named": {"a" * 9000: long[1], "b": long[0]},
        "raws": {"x" * 9000: b"y" * 9000},
        "last": "z" * 9000,
    }
    chain = {"text": "a" * 9000, "texts": {"k" * 9000: "v" * 9000, "": ""}}
    for _ in range(5):
        chain = {"next": chain, "text": "é" * 9000, "raw": b"b" * 9000, "named": {"n" * 9000: {"text": "t" * 9000}}}
    only = {"text": "only" * 5000}
    values = [{"a": flat}, {"a": {}}, {"c": chain}, {"d": only}, {"d": {"next": only}}]
    values.append({"a": flat, "b": [flat], "c": chain, "text": "r" * 9000, "d": only})
    given = protobuf(schema)
    unit, decode, encode = (
        module(type_request("decode", "t.Root", given)),
        rj.Decoder.of("t.Root", **given),
        rj.Encoder.of("t.Root", **given),
    )
    for each in values:
        message = bytes(encode(encode.holder_type.from_dict(each)))
        assert unit.encode(unit.decode(message)) == message
        assert bytes(encode(decode(message))) == message
    for wrong in ({"raw": "s" * 9000}, {"text": b"s" * 9000}, {"raw": [0] * 9000}, {"texts": [None]}, {"raw": None}):
        with pytest.raises(unit.EncodeError, match="range"):
            unit.encode(unit.Root(a=unit.Flat(one=unit.Leaf(**wrong))))
    for wrong in (b"s" * 9000, None, 5):
        with pytest.raises(unit.EncodeError, match="range"):
            unit.encode(unit.Root(d=unit.Only(text=wrong)))


def test_fields_with_their_default_are_left_out_and_looked_at():
    """A number that its field cannot hold is refused, whatever it is equal to; -0.0 is written, and a float that is 0 in 32 bits is not."""
    given = protobuf(
        "message In { sint32 z = 1; float f = 2; bool b = 3; } message M { int32 a = 1; uint64 u = 2; float f = 3; double d = 4; "
        "bool b = 5; sint64 z = 6; fixed32 x = 7; In one = 8; repeated In many = 9; string s = 10; }"
    )
    request = type_request("decode", "t.M", given)
    unit, encode = module(request), rj.Encoder.of("t.M", **given)
    inner = [{}, {"z": -1}, {"f": -0.0}, {"b": True}, {"z": -(2**31), "f": 1.5}]
    whole = {"a": -(2**31), "u": 2**64 - 1, "f": 0.5, "d": 1e-300, "b": True, "z": -(2**63), "x": 2**32 - 1, "s": "é"}
    for values in ({}, {"f": -0.0, "d": -0.0}, {"f": 1e-60}, whole, {"many": inner, "one": inner[1]}, {"one": {}}):
        made = {
            name: [unit.In(**each) for each in value] if name == "many" else unit.In(**value) if name == "one" else value
            for name, value in values.items()
        }
        assert unit.encode(unit.M(**made)) == bytes(encode(encode.holder_type.from_dict(values)))
    for name in ("a", "u", "z", "x"):
        for wrong in (0.0, "", None, [], 2**64, -(2**63) - 1, "1"):
            with pytest.raises(unit.EncodeError, match="range"):
                unit.encode(unit.M(**{name: wrong}))
    for wrong in ({"f": "", "d": 0}, {"d": None}, {"d": ""}):
        with pytest.raises(unit.EncodeError, match="range"):
            unit.encode(unit.M(**wrong))


def test_texts_and_cases_of_messages_are_read_where_they_are_checked():
    """Fields that come twice, are cut, or are no UTF-8; a case that is left for another one, and comes back empty."""
    given = protobuf(
        "message In { int32 a = 1; string s = 2; bool b = 3; } message M { string s = 1; optional string o = 2; In in = 3; "
        "oneof c { string t = 4; In i = 5; bool f = 6; In j = 7; bytes r = 8; } repeated In many = 9; }"
    )
    request = type_request("decode", "t.M", given)
    text = source_of(request)
    assert "message = bytearray(" not in text
    assert "m_s_text = data[" in text
    unit, programs = module(request), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    text_, inner = b"\x0a\x02ab", b"\x08\x05\x12\x01x\x18\x01"
    cases = [b"\x22\x01t", b"\x2a" + bytes([len(inner)]) + inner, b"\x2a\x00", b"\x30\x01", b"\x3a\x02\x08\x07", b"\x42\x01r", b"\x22\x00"]
    other = [
        b"\x12\x00",
        b"\x12\x02\xc3\xa9",
        b"\x1a\x03\x12\x01y",
        b"\x1a\x00",
        b"\x1a\x02\x08\x09",
        b"\x4a\x03\x12\x01m",
        text_,
        b"\x0a\x01c",
    ]
    good = [*cases, *other, *(one + two for one in cases for two in cases), *(one + two for one in other for two in other)]
    good += [one + two + three for one in cases for two in cases[1:5] for three in cases]
    bad = [b"\x0a\x01\xff", b"\x12\x02\xc3", b"\x1a\x03\x12\x01\x80", b"\x22\x01\xc3", b"\x2a\x03\x12\x01\xff", b"\x2a\x04\x12\x03a"]
    answers_as_the_library(unit, programs, [*good, *bad, *(each[:-1] for each in good), *(one + two for one in cases for two in bad)])


def test_rows_of_many_numbers_are_read_by_one_call():
    """Of lists and maps, also within others; what is left of a row that lacks fields are their defaults."""
    given = protobuf(
        "message Q { int32 a = 1; double b = 2; bool c = 3; string d = 4; bytes e = 5; optional float f = 6; optional bool g = 7; "
        "sint64 h = 8; oneof k { int32 i = 9; string j = 10; } } message R { repeated Q many = 1; } "
        "message M { repeated Q some = 1; map<string, Q> named = 2; repeated R rows = 3; map<int32, R> maps = 4; }"
    )
    request = type_request("decode", "t.M", given)
    text = source_of(request)
    assert text.count(" in _unpack_each(") == 4
    assert "some_a, some_h, some_b, " not in text
    unit, programs = module(request), (rj.Decoder.of("t.M", **given), rj.Encoder.of("t.M", **given))
    whole = {"a": -5, "b": -0.0, "c": True, "d": "ä", "e": b"\0", "f": 1.5, "g": False, "h": -(2**40), "j": "x"}
    rows = [whole, {}, {"g": True}, {"i": 0}, {"d": "only"}, {"f": 0.0}]
    value = {"some": rows, "named": {str(at): row for at, row in enumerate(rows)}, "rows": [{"many": rows[:count]} for count in (0, 1, 6)]}
    value["maps"] = {-1: {"many": rows}, 0: {}}
    message = bytes(programs[1](programs[1].holder_type.from_dict(value)))
    found = unit.decode(message)
    cases = [("j", "x"), None, None, ("i", 0), None, None]
    assert found.some == [
        unit.Q(**{name: each[name] for name in each if name not in "ij"}, k=k) for each, k in zip(rows, cases, strict=True)
    ]
    assert (found.rows[2].many, found.rows[0].many, found.named["0"].c) == (found.some, [], True)
    answers_as_the_library(unit, programs, harmed([message, b"\x0a\x00", b"\x1a\x02\x0a\x00"], 60, "rows"))
