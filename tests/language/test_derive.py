"""Rules for both directions: what they unpack, what they pack, and what cannot be turned round."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
FILES = {
    "wire.bottle-schema": """"wire" (("kind" :string) ("count" :int) ("steps" :int64) ("celsius" :double) ("flags" :int) ("yaw" :double)
    ("values" (:list :double)) ("points" (:list (:bottle ("x" :double) ("y" :int)))))""",
    "holder.proto": """syntax = "proto2"; package h;
message Holder {
  enum Kind { GRAY = 0; RGB = 1; BGR = 2; }
  message Point { required float x = 1; required int64 y = 2; }
  required Kind kind = 1; required int64 count = 2; required int32 half = 3; required double kelvin = 4; required int32 flags = 5;
  required float yaw = 6; repeated double values = 7; repeated Point points = 8; required string unit = 9; required int32 three = 10;
}""",
}
HEAD = 'import "wire.bottle-schema"\nimport "holder.proto"\ndata-holder: h.Holder\nwire-schema: wire\n'
RULES = """rules:
  .kind <-> table(.kind) { "mono8" = h.Holder.Kind.GRAY, "rgb8" = h.Holder.Kind.RGB, "bgr8" = h.Holder.Kind.BGR }
  .count <-> 10 - .count
  .half <-> int32(.steps * 2)
  .kelvin <-> .celsius + 273.15
  .flags <-> int32(.flags ^ 5)
  .yaw <-> float32(-radians(.yaw))
  .values <-> .values
  len(.points) <-> len(.points)
  for i from 0 to len(.points)
    .points[i].x <-> float32(.points[i].x / 4.0)
    .points[i].y <-> .points[i].y
  end
  .three <-> 3
unpack-rules:
  .unit = "K"
"""
WIRE = {
    "kind": "rgb8",
    "count": 4,
    "steps": 7,
    "celsius": 20.5,
    "flags": 6,
    "yaw": 180.0,
    "values": [1.0, 2.5],
    "points": [{"x": 6.0, "y": -3}],
}
HELD = {
    "kind": "RGB",
    "count": 6,
    "half": 14,
    "kelvin": 293.65,
    "flags": 3,
    "values": [1.0, 2.5],
    "points": [{"x": 1.5, "y": -3}],
    "unit": "K",
    "three": 3,
}


def mapping(tmp_path, rules):
    for name, content in {**FILES, "m.mapping": HEAD + rules}.items():
        (tmp_path / name).write_text(content)
    return tmp_path / "m.mapping"


def wire_of(backend="interpreter"):
    options = {"schema": FILES, "imports": ["wire.bottle-schema"], "encoding": "yarp3", "backend": backend}
    return rj.Decoder.of("wire", **options), rj.Encoder.of("wire", **options)


@pytest.mark.parametrize("backend", BACKENDS)
def test_both_ways(tmp_path, backend):
    path = mapping(tmp_path, RULES)
    decode, encode = rj.Decoder(path, encoding="yarp3", backend=backend), rj.Encoder(path, encoding="yarp3", backend=backend)
    read, write = wire_of()
    held = decode(write(write.holder_type.from_dict(WIRE)))
    found = held.to_dict()
    assert found.pop("yaw") == pytest.approx(-3.1415927)
    assert found == HELD
    back = read(encode(held)).to_dict()
    assert back.pop("celsius") == pytest.approx(20.5)
    assert back.pop("yaw") == pytest.approx(180.0)
    assert back == {name: value for name, value in WIRE.items() if name not in ("celsius", "yaw")}


@pytest.mark.parametrize(
    ("change", "kind", "text"),
    [
        ({"three": 4}, "rejected", "`.three` is not `3`, as the mapping says"),
        ({"half": 3}, "range", "remainder"),
        ({"count": 1 << 40}, "range", "does not fit int32"),
        ({"points": [{"x": 1.0, "y": 1 << 40}]}, "range", "does not fit int32"),
    ],
)
@pytest.mark.parametrize("backend", BACKENDS)
def test_holders_that_nothing_unpacks_to(tmp_path, backend, change, kind, text):
    encode = rj.Encoder(mapping(tmp_path, RULES), encoding="yarp3", backend=backend)
    with pytest.raises(rj.EncodeError, match=text) as error:
        encode(encode.holder_type.from_dict({**HELD, "yaw": 0.0, **change}))
    assert error.value.kind == kind


@pytest.mark.parametrize(("schema", "place"), [("state", ""), ("command", ".angles")])
def test_a_derived_direction_is_what_one_would_write(tmp_path, schema, place):
    """The paper's use case, and its data."""
    written = f"""unpack-rules:
  len(.angles) = 3
  .angles[0] = float32(radians({place}.yaw))
  .angles[1] = float32(radians({place}.roll))
  .angles[2] = float32(radians({place}.pitch))
pack-rules:
  reject "`len(.angles)` is not `3`, as the mapping says" when len(.angles) != 3
  {place}.yaw = degrees(.angles[0])
  {place}.roll = degrees(.angles[1])
  {place}.pitch = degrees(.angles[2])
"""
    derived = re.sub(r"pack-rules:.*", "", written[written.index("len") - 2 :], flags=re.DOTALL).replace(" = ", " <-> ")
    head = f"""import "rst/kinematics/JointAngles.proto"
import "yarp/icub/torso_{schema}.bottle-schema"
data-holder: rst.kinematics.JointAngles
wire-schema: yarp.icub.torso.{schema}
"""
    (tmp_path / "written.mapping").write_text(head + written)
    (tmp_path / "derived.mapping").write_text(f"{head}rules:\n{derived}")

    def kernels(name):
        programs = rj.Decoder(tmp_path / name), rj.Encoder(tmp_path / name, encoding="yarp4")
        return [re.sub(r"\w+\.mapping:\d+:\d+", "", program.stage("kernel")) for program in programs]

    assert kernels("derived.mapping") == kernels("written.mapping")


OPERATIONS = st.recursive(
    st.just(".x"),
    lambda inner: st.tuples(
        st.sampled_from(["({} + {})", "({} - {})", "({1} - {0})", "({1} + {0})", "(-{})", "({} ^ {})", "int64({})"]),
        inner,
        st.integers(-99, 99),
    ).map(lambda made: made[0].format(made[1], made[2] if made[2] >= 0 else f"({made[2]})")),
    max_leaves=6,
)


@settings(max_examples=40, deadline=None)
@given(expression=OPERATIONS, values=st.lists(st.integers(-(2**40), 2**40), min_size=1, max_size=5))
def test_pack_undoes_unpack(tmp_path_factory, expression, values):
    folder = tmp_path_factory.mktemp("laws")
    (folder / "w.bottle-schema").write_text('"w" (("x" :int64))')
    (folder / "h.proto").write_text('syntax = "proto2"; message H { required int64 x = 1; }')
    text = f'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\nrules:\n  .x <-> {expression}\n'
    (folder / "m.mapping").write_text(text)
    options = {"encoding": "yarp3", "backend": "interpreter"}
    decode, encode = rj.Decoder(folder / "m.mapping", **options), rj.Encoder(folder / "m.mapping", **options)
    write = rj.Encoder.of("w", imports=["w.bottle-schema"], search_path=[folder], **options)
    for value in values:
        message = write(write.holder_type.from_dict({"x": value}))
        assert encode(decode(message)) == message


@pytest.mark.parametrize(
    ("rule", "code"),
    [
        (".kelvin <-> .celsius * .yaw", "several-fields"),
        (".kelvin <-> floor(.celsius)", "no-inverse"),
        (".kelvin <-> min(.celsius, 3)", "no-inverse"),
        (".count <-> .count % 7", "no-inverse"),
        (".count <-> .count + .count", "no-inverse"),
        (".count <-> .count & 5", "no-inverse"),
        (".kelvin <-> .celsius if .yaw > 1 else 1.0", "alike-blocks"),
        ("for i from 0 to .count .points[i].y <-> .points[i].y end", "unknown-bound"),
        ("for i from 0 to 2 .points[.count].y <-> .points[i].y end", "index-reads"),
    ],
)
def test_what_cannot_be_turned_round(tmp_path, rule, code):
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder(mapping(tmp_path, f"rules:\n  {rule}\n"), backend="interpreter")
    assert code in [problem.code for problem in error.value.diagnostics]
