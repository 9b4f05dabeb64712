"""Indices, loops and whole arrays in rules for both directions, against what plain Python says they mean."""

from __future__ import annotations

import math

import numpy as np
import pytest

import rosetta_jit as rj
from tests.language.pairs import BACKENDS, pair


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_index_that_reads_a_field(backend):
    made = pair(
        '("n" :int) ("values" (:list :double)) ("points" (:list (:bottle ("x" :int) ("y" :double))))',
        "message Point { required int32 x = 1; required double y = 2; } required int32 n = 1; repeated double values = 2;"
        "required double chosen = 3; repeated Point points = 4; required int32 first = 5;",
        """rules:
  .n <-> int32(.n + 1)
  .values <-> .values
  .chosen <-> .values[.n] * 2.0
  len(.points) <-> len(.points)
  for k from 0 to len(.points)
    .points[k].x <-> .points[k].x
    .points[k].y <-> .points[k].y / 2.0
  end
  .first <-> .points[.n].x
""",
        backend,
    )
    wire = {"n": 1, "values": [1.5, 2.5, 3.5], "points": [{"x": 7, "y": 1.0}, {"x": 8, "y": 3.0}]}
    held = made.unpack(**wire)
    assert held == {
        "n": 2,
        "values": wire["values"],
        "chosen": 5.0,
        "points": [{"x": 7, "y": 0.5}, {"x": 8, "y": 1.5}],
        "first": 8,
    }
    assert made.pack(**held) == wire
    assert "as the mapping says" in str(made.refused(**{**held, "chosen": 4.0}))
    assert "as the mapping says" in str(made.refused(**{**held, "first": 7}))
    assert made.refused(**{**held, "n": 9}).kind == "index"


@pytest.mark.parametrize("backend", BACKENDS)
def test_loops_with_offsets_and_chains(backend):
    made = pair(
        '("first" :double) ("rest" (:list :double)) ("deep" (:bottle ("inner" (:bottle ("angle" :double)))))',
        "message In { required double angle = 1; } message Out { required In in = 1; } repeated double all = 1; required Out out = 2;",
        """rules:
  len(.all) <-> len(.rest) + 1
  .all[0] <-> .first
  for i from 1 to len(.rest) + 1
    .all[i] <-> .rest[i - 1]
  end
  .out.in.angle <-> radians(.deep.inner.angle - 3.0) * 2.0
""",
        backend,
    )
    held = made.unpack(first=1.0, rest=[2.0, 3.0], deep={"inner": {"angle": 93.0}})
    assert held["all"] == [1.0, 2.0, 3.0]
    assert held["out"] == {"in": {"angle": pytest.approx(math.pi)}}
    back = made.pack(**held)
    assert (back["first"], back["rest"]) == (1.0, [2.0, 3.0])
    assert back["deep"] == {"inner": {"angle": pytest.approx(93.0)}}
    assert made.refused(all=[], out=held["out"]).kind == "count"


@pytest.mark.parametrize("backend", BACKENDS)
def test_halves_of_an_array(backend):
    """Loops of other ranges over one array set other elements, whatever their variables are called."""
    made = pair(
        '("values" (:list :double (:length 6)))',
        "repeated double low = 1; repeated double high = 2;",
        """rules:
  len(.low) <-> 3
  len(.high) <-> 3
  for i from 0 to 3 .low[i] <-> .values[i] end
  for i from 3 to 6 .high[i - 3] <-> .values[i] end
""",
        backend,
    )
    held = made.unpack(values=[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    assert held == {"low": [1.0, 2.0, 3.0], "high": [4.0, 5.0, 6.0]}
    assert made.pack(**held) == {"values": [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]}


@pytest.mark.parametrize("backend", BACKENDS)
def test_interleaved_pixels_become_planes(backend):
    made = pair(
        '("width" :int) ("height" :int) ("pixels" :blob)',
        "required uint32 width = 1; required uint32 height = 2; required bytes data = 3;",
        """rules:
  .width <-> uint32(.width)
  .height <-> uint32(.height)
  len(.data) <-> .height * .width * 3
  reject "the pixels do not fill the image" when len(.pixels) != .height * .width * 3
  for y from 0 to .height
    for x from 0 to .width
      for c from 0 to 3
        .data[(c * .height + y) * .width + x] <-> .pixels[3 * (y * .width + x) + c]
      end
    end
  end
pack-rules:
  len(.pixels) = .height * .width * 3
""",
        backend,
    )
    image = np.arange(4 * 5 * 3, dtype=np.uint8).reshape(4, 5, 3)
    held = made.unpack(width=5, height=4, pixels=image.tobytes())
    assert held["data"] == np.moveaxis(image, 2, 0).tobytes()
    assert made.pack(**held) == {"width": 5, "height": 4, "pixels": image.tobytes()}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("rules", [".v <-> .v", ".v[] <-> .v[]"])
@pytest.mark.parametrize(
    ("narrow", "wide", "values", "beyond"),
    [(":int16", "int32", [1, -2, 32767], 32768), (":int", "int64", [-(2**31)], 2**31), (":int", "double", [-5, 7], 0.5)],
)
def test_arrays_whose_elements_become_wider(rules, narrow, wide, values, beyond, backend):
    """As scalars do, whole arrays come back where each number fits."""
    made = pair(f'("v" (:list {narrow}))', f"repeated {wide} v = 1;", f"rules:\n{rules}\n", backend)
    assert made.unpack(v=values) == {"v": values}
    assert made.pack(v=values) == {"v": values}
    assert made.pack(v=[]) == {"v": []}
    assert made.decode.mapping.laws.holders.kind == "exact"
    error = made.refused(v=[*values, beyond])
    assert (error.kind, error.path) == ("range", f".v[{len(values)}]")


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_an_element_that_a_field_of_each_message_tells(backend):
    files = {
        "lab/msg/P.msg": "int32 i\nfloat64[] l\n",
        "lab/msg/Q.msg": "int32 i\nfloat64[] l\nfloat64 a\n",
        "lab/msg/Src.msg": "P[] p\n",
        "lab/msg/Dst.msg": "Q[] p\n",
        "m.mapping": """import "lab/msg/Src.msg"
import "lab/msg/Dst.msg"
data-holder: lab/msg/Dst
wire-schema: lab/msg/Src
rules:
  len(.p) <-> len(.p)
  for k from 0 to len(.p)
    .p[k].i <-> .p[k].i
    .p[k].l <-> .p[k].l
    .p[k].a <-> .p[k].l[.p[k].i]
  end
""",
    }
    decode = rj.Decoder("m.mapping", schema=files, backend=backend)
    encode = rj.Encoder("m.mapping", schema=files, backend=backend)
    values = {"p": [{"i": 1, "l": [0.5, 1.5], "a": 1.5}, {"i": 0, "l": [-2.0], "a": -2.0}]}
    assert decode(encode(encode.holder_type.from_dict(values))).to_dict() == values
    values["p"][1]["a"] = 1.5
    with pytest.raises(rj.EncodeError) as error:
        encode(encode.holder_type.from_dict(values))
    assert error.value.kind == "rejected"


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("rules", ["  .xs <-> .xs\n  .n <-> int32(2 * len(.xs))\n", "  .n <-> int32(2 * len(.xs))\n  .xs <-> .xs\n"])
def test_the_length_of_an_array_that_is_assigned_as_a_whole_is_a_check(rules, backend):
    made = pair('("xs" (:list :double))', "required int32 n = 1; repeated double xs = 2;", f"rules:\n{rules}", backend)
    assert str(made.decode.mapping.laws) == "messages: exact inverse\nholders: exact inverse"
    for xs in ([], [1.0, 2.0]):
        assert made.unpack(xs=xs) == {"n": 2 * len(xs), "xs": xs}
        assert made.pack(n=2 * len(xs), xs=xs) == {"xs": xs}
    assert "`.n` is not `int32(2 * len(.xs))`, as the mapping says" in str(made.refused(n=3, xs=[1.0]))
