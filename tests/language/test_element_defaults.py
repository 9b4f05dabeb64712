"""`default .a[].b` and `default rest`: fields of elements, and elements, that no rule sets."""

from __future__ import annotations

from typing import Any

import pytest

import rosetta_jit as rj
from tests.language.pairs import BACKENDS, pair
from tests.random_mappings.fields import written

POINTS = '("points" (:list (:bottle ("x" :double) ("y" :double) ("label" :string)))) ("n" :int)'


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("rest", ["ignore .points[].y\n  ignore .points[].label\n  ignore .n", "ignore rest"])
def test_what_is_ignored_of_elements_is_packed_as_its_default(rest: str, backend: str) -> None:
    made = pair(POINTS, "repeated double x = 1;", f"rules:\n  .x[] <-> .points[].x\n  {rest}\n", backend)
    points = [{"x": float(x), "y": 1.0, "label": "here"} for x in range(3)]
    assert made.unpack(points=points, n=2) == {"x": [0.0, 1.0, 2.0]}
    assert made.pack(x=[0.0, 1.0]) == {"points": [{"x": 0.0, "y": 0.0, "label": ""}, {"x": 1.0, "y": 0.0, "label": ""}], "n": 0}
    assert made.pack(x=[]) == {"points": [], "n": 0}
    assert str(made.decode.mapping.laws.holders) == "exact inverse"
    losses = [loss.place for loss in made.decode.mapping.laws.messages.losses]
    assert losses == [".points[].y", ".points[].label", ".n"]


def test_in_one_direction_and_within_arrays_in_arrays() -> None:
    made = pair(
        '("rows" (:list (:bottle ("cells" (:list (:bottle ("a" :int) ("b" :int)))) ("c" :int))))',
        "repeated int32 sizes = 1;",
        """unpack-rules:
  .sizes[] = int32(len(.rows[].cells))
pack-rules:
  len(.rows) = len(.sizes)
  for i from 0 to len(.sizes)
    len(.rows[i].cells) = .sizes[i]
    for j from 0 to .sizes[i]
      .rows[i].cells[j].a = int32(10 * i + j)
    end
  end
  default .rows[].cells[].b
  default .rows[].c
""",
    )
    rows = [{"cells": [{"a": 0, "b": 0}, {"a": 1, "b": 0}], "c": 0}, {"cells": [{"a": 10, "b": 0}], "c": 0}]
    assert made.pack(sizes=[2, 1]) == {"rows": rows}


def test_elements_that_the_schema_gives_a_default() -> None:
    files = {
        "lab/msg/Part.msg": "float64 x\nfloat64 w 1.0\nstring name 'part'\n",
        "lab/msg/Parts.msg": "Part[] parts\n",
        "h.proto": 'syntax = "proto3"; message H { repeated double x = 1; }',
        "m.mapping": 'import "lab/msg/Parts.msg"\nimport "h.proto"\ndata-holder: H\nwire-schema: lab/msg/Parts\n'
        "rules:\n  .x[] <-> .parts[].x\n  ignore rest\n",
    }
    encode = rj.Encoder("m.mapping", schema=files, backend="interpreter")
    read = rj.Decoder.of("lab/msg/Parts", schema=files, imports=["lab/msg/Parts.msg"], backend="interpreter")
    assert read(encode(encode.holder_type.from_dict({"x": [2.0]}))).to_dict() == {"parts": [{"x": 2.0, "w": 1.0, "name": "part"}]}


@pytest.mark.parametrize("backend", BACKENDS)
def test_elements_beside_that_no_key_names(backend: str) -> None:
    made = pair(
        '("name" (:list :string)) ("position" (:list :double)) ("velocity" (:list :double))',
        "required double elbow = 1; required double wrist = 2; required double speed = 3;",
        """rules:
  .elbow <-> .position[.name[] = "elbow"]
  .wrist <-> .position[.name[] = "wrist"]
  .speed <-> .velocity[.name[] = "wrist"]
  ignore rest
""",
        backend,
    )
    packed = made.pack(elbow=1.0, wrist=2.0, speed=3.0)
    assert packed == {"name": ["elbow", "wrist"], "position": [1.0, 2.0], "velocity": [0.0, 3.0]}
    assert made.unpack(**packed) == {"elbow": 1.0, "wrist": 2.0, "speed": 3.0}


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_default_of_the_elements_of_a_holder_is_ignored_to_pack(backend: str) -> None:
    files = {
        "lab/msg/Spot.msg": "float64 x\n",
        "lab/msg/Spots.msg": "Spot[] spots\n",
        "h.proto": """syntax = "proto2";
message P { required double x = 1; required string note = 2; }
message Out { repeated P spots = 1; }""",
        "m.mapping": """import "lab/msg/Spots.msg"
import "h.proto"
data-holder: Out
wire-schema: lab/msg/Spots
rules:
  .spots[].x <-> .spots[].x
  default .spots[].note
""",
    }
    decode, encode = (made("m.mapping", schema=files, backend=backend) for made in (rj.Decoder, rj.Encoder))
    message = encode(encode.holder_type.from_dict({"spots": [{"x": 1.5, "note": "lost"}, {"x": -2.0, "note": ""}]}))
    assert decode(message).to_dict() == {"spots": [{"x": 1.5, "note": ""}, {"x": -2.0, "note": ""}]}
    assert [loss.place for loss in decode.mapping.laws.holders.losses] == [".spots[].note"]


NUMBERS = {
    "lab/msg/Part.msg": "int8 a\nfloat64 b\nInner c\nint16 d\n",
    "lab/msg/Inner.msg": "int16 e\nint64 f\nbool g\n",
    "lab/msg/Parts.msg": "Part[] parts\nfloat64 x\n",
    "h.proto": 'syntax = "proto3"; message H { repeated int32 d = 1; double x = 2; }',
    "m.mapping": """import "lab/msg/Parts.msg"
import "h.proto"
data-holder: H
wire-schema: lab/msg/Parts
rules:
  .d[] <-> .parts[].d
  .x <-> .x
  ignore rest
""",
}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("encoding", "order"), [("ros1", None), ("cdr", "big"), ("cdr2", "little")])
def test_every_byte_of_a_message_is_written(encoding: str, order: Any, backend: str) -> None:
    """Also where rules work on the message in place, and the numbers of an element are left alone, and those beside them."""
    encode = rj.Encoder("m.mapping", schema=NUMBERS, encoding=encoding, byte_order=order, backend=backend)
    message = written(encode, {"d": [1, -2, 3], "x": 0.5})
    read = rj.Decoder.of("lab/msg/Parts", schema=NUMBERS, imports=["lab/msg/Parts.msg"], encoding=encoding, backend="interpreter")
    nothing = {"a": 0, "b": 0.0, "c": {"e": 0, "f": 0, "g": False}}
    parts = [{**nothing, "d": number} for number in (1, -2, 3)]
    assert read(message).to_dict() == {"parts": parts, "x": 0.5}


LEFT_ALONE = {
    "lab/msg/Inner.msg": "int16 e\nint64 f\n",
    "lab/msg/Deep.msg": "Inner g\nbool h\n",
    "lab/msg/Parts.msg": "Part[] parts\n",
    "h.proto": 'syntax = "proto3"; message H { repeated int32 d = 1; }',
    "m.mapping": """import "lab/msg/Parts.msg"
import "h.proto"
data-holder: H
wire-schema: lab/msg/Parts
rules:
  .d[] <-> .parts[].d
  ignore rest
""",
}


@pytest.mark.parametrize("encoding", ["ros1", "cdr", "cdr2"])
@pytest.mark.parametrize("type_", ["bool", "float32", "Inner", "Deep", "bool[3]", "Deep[2]", "Deep[]", "string", "string[2]"])
def test_whatever_an_element_is_left_with_is_written(type_: str, encoding: str) -> None:
    files = {**LEFT_ALONE, "lab/msg/Part.msg": f"{type_} left\nint16 d\n"}
    encode = rj.Encoder("m.mapping", schema=files, encoding=encoding, backend="interpreter")
    message = written(encode, {"d": [1, -2, 3]})
    write = rj.Encoder.of("lab/msg/Parts", schema=files, imports=["lab/msg/Parts.msg"], encoding=encoding, backend="interpreter")
    assert message == bytes(write(write.holder_type.from_dict({"parts": [{"d": number} for number in (1, -2, 3)]})))
