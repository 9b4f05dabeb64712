"""protobuf's own `json_format` and `text_format` read and write holders, and make the same of them as of messages of its package."""

from __future__ import annotations

import datetime as dt
import json
import math

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, json_format, message_factory, text_format
from grpc_tools import protoc
from hypothesis import given, settings
from hypothesis import strategies as st

from rosetta_jit import Decoder

WIDE = """
syntax = "proto3";
package wide;
import "google/protobuf/any.proto";
import "google/protobuf/duration.proto";
import "google/protobuf/field_mask.proto";
import "google/protobuf/struct.proto";
import "google/protobuf/timestamp.proto";
import "google/protobuf/wrappers.proto";

message Wide {
  enum Kind { NONE = 0; SOME = 5; }
  int64 a_long_name = 1;
  uint64 huge = 2 [json_name = "HUGE!"];
  float short = 3;
  double long = 4;
  bytes raw = 5;
  Kind kind = 6;
  repeated Kind kinds = 7;
  map<int64, string> names = 8;
  map<bool, Wide> wides = 9;
  oneof either { int32 left = 10; string right = 11; google.protobuf.NullValue none = 12; }
  optional bool maybe = 13;
  repeated double doubles = 14;
  repeated Wide more = 15;
  google.protobuf.Timestamp when = 16;
  google.protobuf.Duration lasts = 17;
  google.protobuf.Struct object = 18;
  google.protobuf.Value value = 19;
  google.protobuf.ListValue list = 20;
  google.protobuf.Int64Value wrapped = 21;
  google.protobuf.StringValue text = 22;
  google.protobuf.FieldMask mask = 23;
  google.protobuf.Any any = 24;
  repeated google.protobuf.Timestamp times = 25;
  google.protobuf.DoubleValue number = 26;
}
"""


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    """The class of the package, and ours."""
    folder = tmp_path_factory.mktemp("wide")
    (folder / "wide.proto").write_text(WIDE)
    out = folder / "set"
    import grpc_tools

    include = f"{next(iter(grpc_tools.__path__))}/_proto"
    assert protoc.main(["protoc", f"-I{folder}", f"-I{include}", "--include_imports", f"--descriptor_set_out={out}", "wide.proto"]) == 0
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(out.read_bytes()).file:
        pool.AddSerializedFile(file.SerializeToString())
    theirs = message_factory.GetMessageClass(pool.FindMessageTypeByName("wide.Wide"))
    theirs.pool = pool
    return theirs, Decoder.of(theirs, encoding="protobuf").holder_type


NOON = dt.datetime(2024, 2, 29, 12)  # noqa: DTZ001 - protobuf's are without
NUMBERS = st.integers(-(2**63), 2**63 - 1)
JSON = st.recursive(
    st.none() | st.booleans() | st.floats(allow_nan=False, allow_infinity=False) | st.text(max_size=3),
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(st.text(max_size=3), inner, max_size=2),
    max_leaves=5,
)

SHORT = st.floats(width=32, allow_nan=False, allow_infinity=False).filter(lambda each: abs(each) < 3.4e38)
"""Google's parser refuses the largest ones, which are written with so few digits that they round up."""


@st.composite
def fields(draw, depth=1):
    def maybe(name, strategy):
        return {name: draw(strategy)} if draw(st.booleans()) else {}

    inner = st.just({}) if depth == 0 else fields(depth=depth - 1)
    return {
        **maybe("aLongName", NUMBERS.map(str) | NUMBERS),
        **maybe("HUGE!", st.integers(0, 2**64 - 1).map(str)),
        **maybe("short", SHORT | st.sampled_from(["NaN", "-Infinity", -0.0, 0.1])),
        **maybe("long", st.floats(allow_nan=False, allow_infinity=False) | st.sampled_from(["NaN", "Infinity", "1e3", 3])),
        **maybe("raw", st.sampled_from(["", "AA==", "_-8", "/+8=", "aGk"])),
        **maybe("kind", st.sampled_from(["NONE", "SOME", 5, 77])),
        **maybe("kinds", st.lists(st.sampled_from(["NONE", "SOME", 3]), max_size=3)),
        **maybe("names", st.dictionaries(NUMBERS.map(str), st.text(max_size=3), max_size=3)),
        **maybe("wides", st.dictionaries(st.sampled_from(["true", "false"]), inner, max_size=2)),
        **draw(st.sampled_from([{}, {"left": 0}, {"left": -5}, {"right": "x"}, {"none": None}])),
        **maybe("maybe", st.booleans() | st.none()),
        **maybe("doubles", st.lists(st.sampled_from([0.5, "NaN", "-Infinity", -0.0]), max_size=3)),
        **maybe("more", st.lists(inner, max_size=2)),
        **maybe("when", st.sampled_from(["1969-12-31T23:59:59.999999999Z", "0001-01-01T00:00:00Z", "2020-01-01T00:00:00.5+02:00"])),
        **maybe("lasts", st.sampled_from(["0s", "1.5s", "-0.000000001s", "315576000000s"])),
        **maybe("object", st.dictionaries(st.text(max_size=3), JSON, max_size=2)),
        **maybe("value", JSON),
        **maybe("list", st.lists(JSON, max_size=2)),
        **maybe("wrapped", NUMBERS.map(str)),
        **maybe("text", st.text(max_size=3)),
        **maybe("mask", st.sampled_from(["", "a.b,cD", "aLongName"])),
        **maybe("times", st.lists(st.just("2024-02-29T12:00:00.123Z"), max_size=2)),
        **maybe("number", st.sampled_from([0, 1.5, "NaN"])),
    }  # fmt: skip


def shown(value):
    return json.dumps(value, sort_keys=True)


@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_both_ways_as_theirs(pair, data):
    plain = data.draw(fields())
    theirs, ours = (json_format.ParseDict(plain, made()) for made in pair)
    assert ours.SerializeToString(deterministic=True) == theirs.SerializeToString(deterministic=True) or shown(
        json_format.MessageToDict(pair[0].FromString(ours.SerializeToString()))
    ) == shown(json_format.MessageToDict(theirs))
    options = data.draw(
        st.fixed_dictionaries(
            {
                "preserving_proto_field_name": st.booleans(),
                "use_integers_for_enums": st.booleans(),
                "always_print_fields_with_no_presence": st.booleans(),
            }
        )
    )
    expected = json_format.MessageToDict(theirs, **options)
    assert shown(json_format.MessageToDict(ours, **options)) == shown(expected)
    text = json_format.MessageToJson(ours, sort_keys=True)
    assert text == json_format.MessageToJson(theirs, sort_keys=True)
    assert shown(json_format.MessageToDict(json_format.Parse(text, pair[1]()))) == shown(json_format.MessageToDict(ours))


def test_text_format(pair):
    plain = {
        "names": {"1": "a", "-2": "\u00e4\n"}, "wides": {"true": {"aLongName": "2", "names": {"3": "c"}}}, "right": "x",
        "doubles": [0.5, -0.0], "kinds": ["SOME", 3], "raw": "AA==", "object": {"a": [1, None, {"b": True}]}, "more": [{"left": 0}],
    }  # fmt: skip
    theirs, ours = (json_format.ParseDict(plain, made()) for made in pair)
    options = [{}, {"as_one_line": True}, {"as_utf8": True}, {"use_index_order": True}, {"use_field_number": True, "indent": 3}]
    for each in options:
        assert text_format.MessageToString(ours, **each) == text_format.MessageToString(theirs, **each)
    text = text_format.MessageToString(theirs)
    assert text_format.Parse(text, pair[1]()) == ours
    for made in pair:  # parts of an entry that are not there, and a key that comes twice
        message = text_format.Parse('wides { } names { key: 3 value: "x" } names { value: "y" } names { key: 3 }', made())
        assert (dict(message.names), list(message.wides)) == ({3: "", 0: "y"}, [False])
        with pytest.raises(text_format.ParseError, match="nothing"):
            text_format.Parse("names { nothing: 1 }", made())
        entry = message.names.GetEntryClass()(key=5, value="five")
        assert (entry.DESCRIPTOR.full_name, entry.key, entry.value) == ("wide.Wide.NamesEntry", 5, "five")


@pytest.mark.parametrize(
    "wrong",
    [
        {"nothing": 1}, {"aLongName": "x"}, {"aLongName": 1.5}, {"aLongName": str(2**63)}, {"HUGE!": -1}, {"raw": 1}, {"kind": "BLUE"},
        {"kinds": "SOME"}, {"kinds": [None]}, {"names": {"x": "a"}}, {"names": []}, {"wides": {"maybe": {}}}, {"left": 1, "right": "a"},
        {"maybe": "true"}, {"doubles": ["many"]}, {"more": [None]}, {"when": "yesterday"}, {"lasts": "1"}, {"object": []}, {"list": {}},
        {"short": 1e60}, {"value": object()},
    ],
)  # fmt: skip
def test_what_theirs_refuses(pair, wrong):
    for made in pair:
        with pytest.raises((json_format.ParseError, TypeError, AttributeError)):
            json_format.ParseDict(wrong, made())


def test_any(pair):
    theirs, ours = pair
    plain = {"any": {"@type": "type.googleapis.com/wide.Wide", "aLongName": "5", "raw": "AA=="}}
    ones = [json_format.ParseDict(plain, made(), descriptor_pool=theirs.pool) for made in pair]
    assert ones[1].SerializeToString() == ones[0].SerializeToString()
    assert json_format.MessageToDict(ones[1], descriptor_pool=theirs.pool) == plain
    with pytest.raises(TypeError, match="Can not find message descriptor"):
        json_format.MessageToDict(ones[1])
    packed = ours()
    packed.any.Pack(ours(a_long_name=7))
    unpacked = theirs()
    assert theirs.FromString(packed.SerializeToString()).any.Unpack(unpacked)
    assert unpacked.a_long_name == 7


def test_methods_of_well_known_types(pair):
    for made in pair:
        message = made()
        message.when.FromDatetime(NOON)
        assert message.when.ToJsonString() == "2024-02-29T12:00:00Z"
        assert message.when.ToDatetime() == NOON
        message.lasts.FromMilliseconds(-1500)
        assert (message.lasts.seconds, message.lasts.nanos, message.lasts.ToTimedelta()) == (
            -1,
            -500000000,
            dt.timedelta(seconds=-1.5),
        )
        message.object.update({"a": 1, "b": [True, None], "c": {"d": "e"}})
        assert (message.object["a"], message.object["c"]["d"], len(message.object), "b" in message.object) == (1.0, "e", 3, True)
        message.list.extend([1, "x"])
        assert list(message.list) == [1.0, "x"]
        message.mask.FromJsonString("aB,c.d")
        assert list(message.mask.paths) == ["a_b", "c.d"]
        assert math.isclose((message.when + dt.timedelta(seconds=1)).timestamp() - message.when.ToDatetime().timestamp(), 1.0)


def test_names_in_json(pair):
    schema = {"n.proto": 'syntax = "proto3";\nmessage N { int32 a_b = 1; int32 c = 2 [json_name = "see"]; }\n'}
    fields_ = Decoder.of("N", schema=schema, encoding="protobuf", imports=["n.proto"]).holder_type.DESCRIPTOR.fields
    assert [each.json_name for each in fields_] == ["aB", "see"]
    theirs, ours = (made.DESCRIPTOR for made in pair)
    assert [(each.json_name, each.cpp_type, each.type) for each in ours.fields] == [
        (each.json_name, each.cpp_type, each.type) for each in theirs.fields
    ]
