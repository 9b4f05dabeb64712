"""Optional fields and cases of unions in rules for both directions: told by a field on the other side."""

from __future__ import annotations

from typing import Any

import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]

FILES = {
    "flat.idl": """module lab { struct Size { double w; double h; };
      @final struct Flat { long kind; string name; double radius; Size extent;
        boolean has_speed; double speed; boolean has_note; string note; }; };""",
    "nested.proto": """syntax = "proto3"; package lab;
message Circle { double radius = 1; }
message Box { double w = 1; double h = 2; }
message Shape { oneof form { Circle circle = 1; Box box = 2; string name = 3; } optional double speed = 4; optional string note = 5; }""",
}
HEAD = 'import "flat.idl"\nimport "nested.proto"\n'
TO_ONEOF = (
    HEAD
    + """data-holder: lab.Shape
wire-schema: lab::Flat
rules:
  when .kind == 1
    .circle.radius <-> .radius
    ignore .extent ignore .name
  else when .kind == 2
    .box.w <-> .extent.w
    .box.h <-> .extent.h
    ignore .radius ignore .name
  else when .kind == 3
    .name <-> .name
    ignore .extent ignore .radius
  else
    reject "no such kind: {.kind}"
  end end end
  when .has_speed .speed <-> .speed else ignore .speed end
  when not .has_note ignore .note else .note <-> .note end
"""
)
FROM_ONEOF = (
    HEAD
    + """data-holder: lab::Flat
wire-schema: lab.Shape
rules:
  when has(.circle)
    .kind <-> 1
    .radius <-> .circle.radius
    default .extent default .name
  else when has(.box)
    .kind <-> 2
    .extent.w <-> .box.w
    .extent.h <-> .box.h
    default .radius default .name
  else when has(.name)
    .kind <-> 3
    .name <-> .name
    default .radius default .extent
  else
    reject "a shape without a form"
  end end end
  .has_speed <-> has(.speed)
  .speed <-> .speed
  .has_note <-> has(.note)
  when has(.note) .note <-> .note else default .note end
"""
)
FLAT = {
    "kind": 0,
    "name": "",
    "radius": 0.0,
    "extent": {"w": 0.0, "h": 0.0},
    "has_speed": False,
    "speed": 0.0,
    "has_note": False,
    "note": "",
}
CASES: list[tuple[dict[str, Any], dict[str, Any]]] = [
    ({"kind": 1, "radius": 2.5, "has_speed": True, "speed": 0.0}, {"circle": {"radius": 2.5}, "speed": 0.0}),
    ({"kind": 1, "has_note": True}, {"circle": {"radius": 0.0}, "note": ""}),
    ({"kind": 2, "extent": {"w": 1.0, "h": 0.0}, "has_note": True, "note": "x"}, {"box": {"w": 1.0, "h": 0.0}, "note": "x"}),
    ({"kind": 3, "name": "cup"}, {"name": "cup"}),
    ({"kind": 3}, {"name": ""}),
]


def programs(mapping: str, backend: str) -> tuple[rj.Decoder, rj.Encoder, rj.Decoder, rj.Encoder]:
    """The programs of the mapping, and those of the wire's own type."""
    texts = {**FILES, "m.mapping": mapping}
    options: dict[str, Any] = {"schema": texts, "backend": backend}
    wire, file = ("lab::Flat", "flat.idl") if mapping is TO_ONEOF else ("lab.Shape", "nested.proto")
    own: dict[str, Any] = {"schema": texts, "imports": [file], "backend": "interpreter"}
    if file == "flat.idl":
        options["encoding"] = own["encoding"] = "cdr"
    made = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    return *made, rj.Decoder.of(wire, **own), rj.Encoder.of(wire, **own)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("mapping", [TO_ONEOF, FROM_ONEOF], ids=["to a oneof", "from a oneof"])
def test_a_oneof_and_optional_fields_told_by_others(mapping, backend):
    decode, encode, read, write = programs(mapping, backend)
    for known, shape in CASES:
        flat = {**FLAT, **known}
        wire, holder = (flat, shape) if mapping is TO_ONEOF else (shape, flat)
        message = write(write.holder_type.from_dict(wire))
        assert decode(message).to_dict() == holder
        assert encode(encode.holder_type.from_dict(holder)) == message
        assert read(message).to_dict() == wire


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_is_of_no_kind_is_rejected(backend):
    decode, encode, _, write = programs(TO_ONEOF, backend)
    with pytest.raises(rj.DecodeError, match="no such kind: 4"):
        decode(write(write.holder_type.from_dict({**FLAT, "kind": 4})))
    with pytest.raises(rj.EncodeError, match="no such kind"):
        encode(encode.holder_type.from_dict({"speed": 1.0}))
    decode, encode, _, write = programs(FROM_ONEOF, backend)
    with pytest.raises(rj.DecodeError, match="a shape without a form"):
        decode(write(write.holder_type.from_dict({"speed": 1.0})))
    with pytest.raises(rj.EncodeError) as error:
        encode(encode.holder_type.from_dict({**FLAT, "kind": 4}))
    assert error.value.kind == "rejected"


def test_laws_of_cases():
    laws = programs(TO_ONEOF, "interpreter")[0].mapping.laws
    assert str(laws.holders) == "exact inverse"
    assert {loss.place for loss in laws.messages.losses} == {".radius", ".extent", ".name", ".speed", ".note"}
    laws = programs(FROM_ONEOF, "interpreter")[0].mapping.laws
    assert str(laws.messages) == "exact inverse"
    assert {loss.place for loss in laws.holders.losses} == {".radius", ".extent", ".name", ".speed", ".note"}


INNER = """syntax = "proto2"; package PACKAGE;
message Inner { optional string a = 1; optional int32 b = 2; required Deep deep = 3; }
message Deep { optional int32 c = 1; }
message Outer { required Inner inner = 1; optional Inner other = 2; required int32 n = 3; }"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_messages_that_the_schema_requires_are_there_where_all_their_fields_are_left_alone(backend: str) -> None:
    """Else the holder were none that its own schema allows; a message that may be absent stays so."""
    texts = {f"{package}.proto": INNER.replace("PACKAGE", package) for package in ("wire", "holder")}
    head = 'import "wire.proto" import "holder.proto" data-holder: holder.Outer wire-schema: wire.Outer '
    left = " ".join(f"ignore .{field} default .{field}" for field in ("inner.a", "inner.b", "inner.deep.c", "other.deep.c"))
    texts["m.mapping"] = f"{head} rules: {left} ignore .other.a default .other.a ignore .other.b default .other.b .n <-> .n"
    decode, encode = (kind("m.mapping", schema=texts, backend=backend) for kind in (rj.Decoder, rj.Encoder))
    write = rj.Encoder.of("wire.Outer", schema=texts, imports=["wire.proto"], backend="interpreter")
    again = rj.Encoder.of("holder.Outer", schema=texts, imports=["holder.proto"], backend="interpreter")
    whole = {"a": "x", "b": 1, "deep": {"c": 2}}
    found = decode(write(write.holder_type.from_dict({"inner": whole, "other": whole, "n": 3})))
    assert found.to_dict() == {"inner": {"deep": {}}, "n": 3}
    empty = write(write.holder_type.from_dict({"inner": {"deep": {}}, "n": 3}))
    assert bytes(again(found)) == bytes(encode(found)) == bytes(empty)
    assert ".inner" not in {loss.place for loss in decode.mapping.laws.messages.losses}
