"""Units of fields: conversions that are inserted, and mistakes that are found."""

from __future__ import annotations

import math

import pytest

import rosetta_jit as rj

HEAD = 'import "w.bottle-schema"\nimport "h.bottle-schema"\ndata-holder: h\nwire-schema: w\n'


def field(unit, type_=":double"):
    return f'{type_} (:unit "{unit}")' if unit else type_


def files(tmp_path, source, target, rules, types=(":double", ":double")):
    (tmp_path / "w.bottle-schema").write_text(f'"w" (("x" {field(source, types[0])}))')
    (tmp_path / "h.bottle-schema").write_text(f'"h" (("y" {field(target, types[1])}))')
    (tmp_path / "m.mapping").write_text(HEAD + rules)
    return tmp_path / "m.mapping"


def write(tmp_path, value):
    encode = rj.Encoder.of("w", imports=["w.bottle-schema"], search_path=[tmp_path], encoding="yarp4", backend="interpreter")
    return encode(encode.holder_type.from_dict({"x": value}))


@pytest.mark.parametrize("backend", ["numba", "python", "interpreter"])
@pytest.mark.parametrize(
    ("source", "target", "value", "expected"),
    [
        ("degree", "radian", 180.0, math.pi),
        ("radian", "degree", math.pi / 2, 90.0),
        ("mm", "m", 250.0, 0.25),
        ("degC", "kelvin", 20.0, 293.15),
        ("N*cm", "N*m", 50.0, 0.5),
        ("m", "metre", -0.0, -0.0),
    ],
)
def test_both_directions(tmp_path, source, target, value, expected, backend):
    path = files(tmp_path, source, target, "rules:\n  .y <-> .x\n")
    decode, encode = rj.Decoder(path, encoding="yarp4", backend=backend), rj.Encoder(path, encoding="yarp4", backend=backend)
    message = write(tmp_path, value)
    held = decode(message)
    assert held.y == pytest.approx(expected)
    back = rj.Decoder.of("w", imports=["w.bottle-schema"], search_path=[tmp_path], encoding="yarp4", backend="interpreter")(encode(held))
    assert back.x == pytest.approx(value)


@pytest.mark.parametrize(
    ("source", "target", "rule", "code"),
    [
        ("m", "s", ".y = .x", "unit"),
        ("radian", "radian", ".y = radians(.x)", "unit"),
        ("degree", "degree", ".y = degrees(.x)", "unit"),
        ("m", "radian", ".y = radians(.x)", "unit"),
        ("degree", "m", ".y = radians(.x)", "unit"),
    ],
)
def test_mistakes(tmp_path, source, target, rule, code):
    with pytest.raises(rj.MappingError) as error:
        rj.check(files(tmp_path, source, target, f"unpack-rules:\n  {rule}\n"))
    assert [problem.code for problem in error.value.diagnostics] == [code]


def test_integers_are_converted_by_hand(tmp_path):
    path = files(tmp_path, "mm", "m", "unpack-rules:\n  .y = .x\n", (":int", ":int"))
    with pytest.raises(rj.MappingError, match="no float"):
        rj.check(path)


@pytest.mark.parametrize(
    ("source", "target", "rule", "codes"),
    [
        ("m", "", ".y = .x", ["one-sided-unit"]),
        ("", "m", ".y = -.x", ["one-sided-unit"]),
        ("m", "", ".y = .x * 2.0", []),
        ("degree", "", ".y = radians(.x)", []),
        ("degree", "radian", ".y = radians(.x)", []),
        ("m", "furlongish", ".y = .x", ["unknown-unit"]),
        ("10**10**10", "m", ".y = .x", ["unknown-unit"]),
        ("m", "m", ".y = max(.x, 0.0)", []),
    ],
)
def test_warnings(tmp_path, source, target, rule, codes):
    found = rj.check(files(tmp_path, source, target, f"unpack-rules:\n  {rule}\n"))
    assert [problem.code for problem in found] == codes
