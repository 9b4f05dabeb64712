"""Units of fields: conversions that are inserted, and mistakes that are found."""

from __future__ import annotations

import math

import pytest

import rosetta_jit as rj
from rosetta_jit.language.units.dimensions import USUAL, conversion

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


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
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


def test_an_integer_that_may_become_a_fraction_takes_a_word(tmp_path):
    path = files(tmp_path, "mm", "m", "unpack-rules:\n  .y = .x\n", (":int", ":int"))
    with pytest.raises(rj.MappingError, match="a whole number of mm need not be one of m"):
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


TWO = '"w" (("x" :double (:unit :m)) ("z" :double (:unit :mm)) ("t" :double (:unit :s)) ("w" :double (:unit :degree)) ("n" :double))'


@pytest.mark.parametrize(
    ("rule", "words"),
    [
        (".y = .x + .z", "write `x * 0.001` to have the second in m"),
        (".y = .x - .t", "they measure different things"),
        (".y = .x % .z", "`%` has one value in m and one in mm"),
        (".y = max(.x, 1.0, .z)", "`max` has one value in m"),
        (".y = .x if .x < .z else 1.0", "`<` has one value in m"),
        (".y = .x if .n < 1.0 else .z", "a choice has one value in m"),
        (".y = .x if .x == .t else 1.0", "they measure different things"),
        (".y = sin(.w)", "`sin` takes radians, and this is in degree"),
        (".y = .x + .n", ""),
        (".y = .x + .z * 0.001", ""),
        (".y = sin(radians(.w))", ""),
        (".y = .x if .t > 2.0 else 1.0", ""),
    ],
)
def test_arithmetic(tmp_path, rule, words):
    path = files(tmp_path, "m", "m", f"unpack-rules:\n  {rule}\n")
    (tmp_path / "w.bottle-schema").write_text(TWO)
    try:
        found = [each for each in rj.check(path) if each.code != "never-read"]
    except rj.MappingError as error:
        found = [each for each in error.diagnostics if each.severity == "error"]
    assert len(found) == (1 if words else 0)
    assert words in "".join(f"{each.message} {each.help}" for each in found)


def test_a_difference_of_temperatures_has_no_offset(tmp_path):
    path = files(tmp_path, "degC", "kelvin", "unpack-rules:\n  .y = .x - .x\n")
    with pytest.raises(rj.MappingError, match="no place on the scale of kelvin"):
        rj.check(path)


@pytest.mark.parametrize(
    ("source", "target", "expected"),
    [
        ("degC", "K", (1.0, 273.15)),
        ("degF", "K", (5 / 9, 459.67 * 5 / 9)),
        ("rpm", "rad/s", (math.tau / 60, 0.0)),
        ("Hz", "rad/s", None),  # 1 Hz is 2π rad/s to most, and 1 to pint
        ("dBm", "mW", None),  # a logarithm
        ("m", "blurb", "blurb"),
        ("10**10**10", "m", "10**10**10"),
        ("m^-2", "m**-2", (1.0, 0.0)),
        ("m^99", "s", None),
    ],
)
def test_conversions(source, target, expected):
    found = conversion(source, target)
    assert found == (pytest.approx(expected, rel=1e-15) if isinstance(expected, tuple) else expected)


def test_usual_units_are_known():
    assert all(conversion(unit, unit, same=False) == (1.0, 0.0) for unit in USUAL)


@pytest.mark.parametrize(("relation", "read"), [(".d + 5.0", 0.105), ("5.0 - .d", -0.095), ("-(.d + 5.0)", -0.105)])
@pytest.mark.parametrize(("wire", "holder"), [("double", "double"), ("float32", "double"), ("double", "float32")])
def test_a_constant_is_in_the_unit_of_the_field_that_a_relation_reads(relation, read, wire, holder):
    files = {
        "a.bottle-schema": f'"a" (("d" :{wire} (:unit :mm)))',
        "b.bottle-schema": f'"b" (("d" :{holder} (:unit :m)))',
        "m.mapping": f'import "a.bottle-schema"\nimport "b.bottle-schema"\ndata-holder: b\nwire-schema: a\nrules:\n  .d <-> {relation}\n',
    }
    decode, encode = (make("m.mapping", schema=files, encoding="yarp4") for make in (rj.Decoder, rj.Encoder))
    write, read_back = (make.of("a", schema=files, imports=["a.bottle-schema"], encoding="yarp4") for make in (rj.Encoder, rj.Decoder))
    found = decode(write(write.holder_type.from_dict({"d": 100.0})))
    assert found.d == pytest.approx(read)
    assert read_back(encode(found)).d == pytest.approx(100.0)
    assert decode.mapping.laws.messages.kind == "rounded"


def test_a_constant_beside_an_integer_in_another_unit_is_refused():
    files = {
        "a.bottle-schema": '"a" (("d" :int32 (:unit :mm)))',
        "b.bottle-schema": '"b" (("d" :double (:unit :m)))',
        "m.mapping": 'import "a.bottle-schema"\nimport "b.bottle-schema"\ndata-holder: b\nwire-schema: a\nrules:\n  .d <-> .d + 5.0\n',
    }
    with pytest.raises(rj.MappingError, match="what is added is in mm"):
        rj.Encoder("m.mapping", schema=files, encoding="yarp4")
