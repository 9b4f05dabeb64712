"""Mappings whose wire cannot be mapped where its bytes lie: its message is staged in hidden lanes, in both directions and every backend."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]

PROTO = """syntax = "proto3"; package lab;
message Point { double x = 1; double y = 2; string name = 3; repeated string tags = 4; }
message Tree { int32 value = 1; repeated Tree children = 2; }
message Scene {
  repeated Point points = 1;
  Point origin = 2;
  oneof kind { int32 number = 3; string word = 4; }
  optional float scale = 5;
  map<string, int32> counts = 6;
  Tree tree = 7;
}
"""
BOTTLE = """"scene" (("names" (:list :string)) ("xs" (:list :double)) ("origin" :string) ("number" :int) ("word" :string) ("scale" :double)
  ("keys" (:list :string)) ("values" (:list :int)) ("root" :int) ("children" (:list :int)))"""
MAPPING = """import "lab.proto"
import "scene.bottle-schema"
data-holder: scene
wire-schema: lab.Scene
unpack-rules:
  len(.names) = len(.points)
  len(.xs) = len(.points)
  for i from 0 to len(.points)
    .names[i] = .points[i].name
    .xs[i] = .points[i].x + .points[i].y
  end
  .origin = .origin.name
  .number = .number if has(.number) else -1
  when has(.word)
    .word = .word
  else
    .word = "none"
  end
  .scale = .scale if has(.scale) else 1
  len(.keys) = len(.counts)
  len(.values) = len(.counts)
  for i from 0 to len(.counts)
    .keys[i] = .counts[i].key
    .values[i] = .counts[i].value
  end
  .root = .tree.value if has(.tree) else 0
  when has(.tree)
    len(.children) = len(.tree.children)
    for i from 0 to len(.tree.children)
      .children[i] = .tree.children[i].value
    end
  else
    len(.children) = 0
  end
pack-rules:
  len(.points) = len(.names)
  for i from 0 to len(.names)
    .points[i].name = .names[i]
    .points[i].x = .xs[i]
    default .points[i].y
    default .points[i].tags
  end
  .origin.name = .origin
  .origin.x = 0
  .origin.y = 0
  len(.origin.tags) = 2
  .origin.tags[0] = "a"
  .origin.tags[1] = .origin
  when .word == "none"
    .number = .number
  else
    .word = .word
  end
  when .scale != 1
    .scale = float32(.scale)
  end
  len(.counts) = len(.keys)
  for i from 0 to len(.keys)
    .counts[i].key = .keys[i]
    .counts[i].value = .values[i]
  end
  .tree.value = .root
  len(.tree.children) = len(.children)
  for i from 0 to len(.children)
    .tree.children[i].value = .children[i]
    default .tree.children[i].children
  end
"""
FILES = {"lab.proto": PROTO, "scene.bottle-schema": BOTTLE, "scene.mapping": MAPPING}


def scene(**fields):
    empty = {
        "names": [],
        "xs": [],
        "origin": "",
        "number": -1,
        "word": "none",
        "scale": 1.0,
        "keys": [],
        "values": [],
        "root": 0,
        "children": [],
    }
    return empty | fields


SCENES = [
    scene(),
    scene(names=["x" * 300, "", "é"], xs=[1.5, -2.0, 0.25], origin="o", word="w", keys=["a", "b"], values=[1, -2]),
    scene(number=7, scale=2.5, root=3, children=list(range(40))),
]


def wire(backend="llvm"):
    imports = ["lab.proto"]
    return rj.Decoder.of("lab.Scene", schema=FILES, imports=imports), rj.Encoder.of("lab.Scene", schema=FILES, imports=imports)


def programs(backend):
    return rj.Decoder("scene.mapping", schema=FILES, backend=backend), rj.Encoder("scene.mapping", schema=FILES, backend=backend)


def packed(values):
    """What the wire's own message must be, by hand."""
    message = {
        "points": [{"x": x, "y": 0.0, "name": name, "tags": []} for name, x in zip(values["names"], values["xs"], strict=True)],
        "origin": {"x": 0.0, "y": 0.0, "name": values["origin"], "tags": ["a", values["origin"]]},
        "counts": dict(zip(values["keys"], values["values"], strict=True)),
        "tree": {"value": values["root"], "children": [{"value": value, "children": []} for value in values["children"]]},
    }
    message |= {"number": values["number"]} if values["word"] == "none" else {"word": values["word"]}
    return message | ({} if values["scale"] == 1 else {"scale": values["scale"]})


@pytest.mark.parametrize("backend", BACKENDS)
def test_both_ways(backend):
    decode, encode = programs(backend)
    plain, _ = wire()
    for values in SCENES:
        message = encode(encode.holder_type.from_dict(values))
        assert encode.size(encode.holder_type.from_dict(values)) == len(message)
        assert plain(message).to_dict() == packed(values)
        assert decode(message).to_dict() == values | ({} if values["word"] == "none" else {"number": -1})


@pytest.mark.parametrize("backend", BACKENDS)
def test_many(backend):
    decode, encode = programs(backend)
    messages = [encode(encode.holder_type.from_dict(values)) for values in SCENES * 3]
    offsets = np.cumsum([0, *map(len, messages)])
    batch = decode.many(b"".join(messages), offsets)
    assert [each.to_dict() for each in batch] == [decode(message).to_dict() for message in messages]
    buffer, ends = encode.many(batch)
    assert bytes(buffer) == b"".join(messages)
    assert ends.tolist() == offsets.tolist()


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_is_absent_or_another_case(backend):
    decode, _ = programs(backend)
    _, encode = wire()
    empty = {"points": [], "counts": {}}
    for message, number, word in (({"word": "w"}, -1, "w"), ({"number": 5}, 5, "none"), ({}, -1, "none")):
        found = decode(encode(encode.holder_type.from_dict(empty | message))).to_dict()
        assert (found["number"], found["word"], found["scale"], found["origin"], found["root"]) == (number, word, 1.0, "", 0)
    # The last of several cases counts, and nothing of the ones before is left.
    first, second = (encode(encode.holder_type.from_dict(empty | case)) for case in ({"word": "w"}, {"number": 5}))
    assert decode(first + second).word == "none"


@pytest.mark.parametrize("backend", BACKENDS)
def test_broken_messages(backend):
    decode, encode = programs(backend)
    message = encode(encode.holder_type.from_dict(SCENES[1]))
    kinds = set()
    for cut in range(0, len(message), 1 if backend == "llvm" else 37):
        try:
            decode(message[:cut])
        except rj.DecodeError as error:
            kinds.add(error.kind)
    assert kinds <= {"truncated", "varint", "length", "text", "tag"}
    assert decode(message).to_dict()["names"] == SCENES[1]["names"]


WHOLE = {
    "lab/msg/Joint.msg": "string name\nfloat64[3] axis\nfloat32 limit 1.5\nLink[2] links\n",
    "lab/msg/Link.msg": "uint8[4] color\nint16[] data\n",
    "lab/msg/Arm.msg": "Joint[] joints\nJoint base\nstring[] names\n",
    "lab/msg/Copy.msg": "Joint[] joints\nJoint base\nstring[<=2] names\n",
    "copy.mapping": """import "lab/msg/Arm.msg"
import "lab/msg/Copy.msg"
data-holder: lab/msg/Copy
wire-schema: lab/msg/Arm
rules:
  .joints <-> .joints
  .base <-> .base
  .names <-> .names
""",
    "fill.mapping": """import "lab/msg/Arm.msg"
import "lab/msg/Copy.msg"
data-holder: lab/msg/Copy
wire-schema: lab/msg/Arm
unpack-rules:
  len(.joints) = len(.names)
  for i from 0 to len(.names)
    .joints[i].name = .names[i]
    .joints[i].axis[0] = 1
    .joints[i].axis[1] = .base.axis[1]
    .joints[i].axis[2] = 0
    default .joints[i].limit
    default .joints[i].links
  end
  .base.name = "base"
  for i from 0 to 3
    .base.axis[i] = .base.axis[2 - i]
  end
  .base.limit = .base.limit * 2
  .base.links = .base.links
  default .names
""",
}


def arm(names):
    links = [{"color": bytes([1, 2, 3, 4]), "data": [7]}, {"color": bytes([0, 0, 0, 9]), "data": []}]
    joints = [{"name": name, "axis": [1.0, 0.5, 0.25], "limit": 0.5, "links": links} for name in [*names, "base"]]
    return {"joints": joints[:-1], "base": joints[-1], "names": names}


@pytest.mark.parametrize("backend", BACKENDS)
def test_messages_as_a_whole(backend):
    decode, encode = (kind("copy.mapping", schema=WHOLE, backend=backend) for kind in (rj.Decoder, rj.Encoder))
    of_wire = rj.Encoder.of("lab/msg/Arm", schema=WHOLE, imports=["lab/msg/Arm.msg"])
    for names in ([], ["a"], ["a", "bc"]):
        message = of_wire(of_wire.holder_type.from_dict(arm(names)))
        holder = decode(message)
        assert holder.to_dict() == arm(names)
        assert encode(holder) == message
    with pytest.raises(rj.DecodeError) as error:
        decode(of_wire(of_wire.holder_type.from_dict(arm(["a", "b", "c"]))))
    assert error.value.kind == "count"


@pytest.mark.parametrize("backend", BACKENDS)
def test_fixed_arrays_are_filled_and_defaults_are_the_schema_s(backend):
    decode = rj.Decoder("fill.mapping", schema=WHOLE, backend=backend)
    of_wire = rj.Encoder.of("lab/msg/Arm", schema=WHOLE, imports=["lab/msg/Arm.msg"])
    empty = {"color": bytes(4), "data": []}
    for _ in range(2):  # what a message before has left must not show
        found = decode(of_wire(of_wire.holder_type.from_dict(arm(["a", "bc"])))).to_dict()
        assert [joint["name"] for joint in found["joints"]] == ["a", "bc"]
        assert found["joints"][1] == {"name": "bc", "axis": [1.0, 0.5, 0.0], "limit": 1.5, "links": [empty, empty]}
        assert found["base"]["axis"] == [0.25, 0.5, 1.0]
        assert found["base"] | {"axis": 0} == arm([])["base"] | {"axis": 0, "limit": 1.0}
        assert found["names"] == []


def test_presence_of_what_is_always_there():
    wrong = MAPPING.replace("has(.number)", "has(.points[0].name)").replace("has(.scale)", "has(.points[0].x)")
    with pytest.raises(rj.MappingError, match="text is always there") as error:
        rj.Decoder("bad.mapping", schema={**FILES, "bad.mapping": wrong})
    assert "float64 is always there" in str(error.value)


def test_endless_messages_are_not_copied():
    files = {
        "lab.proto": PROTO,
        "copy.mapping": 'import "lab.proto" data-holder: lab.Scene wire-schema: lab.Scene unpack-rules: same names',
    }
    with pytest.raises(rj.MappingError, match="cannot be assigned as a whole"):
        rj.Decoder("copy.mapping", schema=files)


@pytest.mark.parametrize("encoding", ["cdr", "cdr2"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_members_in_any_order(backend, encoding):
    """Members of mutable structs come in any order, so that none of them lies at a place that rules could know."""
    texts = {
        "a.idl": "module a { @mutable struct Wheel { long turns; string name; }; };",
        "lab/Turn.msg": "int64 turns\nstring name\n",
        "m.mapping": 'import "a.idl" import "lab/Turn.msg" data-holder: lab/Turn wire-schema: a::Wheel rules: '
        "same names .turns <-> .turns * 2",
    }
    decode, encode = (kind("m.mapping", schema=texts, encoding=encoding, backend=backend) for kind in (rj.Decoder, rj.Encoder))
    write = rj.Encoder.of("a::Wheel", schema=texts, imports=["a.idl"], encoding=encoding, backend="interpreter")
    message = write(write.holder_type.from_dict({"turns": 3, "name": "left"}))
    assert decode(message).to_dict() == {"turns": 6, "name": "left"}
    assert encode(decode(message)) == message


SEEN = """syntax = "proto3"; package lab;
message Point { double x = 1; double y = 2; string name = 3; repeated string tags = 4; }
message Seen {
  bytes data = 1;
  uint32 width = 2;
  string word = 3;
  repeated Point points = 4;
  repeated sint64 numbers = 5;
  map<string, Point> places = 6;
}
message Width { uint32 width = 1; string first = 2; }
"""
WIDTH = """import "lab.proto"
data-holder: lab.Width
wire-schema: lab.Seen
unpack-rules:
  ignore rest
  .width = .width
  .first = .points[0].name if len(.points) > 0 else ""
"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_no_rule_reads_is_checked_and_not_copied(backend):
    schema = {"lab.proto": SEEN, "width.mapping": WIDTH}
    decode = rj.Decoder("width.mapping", schema=schema, backend=backend)
    encode = rj.Encoder.of("lab.Seen", schema={"lab.proto": SEEN}, imports=["lab.proto"])
    points = [{"x": 1.0, "name": "é", "tags": ["a", "b"]}, {"name": "z"}]
    fields = {"data": bytes(300_000), "width": 7, "word": "ž", "points": points, "numbers": [-1, 2**40], "places": {"k": points[0]}}
    message = bytes(encode(fields))
    assert decode(message).to_dict() == {"width": 7, "first": "é"}
    unknown = b"\xfa\x01\x03abc"
    assert decode(unknown + message + unknown).width == 7
    whole = rj.Decoder.of("lab.Seen", schema={"lab.proto": SEEN}, imports=["lab.proto"])
    for broken in (
        message.replace("ž".encode(), b"\xff\xff"),
        message.replace(b"\x22\x01b", b"\x22\x01\xff"),
        message[:-1],
        message + b"\x1a\x05abc",
        message + b"\x2a\x01\x80",
        message + b"\x0f",
    ):
        kinds: list[str] = []
        for program in (decode, whole):
            with pytest.raises(rj.DecodeError) as caught:
                program(broken)
            kinds.append(caught.value.kind)
        assert kinds[0] == kinds[1]


def test_what_no_rule_reads_takes_no_statements():
    text = rj.Decoder("width.mapping", schema={"lab.proto": SEEN, "width.mapping": WIDTH}).stage("kernel").partition("body 0")[2]
    copies = [line.strip() for line in text.splitlines() if line.strip().startswith("copy")]
    assert len(copies) == 2  # a name, into the hidden lane of names and out of it


@pytest.mark.parametrize("backend", BACKENDS)
def test_lengths_that_are_measured_first(backend):
    """What stands in front of a packed array is known to the measuring kernel, and written by the encoder."""
    files = {
        "t/In.msg": "int32[] ks\n",
        "t/out.proto": 'syntax = "proto3"; package t; message Out { repeated int64 small = 1; repeated sint32 turned = 2; }',
        "m.mapping": 'import "t/In.msg" import "t/out.proto" data-holder: t/In wire-schema: t.Out '
        "pack-rules: .small[] = .ks[] where .ks[] > 3 .turned = permuted(.ks, [1, 0])",
    }
    encode = rj.Encoder("m.mapping", schema=files, encoding="protobuf", backend=backend)
    for ks, message in (([1, 2], b"\x12\x02\x04\x02"), ([5, -300], b"\x0a\x01\x05\x12\x03\xd7\x04\x0a")):
        assert encode({"ks": ks}) == message
