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
