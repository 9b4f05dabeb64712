"""Compiled decoders and encoders against protobuf's own: bytes that it wrote, and random messages of the RST types."""

from __future__ import annotations

import base64
import json
import random
import struct
from pathlib import Path

import pytest

import rosetta_jit as rj

pytest.importorskip("google.protobuf")
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

ROOT = Path(__file__).resolve().parents[3]
PEER = json.loads((ROOT / "tests" / "vectors" / "protobuf" / "peer.json").read_text())
DESCRIPTORS = base64.b64decode(PEER["file_descriptor_set_b64"])
TYPES = sorted({record["type"] for record in PEER["records"]})
RST = [
    "kinematics.JointAngles",
    "vision.Image",
    "geometry.Pose",
    "generic.Value",
    "generic.Dictionary",
    "kinematics.Posture3DFloat",
    "math.MatrixDouble",
    "xml.Attachment",
]


def classes(descriptors):
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(descriptors).file:
        pool.Add(file)
    return lambda name: message_factory.GetMessageClass(pool.FindMessageTypeByName(name))


@pytest.fixture(scope="module")
def rst(tmp_path_factory):
    from grpc_tools import protoc

    out = tmp_path_factory.mktemp("rst") / "rst.fds"
    idl = ROOT / "idl"
    files = [str(path) for path in sorted((idl / "rst").rglob("*.proto"))]
    assert protoc.main(["protoc", f"-I{idl}", "--include_imports", f"--descriptor_set_out={out}", *files]) == 0
    return classes(out.read_bytes())


def programs(name, backend, **options):
    return rj.Decoder.of(name, encoding="protobuf", backend=backend, **options), rj.Encoder.of(
        name, encoding="protobuf", backend=backend, **options
    )


@pytest.fixture(scope="module")
def peers():
    return classes(DESCRIPTORS)


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
@pytest.mark.parametrize("name", TYPES)
def test_bytes_and_values_of_the_peer(name, backend, peers):
    decode, encode = programs(name, backend, schema=DESCRIPTORS)
    theirs = peers(name)
    for record in PEER["records"]:
        if record["type"] == name:
            data = bytes.fromhex(record["hex"])
            holder = decode(data)
            assert listed(holder) == listed(theirs.FromString(data))
            assert encode(holder) == data


def listed(value):
    """The fields that are set, by name (of extensions as text format has it), down to the bits of floats."""
    match value:
        case float():
            return struct.pack("<d", value)
        case _ if hasattr(value, "ListFields"):
            return {shown(field): listed(each) for field, each in value.ListFields()}
        case _ if hasattr(value, "items"):
            return {key: listed(each) for key, each in value.items()}
        case str() | bytes() | int():
            return value
        case _ if hasattr(value, "tobytes") and not hasattr(value, "__len__"):
            return listed(value.item())
        case _:
            return [listed(each) for each in value]


def shown(field):
    return f"[{field.full_name}]" if field.is_extension and not field.name.startswith("[") else field.name


NUMBERS = {
    1: [0.0, -0.0, 1.5, float("inf")],
    2: [0.0, -2.25, 1e10],
    3: [0, -1, 2**63 - 1, -(2**63)],
    4: [0, 300, 2**64 - 1],
    5: [0, -1, 2**31 - 1, -(2**31)],
    8: [True, False],
    9: ["", "a", "héllo", "x" * 300],
    12: [b"", b"\0\xff", bytes(300)],
    13: [0, 300, 2**32 - 1],
    17: [0, -1, 2**31 - 1, -(2**31)],
}


def fill(message, choose, depth=0):
    for field in message.DESCRIPTOR.fields:
        if not field.is_required and (choose.random() < 0.3 or (field.type == 11 and depth > 3)):
            continue
        for _ in range(choose.randrange(4) if field.is_repeated else 1):
            if field.type == 11:
                inner = getattr(message, field.name).add() if field.is_repeated else getattr(message, field.name)
                inner.SetInParent()
                fill(inner, choose, depth + 1)
                continue
            value = choose.choice(field.enum_type.values).number if field.type == 14 else choose.choice(NUMBERS[field.type])
            if field.is_repeated:
                getattr(message, field.name).append(value)
            else:
                setattr(message, field.name, value)
    return message


@pytest.mark.parametrize("name", RST)
def test_random_messages(name, rst):
    decode, encode = programs(f"rst.{name}", "llvm")
    cls, choose = rst(f"rst.{name}"), random.Random(name)
    for _ in range(200):
        data = fill(cls(), choose).SerializeToString()
        holder = decode(data)
        assert encode(holder) == data
        assert encode(type(holder).from_dict(holder.to_dict())) == data


@pytest.mark.parametrize("name", RST)
def test_harmed_messages_are_refused_or_read_alike(name, rst):
    """We refuse what protobuf's Python takes in two cases: a required field that is missing, and text that is not UTF-8 (proto2)."""
    decode, encode = programs(f"rst.{name}", "llvm")
    cls, choose = rst(f"rst.{name}"), random.Random(name)
    for _ in range(25):
        data = bytearray(fill(cls(), choose).SerializeToString())
        for _ in range(40):
            harmed = bytearray(data[: choose.randrange(len(data) + 1)])
            for _ in range(choose.randrange(3)):
                if harmed:
                    harmed[choose.randrange(len(harmed))] = choose.randrange(256)
            outcome = decoded(decode, bytes(harmed))
            if isinstance(outcome, rj.DecodeError):
                assert 0 <= outcome.offset <= len(harmed)
            else:
                assert cls.FromString(encode(outcome)) is not None
                assert cls.FromString(bytes(harmed)).IsInitialized()


def decoded(decode, message):
    try:
        return decode(message)
    except rj.DecodeError as error:
        return error


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_a_case_that_comes_again_behind_another_one_starts_empty_in_recursive_messages_too(backend):
    schema = {"m.proto": 'syntax = "proto3"; message A { oneof o { A a = 1; int32 b = 2; } string s = 3; }'}
    decode, encode = programs("A", backend, schema=schema)
    inner, other, empty = b"\x0a\x03\x1a\x01x", b"\x10\x01", b"\x0a\x00"
    assert decode(inner + other + empty).a.s == ""
    assert encode(decode(inner + other + empty)) == empty
    assert decode(inner + other + inner).a.s == "x"
    assert decode(inner + empty).a.s == "x"  # of one case, pieces merge
    assert decode(inner + other).b == 1


def test_unknown_fields_are_copied_where_there_are_any():
    """A call that copies nothing costs as much as a field."""
    schema = {"m.proto": 'syntax = "proto3"; message M { int32 x = 1; }'}
    lines = rj.Encoder.of("M", encoding="protobuf", schema=schema).stage("kernel").splitlines()
    (at,) = (number for number, line in enumerate(lines) if line.strip().startswith("copy [") and "lane 1[" in line)
    assert lines[at - 1].strip().startswith("if (")


STRANGE = """
syntax = "proto3";
message Inner { int32 x = 1; Outer outer = 2; }
message Outer {
  Inner inner = 1; repeated Inner inners = 2; map<string, Inner> by_name = 3; map<string, int32> counts = 4; Outer child = 5;
  repeated int32 numbers = 6; oneof either { Inner left = 7; string right = 8; }
}
"""


@pytest.fixture(scope="module", params=["theirs", "ours"])
def strange_class(request, tmp_path_factory):
    """The same class twice."""
    from grpc_tools import protoc

    folder = tmp_path_factory.mktemp("strange")
    (folder / "a.proto").write_text(STRANGE)
    assert protoc.main(["protoc", f"-I{folder}", f"--descriptor_set_out={folder}/a.fds", "a.proto"]) == 0
    schema = (folder / "a.fds").read_bytes()
    return classes(schema)("Outer") if request.param == "theirs" else programs("Outer", "llvm", schema=schema)[0].holder_type


UNKNOWN, INNER = b"\xfa\x7c\x01x", b"\x08\x01\xfa\x7c\x01x"
"""Field 1999, which no type has; and a message with it."""


def test_messages_that_are_emptied_forget_unknown_fields(strange_class):
    data = b"\x0a\x06" + INNER + b"\x12\x06" + INNER
    other = strange_class(inner={"x": 5})
    for change, wanted in (
        (lambda message: message.inner.Clear(), b"\x0a\x00" + data[8:]),
        (lambda message: message.inners[0].Clear(), data[:8] + b"\x12\x00"),
        (lambda message: message.inner.CopyFrom(other.inner), b"\x0a\x02\x08\x05" + data[8:]),
        (lambda message: message.inners[0].CopyFrom(other.inner), data[:8] + b"\x12\x02\x08\x05"),
        (lambda message: message.inner.ParseFromString(b"\x08\x05"), b"\x0a\x02\x08\x05" + data[8:]),
        (lambda message: message.inner.MergeFrom(other.inner), b"\x0a\x06\x08\x05" + UNKNOWN + data[8:]),
    ):
        message = strange_class.FromString(data)
        change(message)
        assert message.SerializeToString() == wanted


def test_unknown_fields_are_discarded(strange_class):
    """A message has them, and so have those in it, in an array, a map and a oneof."""
    parts = [b"\x0a\x06" + INNER, b"\x12\x06" + INNER, b"\x1a\x0b\x0a\x01k\x12\x06" + INNER, b"\x22\x0d\x0a\x09(unknown)\x10\x01"]
    message = strange_class.FromString(b"".join([*parts, b"\x32\x02\x07\x08", b"\x3a\x06" + INNER, UNKNOWN]))
    sizes = [message.ByteSize()]
    message.inner.DiscardUnknownFields()
    sizes.append(message.ByteSize())
    message.DiscardUnknownFields()
    assert [sizes[0] - sizes[1], sizes[0] - message.ByteSize()] == [4, 20]
    assert (message.inner.x, [each.x for each in message.inners], message.by_name["k"].x) == (1, [1], 1)
    assert (dict(message.counts), list(message.numbers)) == ({"(unknown)": 1}, [7, 8])
    assert (message.left.x, message.WhichOneof("either"), message.HasField("child")) == (1, "left", False)
    message.child.DiscardUnknownFields()
    assert message.HasField("child")


def test_fields_in_any_order_unknown_ones_and_merges():
    inner = "message P { optional int32 x = 1; repeated int32 y = 2; }"
    outer = "message M { optional P p = 1; repeated int32 n = 2; optional string s = 3; }"
    schema = {"m.proto": f'syntax = "proto2"; {outer} {inner}'}
    decode = rj.Decoder.of("M", encoding="protobuf", schema=schema, backend="llvm")
    unknown = bytes([0x7A, 2, 1, 2]) + bytes([0x83, 1, 0x08, 5, 0x84, 1]) + bytes([0xA5, 6, 1, 2, 3, 4]) + bytes([0xA0, 6, 150, 1])
    wire = (
        bytes([0x10, 1])
        + unknown
        + bytes([0x0A, 2, 0x08, 7])
        + bytes([0x12, 2, 2, 3])
        + bytes([0x1A, 1])
        + b"a"
        + bytes([0x10, 4])
        + bytes([0x0A, 4, 0x10, 5, 0x10, 6])
        + bytes([0x1A, 1])
        + b"b"
        + bytes([0x0A, 2, 0x10, 9])
    )
    assert decode(wire).to_dict() == {"p": {"x": 7, "y": [5, 6, 9]}, "n": [1, 2, 3, 4], "s": "b"}
    cuts = [decoded(decode, wire[:cut]) for cut in range(len(wire))]
    assert sum(isinstance(outcome, rj.DecodeError) for outcome in cuts) > len(wire) // 2


@pytest.mark.parametrize(
    ("wire", "kind"),
    [
        (b"\x08", "truncated"),
        (b"\x08" + b"\xff" * 10 + b"\x01", "varint"),
        (b"\x00\x01", "tag"),
        (b"\x0e", "tag"),
        (b"\x0c", "tag"),
        (b"\x0b", "truncated"),
        (b"\x0b\x14", "tag"),
        (b"\x12\x7f", "truncated"),
        (b"\x12\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01", "truncated"),
        (b"\x12\x01\xff", "text"),
        (b"\x1a\x03\0\0\0", "length"),
        (b"\x0b" * 65, "nesting"),
        (b"", "missing"),
    ],
)
def test_what_is_wrong_has_a_kind(wire, kind):
    schema = {
        "m.proto": 'syntax = "proto2"; message M { required int32 i = 1; optional string s = 2; repeated fixed32 f = 3 [packed=true]; }'
    }
    for backend in ("llvm", "python"):
        with pytest.raises(rj.DecodeError) as caught:
            rj.Decoder.of("M", encoding="protobuf", schema=schema, backend=backend)(wire)
        assert caught.value.kind == kind


@pytest.mark.parametrize("backend", ["llvm", "interpreter"])
def test_what_is_wrong_in_an_element_is_told_with_its_index(backend):
    files = {"a.proto": "syntax = 'proto3'; message J { string t = 1; } message I { repeated J j = 1; } message M { repeated I i = 1; }"}
    decode = rj.Decoder.of("M", encoding="protobuf", schema=files, backend=backend)
    good, bad = b"\x0a\x00", b"\x0a\x07" + b"\x0a\x00" + b"\x0a\x03\x0a\x01\xff"
    for count in range(3):
        with pytest.raises(rj.DecodeError) as caught:
            decode(good * count + bad)
        assert caught.value.path == f".i[{count}].j[1].t"


def test_depth_is_bounded_and_wide_trees_are_not():
    decode, encode = programs("rst.generic.Value", "llvm")
    value = b"\x08\x01"
    for _ in range(64):
        value = b"\x08\x07\x3a" + _varint(len(value)) + value
    assert encode(decode(value)) == value
    deeper = b"\x08\x07\x3a" + _varint(len(value)) + value
    with pytest.raises(rj.DecodeError) as caught:
        decode(deeper)
    assert caught.value.kind == "nesting"
    wide = b"\x08\x07" + b"\x3a\x02\x08\x01" * 5000
    assert len(decode(wide).array) == 5000
    assert encode(decode(wide)) == wide


def test_bytes_that_no_rule_reads_stay_in_the_message():
    """They are checked, and neither copied nor given room."""
    files = {
        "a.proto": "syntax = 'proto3'; message M { bytes data = 1; string text = 2; uint32 width = 3; }",
        "b.proto": "syntax = 'proto2'; message H { required uint32 width = 1; }",
        "a.mapping": 'import "a.proto"\nimport "b.proto"\ndata-holder: H\nwire-schema: M\nunpack-rules:\n  .width = .width\n',
    }
    decode = rj.Decoder("a.mapping", schema=files)
    assert "copy lane" not in decode.stage("kernel")
    message = b"\x0a\x83\x00abc" + b"\x12\x02\xc3\xa9" + b"\x18\x07" + b"\x20\x01"
    assert decode(message).width == 7
    for broken, kind in ((message[:5], "truncated"), (b"\x12\x01\xff" + message, "text")):
        with pytest.raises(rj.DecodeError) as caught:
            decode(broken)
        assert caught.value.kind == kind


def _varint(value):
    out = bytearray()
    while value >= 128:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes([*out, value])
