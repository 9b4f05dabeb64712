"""`rounding: float32`: float64 becomes float32 throughout a mapping, in numbers, elements and whole arrays, and the law says so."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from tests.language.test_laws import files
from tests.language.test_parse import LISTING

BACKENDS = ["llvm", "python", "interpreter"]
WIRE = '("x" :double) ("a" (:list :double)) ("b" (:list :double)) ("n" :int)'
HOLDER = "required float x = 1; repeated float a = 2; repeated float b = 3; required float y = 4;"
RULES = "rules:\n  .x <-> .x * 0.1\n  .a <-> .a\n  .b[] <-> radians(.b[])\n  .y <-> .n\nunpack-rules:\n"
SCHEMA = """"yarp.icub.torso.command"
( ("action" (:vocab :|set|) :|set|)
  ("mode" (:vocab :|poss|) :|poss|)
  ("angles" (:bottle ("a0" :double (:unit :degree)) ("a1" :double (:unit :degree)) ("a2" :double (:unit :degree)))) )"""
PUBLISHED = {
    "rst/kinematics/JointAngles.proto": 'syntax = "proto2"; package rst.kinematics; message JointAngles { repeated float angles = 1; }',
    "bottle-structure-icub-torso-command.bottle-schema": SCHEMA,
}


def with_rounding(rules: str) -> dict[str, str]:
    found = files(WIRE, HOLDER, rules)
    return {**found, "m.mapping": f"rounding: float32\n{found['m.mapping']}"}


@pytest.mark.parametrize("backend", BACKENDS)
def test_float32_is_set_to_what_float64_rounds_to(backend):
    text = with_rounding(RULES.replace(".y <-> .n", ".y <-> float32(.n)"))
    decode = rj.Decoder("m.mapping", schema=text, encoding="yarp3", backend=backend)
    write = rj.Encoder.of("wire", schema=text, imports=["wire.bottle-schema"], encoding="yarp3", backend="interpreter")
    found = decode(write(write.holder_type.from_dict({"x": 1.0, "a": [0.1, 1e300], "b": [180.0], "n": 3})))
    with np.errstate(over="ignore"):
        assert found.x == np.float32(0.1)
        assert list(found.a) == [np.float32(0.1), np.inf]
    assert list(found.b) == [np.float32(np.pi)]
    assert decode.mapping is not None
    assert not decode.mapping.warnings, "0.1 is meant to be rounded"
    laws = decode.mapping.laws
    assert laws is not None
    assert {place for place, _ in laws.messages.rounded} == {".x", ".a[]", ".b[]"}
    assert laws.holders.kind in ("exact", "rounded")


def test_other_conversions_take_their_words_still():
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema=with_rounding(RULES), encoding="yarp3", backend="interpreter")
    assert [each.code for each in error.value.diagnostics] == ["lossy-conversion"]
    assert "int32 does not always fit float32" in str(error.value)


def test_a_mapping_that_is_used_rounds_where_it_says_so_itself():
    inner = {
        "inner.proto": 'syntax = "proto2"; package h; message Point { required float x = 1; }',
        "p/msg/Point.msg": "float64 x\n",
        "p/msg/Path.msg": "Point[] points\n",
        "path.proto": 'syntax = "proto2"; package h; import "inner.proto"; message Path { repeated Point points = 1; }',
        "point.mapping": 'import "inner.proto"\nimport "p/msg/Point.msg"\ndata-holder: h.Point\nwire-schema: p/msg/Point\n'
        "rules:\n  .x <-> .x\n",
        "m.mapping": 'import "path.proto"\nimport "p/msg/Path.msg"\ndata-holder: h.Path\nwire-schema: p/msg/Path\n'
        'rules:\n  .points <-> .points via "point.mapping"\n',
    }
    rounds = {name: f"rounding: float32\n{text}" for name, text in inner.items() if name.endswith(".mapping")}
    with pytest.raises(rj.MappingError):
        rj.Decoder("m.mapping", schema={**inner, "m.mapping": rounds["m.mapping"]}, backend="interpreter")
    decode = rj.Decoder("m.mapping", schema={**inner, "point.mapping": rounds["point.mapping"]}, backend="interpreter")
    encode = rj.Encoder("m.mapping", schema={**inner, "point.mapping": rounds["point.mapping"]}, backend="interpreter")
    path = decode.holder_type.from_dict({"points": [{"x": 0.5}, {"x": -1.5}]})
    assert decode(encode(path)).to_dict() == path.to_dict()


def test_a_parameter_may_be_called_so():
    text = with_rounding(RULES.replace(".y <-> .n", ".y <-> float32(.n * rounding)"))["m.mapping"]
    text = text.replace("rules:", "parameter rounding: float32 = 2.0\nrules:", 1)
    decode = rj.Decoder("m.mapping", schema={**with_rounding(""), "m.mapping": text}, encoding="yarp3", backend="interpreter")
    assert decode.mapping is not None


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_listing_of_the_paper_with_all_three_angles(backend):
    text = f"rounding: float32\n{LISTING}  .angles[2] = .angles.a2\n"
    decode = rj.Decoder("torso.mapping", schema={**PUBLISHED, "torso.mapping": text}, encoding="yarp3", backend=backend)
    own = {"schema": PUBLISHED, "imports": ["bottle-structure-icub-torso-command.bottle-schema"]}
    write = rj.Encoder.of("yarp.icub.torso.command", encoding="yarp3", backend="interpreter", **own)
    values = {"angles": {"a0": 0.1, "a1": 2.0, "a2": -3.0}}
    assert list(decode(write(write.holder_type.from_dict(values))).angles) == [np.float32(0.1), 2.0, -3.0]
    assert decode.mapping is not None
    assert {each.code for each in decode.mapping.warnings} == {"one-sided-unit"}
    with pytest.raises(rj.MappingError):
        rj.Decoder("torso.mapping", schema={**PUBLISHED, "torso.mapping": text.partition("\n")[2]}, encoding="yarp3")
