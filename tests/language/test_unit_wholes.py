"""Units within whole arrays, structs, unions and maps, and of elements that are not alike."""

from __future__ import annotations

import time

import pint
import pytest

import rosetta_jit as rj
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.language.check.mapping import check
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.language.typed import EachElement, Rescale
from rosetta_jit.language.units.wholes import inserted
from rosetta_jit.parsing.search import SearchPath

UREG = pint.UnitRegistry()
BACKENDS = ["llvm", "python", "interpreter"]
HEAD = 'import "w.bottle-schema"\nimport "h.bottle-schema"\ndata-holder: h\nwire-schema: w\n'


def schemas(wire, holder, rules):
    return {"w.bottle-schema": f'"w" ({wire})', "h.bottle-schema": f'"h" ({holder})', "m.mapping": HEAD + rules}


def both_ways(files, values, backend):
    """The holder of a message with these values, and the message that is written of it."""
    options = {"schema": files, "encoding": "yarp4", "backend": backend}
    own = {"schema": files, "imports": ["w.bottle-schema"], "encoding": "yarp4", "backend": "interpreter"}
    decode, encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    write, read = rj.Encoder.of("w", **own), rj.Decoder.of("w", **own)
    held = decode(write(write.holder_type.from_dict(values)))
    return held.to_dict(), read(encode(held)).to_dict()


def found(files, tmp_path):
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    try:
        return [(problem.code, problem) for problem in rj.check(tmp_path / "m.mapping")]
    except rj.MappingError as error:
        return [(problem.code, problem) for problem in error.diagnostics]


def converted(values, sources, targets):
    return [UREG.Quantity(value, source).to(target).magnitude for value, source, target in zip(values, sources, targets, strict=True)]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("length", ["", " (:length 3)"])
@pytest.mark.parametrize(
    ("source", "target"),
    [
        (("degree", "degree", "mm"), ("rad", "rad", "m")),
        (("degree", "degree", "degree"), ("rad", "rad", "rad")),
        (("mm", "cm", "m"), ("m", "m", "m")),
        (("degC", "degF", "K"), ("K", "K", "K")),
    ],
)
def test_arrays(source, target, length, backend):
    wire, holder = (f'("a" (:list :double{length}) (:units {" ".join(f":{unit}" for unit in units)}))' for units in (source, target))
    values = [180.0, -90.0, 250.0]
    held, back = both_ways(schemas(wire, holder, "rules:\n  .a <-> .a\n"), {"a": values}, backend)
    assert held["a"] == pytest.approx(converted(values, source, target), rel=1e-14)
    assert back["a"] == pytest.approx(values, rel=1e-14)


@pytest.mark.parametrize(
    "rules", ["  same names\n", "  .a <-> .a\n", "  len(.a) <-> len(.a)\n  for i from 0 to len(.a)\n    .a[i] <-> .a[i]\n  end\n"]
)
def test_one_unit_for_all_elements(rules):
    files = schemas('("a" (:list :double) (:unit :mm))', '("a" (:list :double) (:unit :m))', f"rules:\n{rules}")
    held, back = both_ways(files, {"a": [1.0, 2.5, 1e6]}, "python")
    assert held["a"] == pytest.approx([0.001, 0.0025, 1000.0], rel=1e-15)
    assert back["a"] == [1.0, 2.5, 1e6]


def test_integers_become_floats():
    held, _ = both_ways(
        schemas(
            '("a" (:list :int) (:unit :mm))', '("a" (:list :double) (:unit :m))', "unpack-rules:\n  .a = .a\npack-rules:\n  len(.a) = 0\n"
        ),
        {"a": [1, 2500]},
        "interpreter",
    )
    assert held["a"] == pytest.approx([0.001, 2.5])


@pytest.mark.parametrize(
    ("wire", "holder", "codes"),
    [
        ("(:list :double) (:unit :m)", "(:list :double) (:unit :s)", ["unit"]),
        ("(:list :double) (:units :m :rad)", "(:list :double) (:units :m :m)", ["unit"]),
        ("(:list :double) (:unit :m)", "(:list :double)", ["one-sided-unit"]),
        ("(:list :double)", "(:list :double) (:units :m)", ["one-sided-unit"]),
        ("(:list :int) (:unit :m)", "(:list :int) (:unit :mm)", []),
        ("(:list :int) (:unit :mm)", "(:list :int) (:unit :m)", ["unit"]),
        ("(:list :int (:length 2)) (:units :m :mm)", "(:list :int (:length 2)) (:unit :mm)", ["unit"]),
        ("(:list :double) (:unit :m)", "(:list :double) (:unit :blurb)", ["unknown-unit"]),
        ("(:list :double) (:units :m :mm)", "(:list :double) (:units :metre :mm)", []),
        ("(:list :double (:length 2)) (:units :m :m)", "(:list :double (:length 2)) (:unit :mm)", []),
    ],
)
def test_whole_arrays_are_checked(wire, holder, codes, tmp_path):
    files = schemas(f'("a" {wire})', f'("a" {holder})', "unpack-rules:\n  .a = .a\n")
    assert [code for code, _ in found(files, tmp_path)] == codes


LOOP = "unpack-rules:\n  for i from 0 to 3\n    .a[i] = {}\n  end\n"
MIXED = "(:list :double (:length 3)) (:units :degree :degree :mm)"


@pytest.mark.parametrize(
    ("holder", "value", "codes"),
    [
        ("(:units :rad :rad :m)", ".a[i]", ["unit"]),
        ("(:unit :rad)", ".a[i]", ["unit"]),
        ("", ".a[i]", ["one-sided-unit"]),
        ("(:units :degree :degree :mm)", ".a[i]", []),
        ("(:units :degree :degree :mm)", ".a[2 - i]", ["unit"]),
        ("(:units :rad :rad :m)", ".a[i] * 0.5", []),
    ],
)
def test_loops_over_elements_of_several_units(holder, value, codes, tmp_path):
    files = schemas(f'("a" {MIXED})', f'("a" (:list :double (:length 3)) {holder})', LOOP.format(value))
    problems = found(files, tmp_path)
    assert [code for code, _ in problems] == codes
    assert all("degree or mm" in problem.message for _, problem in problems)


BOTH = {
    "m.proto": """syntax = "proto3"; package m; import "rosetta_jit/unit.proto";
message V { double x = 1; repeated double more = 2; oneof which { float far = 3; string text = 4; } map<string, double> by = 5; }
message W { V there = 1 [(rosetta_jit.unit) = "mm"]; repeated V all = 2 [(rosetta_jit.unit) = "mm"]; }
message H { V there = 1 [(rosetta_jit.unit) = "m"]; repeated V all = 2 [(rosetta_jit.unit) = "m, mm"]; }""",
    "m.mapping": 'import "m.proto"\ndata-holder: m.H\nwire-schema: m.W\nrules:\n  same names\n',
}


@pytest.mark.parametrize("backend", BACKENDS)
def test_structs_unions_and_maps(backend):
    """The unit of a field is that of all numbers within."""
    options = {"schema": BOTH, "encoding": "protobuf", "backend": backend}
    own = {"schema": BOTH, "imports": ["m.proto"], "encoding": "protobuf", "backend": "interpreter"}
    decode, encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    write, read = rj.Encoder.of("m.W", **own), rj.Decoder.of("m.W", **own)
    one = {"x": 250.0, "more": [1.0, 2.0], "far": 500.0, "by": {"a": 1500.0}}
    other = {"x": 8.0, "more": [], "text": "near", "by": {}}
    values = {"there": one, "all": [one, other, one]}
    message = write(write.holder_type.from_dict(values))
    held = decode(message).to_dict()
    metres = {"x": 0.25, "more": [0.001, 0.002], "far": 0.5, "by": {"a": 1.5}}
    assert held["there"] == metres
    assert held["all"][0] == metres
    assert held["all"][1] == read(message).to_dict()["all"][1]  # in mm on both sides, as the second element
    assert held["all"][2] == read(message).to_dict()["all"][2]  # nothing is said of the third
    assert read(encode(decode(message))).to_dict() == read(message).to_dict()
    partial = write(write.holder_type.from_dict({"there": {"x": 8.0}}))
    assert encode(decode(partial)) == partial  # what is absent stays absent
    assert encode(decode(b"")) == b""


def test_what_was_inserted_can_be_told():
    wire = '("t" :double (:unit :degC)) ("x" :double (:unit :mm)) ("y" :double (:unit :mm)) ("a" (:list :double) (:unit :mm))'
    holder = '("t" :double (:unit :K)) ("x" :float32 (:unit :m)) ("y" :double (:unit :mm)) ("a" (:list :double) (:unit :m))'
    files = schemas(wire, holder, "unpack-rules:\n  .t = .t\n  .x = .x\n  .y = .y * 2.0\n  .a = .a\n")
    search = SearchPath(files=tuple(files.items()))
    checked = check(parse(search.open("m.mapping")), Readers(installed()), search)
    metres = Rescale("mm", "m", 0.001, 0.0)
    assert [inserted(rule) for rule in checked.unpack] == [Rescale("degC", "K", 1.0, 273.15), metres, None, EachElement(metres)]


def test_many_units_take_no_time(tmp_path):
    units = " ".join(f":{'m' if number % 2 else 'mm'}" for number in range(500))
    rules = "".join(f"  .b{number} = .a[len(.a) - {number}]\n" for number in range(500))
    fields = " ".join(f'("b{number}" :double (:unit :m))' for number in range(500))
    files = schemas(f'("a" (:list :double) (:units {units}))', fields, f"unpack-rules:\n{rules}")
    start = time.process_time()
    assert {code for code, _ in found(files, tmp_path)} == {"unit"}
    assert time.process_time() - start < 30


VIA = {
    "m.proto": """syntax = "proto3"; package m; import "rosetta_jit/unit.proto";
message V { double x = 1; double y = 2; } message P { double x = 1; double y = 2; }
message W { V there = 1 [(rosetta_jit.unit) = "mm"]; V here = 2 [(rosetta_jit.unit) = "km"]; }
message H { P there = 1 [(rosetta_jit.unit) = "m"]; P here = 2 [(rosetta_jit.unit) = "m"]; }""",
    "p.mapping": 'import "m.proto"\ndata-holder: m.P\nwire-schema: m.V\nrules:\n  same names\n',
    "m.mapping": """import "m.proto"
data-holder: m.H
wire-schema: m.W
unpack-rules:
  .there = .there via "p.mapping"
  .here = .here via "p.mapping"
""",
}


def test_a_nested_mapping_converts_where_it_is_used():
    own = {"schema": VIA, "imports": ["m.proto"], "encoding": "protobuf", "backend": "interpreter"}
    write = rj.Encoder.of("m.W", **own)
    decode = rj.Decoder("m.mapping", schema=VIA, encoding="protobuf", backend="interpreter")
    held = decode(write(write.holder_type.from_dict({"there": {"x": 250.0, "y": 1.0}, "here": {"x": 2.0, "y": 0.5}}))).to_dict()
    assert held == {"there": {"x": 0.25, "y": 0.001}, "here": {"x": 2000.0, "y": 500.0}}
