"""What a mapping leaves out: warned of, said to be meant, or mapped by name."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.cli import main

FILES = {
    "wire.bottle-schema": """"wire" (("tag" (:vocab :|x|) :|x|) ("head" (:bottle ("seq" :int) ("id" :string)))
    ("a" :int) ("b" :double) ("c" :string) ("d" (:list :double)))""",
    "holder.proto": """syntax = "proto2"; package h;
message Holder { optional int32 a = 1; optional double b = 2; optional string c = 3; repeated double d = 4; optional string note = 5; }""",
}
HEAD = 'import "wire.bottle-schema"\nimport "holder.proto"\ndata-holder: h.Holder\nwire-schema: wire\n'
BACKENDS = ["llvm", "python", "interpreter"]


@pytest.fixture
def mapping(tmp_path):
    def write(rules):
        for name, content in {**FILES, "m.mapping": HEAD + rules}.items():
            (tmp_path / name).write_text(content)
        return tmp_path / "m.mapping"

    return write


def warnings(path):
    return [(found.code, found.message.split("`")[1]) for found in rj.check(path)]


def test_what_is_left_out_is_warned_of(mapping):
    unpack = "unpack-rules:\n  .a = .head.seq\n  .d = .d\n"
    pack = 'pack-rules:\n  .head.seq = .a\n  .head.id = ""\n  .a = int32(len(.d))\n  .b = 0\n  .c = ""\n  len(.d) = 0\n'
    path = mapping(unpack + pack)
    assert sorted(warnings(path)) == sorted(
        [
            *[("never-read", name) for name in (".head.id", ".a", ".b", ".c")],
            *[("left-out", name) for name in (".b", ".c", ".note")],
            *[("never-read", name) for name in (".b", ".c", ".note")],
        ]
    )
    assert main(["check", str(path)]) == 0
    assert main(["check", "--strict", str(path)]) == 1


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_is_meant(mapping, backend):
    path = mapping("rules:\n  same names except .c\n  ignore .head\n  default .note\n  .c <-> .c\n")
    assert warnings(path) == []
    assert main(["check", "--strict", str(path)]) == 0
    decode, encode = rj.Decoder(path, encoding="yarp3", backend=backend), rj.Encoder(path, encoding="yarp3", backend=backend)
    held = {"a": 3, "b": 1.5, "c": "text", "d": [1.0, -0.0]}
    message = encode(encode.holder_type.from_dict(held))
    assert decode(message).to_dict() == held
    wire = rj.Decoder.of("wire", schema=FILES, imports=["wire.bottle-schema"], encoding="yarp3", backend="interpreter")(message).to_dict()
    assert wire.items() >= {"head": {"seq": 0, "id": ""}, **held}.items()


@pytest.mark.parametrize(
    ("rules", "code"),
    [
        ("unpack-rules:\n  same names except .a, .b, .c, .d\n", "no-same-names"),
        ("unpack-rules:\n  same names\n  ignore .nothing\n", "unknown-field"),
        ("unpack-rules:\n  same names\n  same names except .a\n", "set-twice"),
        ("unpack-rules:\n  same names\n  .a = .a\n  .a = .a\n", "set-twice"),
        ("unpack-rules:\n  same names\n  default .a\n  .a = .a\n", "set-twice"),
    ],
)
def test_mistakes(mapping, rules, code):
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder(mapping(rules), backend="interpreter")
    assert code in [problem.code for problem in error.value.diagnostics]


REQUIRED = """syntax = "proto2"; package p;
enum E { A = 3; B = 1; }
message Empty { optional int32 q = 1; }
message Inner { required int32 q = 1; optional int32 r = 2; repeated int32 z = 3; }
message Tree { required double v = 1; repeated Tree sub = 2; }
message All {
  required int32 a = 1; required float f = 2; required string s = 3; required bytes b = 4; required bool t = 5; required E e = 6;
  required int32 da = 11 [default = 9]; required string ds = 13 [default = "hi"]; required bytes db = 14 [default = "yo"];
  required E de = 16 [default = B];
  required Empty m = 21; required Inner n = 22; required Tree tree = 23;
  optional int32 o = 31 [default = 4]; optional Inner om = 32;
}
message One { required int32 x = 1; }
"""
FIELDS = ("a", "f", "s", "b", "t", "e", "da", "ds", "db", "de", "m", "n", "tree", "o", "om")


@pytest.mark.parametrize("backend", ["interpreter", "python", "llvm"])
def test_defaults_of_required_fields_are_there(backend):
    """What proto2 requires is there, 0, empty or with the schema's default; what is optional is not."""
    rules = "".join(f"default .{name}\n" for name in FIELDS)
    head = 'import "p.proto"\ndata-holder: "p.All"\nwire-schema: "p.One"\nunpack-rules:\nignore .x\n'
    files = {"p.proto": REQUIRED, "m.mapping": head + rules}
    found = rj.Decoder("m.mapping", schema=files, encoding="protobuf", backend=backend)(b"\x08\x07")
    numbers = {"a": 0, "f": 0.0, "s": "", "b": b"", "t": False, "e": "A", "da": 9, "ds": "hi", "db": b"yo", "de": "B"}
    wanted = {**numbers, "m": {}, "n": {"q": 0, "z": []}, "tree": {"v": 0.0, "sub": []}}
    assert found.to_dict() == wanted
    files["m.mapping"] = 'import "p.proto"\ndata-holder: "p.One"\nwire-schema: "p.All"\npack-rules:\n' + rules
    encode = rj.Encoder("m.mapping", schema=files, encoding="protobuf", backend=backend)
    read = rj.Decoder.of("p.All", schema=files, imports=["p.proto"], encoding="protobuf", backend="interpreter")
    assert read(encode(encode.holder_type.from_dict({"x": 7}))).to_dict() == wanted


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_required_bytes_have_their_default_whatever_they_are(backend):
    files = {
        "w.bottle-schema": '"w" (("x" :int))',
        "h.proto": r'syntax = "proto2"; package h; message H { required bytes d = 1 [default = "\377\000a\200"]; required int32 x = 2; }',
        "m.mapping": 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: h.H\nwire-schema: w\n'
        "unpack-rules:\n  default .d\n  .x = .x\n",
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding="yarp3", backend=backend)
    write = rj.Encoder.of("w", schema=files, imports=["w.bottle-schema"], encoding="yarp3")
    assert decode(write(write.holder_type.from_dict({"x": 1}))).d == b"\xff\x00a\x80"


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_field_of_each_element_is_left_out(backend):
    files = {
        "w/Point.msg": "float64 x\nfloat64 y\nstring[] tags\n",
        "w/Line.msg": "Point[] points\n",
        "w/Xs.msg": "float64[] x\n",
        "m.mapping": """import "w/Line.msg"
import "w/Xs.msg"
data-holder: w/Xs
wire-schema: w/Line
rules:
  .x[] <-> .points[].x
  ignore .points[].y
  ignore .points[].tags
""",
    }
    decode, encode = (each("m.mapping", schema=files, encoding="ros1", backend=backend) for each in (rj.Decoder, rj.Encoder))
    assert not decode.mapping.warnings
    read = rj.Decoder.of("w/Line", schema=files, imports=["w/Line.msg"], encoding="ros1", backend=backend)
    message = encode(encode.holder_type.from_dict({"x": [1.5, 2.5]}))
    assert read(message).to_dict() == {"points": [{"x": 1.5, "y": 0.0, "tags": []}, {"x": 2.5, "y": 0.0, "tags": []}]}
    assert decode(message).to_dict() == {"x": [1.5, 2.5]}


ELEMENTS = {
    "lab/msg/Part.msg": "float64 x\nstring note\n",
    "lab/msg/Whole.msg": "Part[] parts\nuint32 count\n",
    "w.proto": """syntax = "proto2"; package h;
message P { required double x = 1; optional string memo = 2; }
message W { repeated P parts = 1; required uint32 count = 2; }""",
}
OF_ELEMENTS = 'import "lab/msg/Whole.msg"\nimport "w.proto"\ndata-holder: h.W\nwire-schema: lab/msg/Whole\nrules:\n  .count <-> .count\n'


@pytest.mark.parametrize("rule", [".parts[].x <-> .parts[].x\n  ignore .parts[].note", '.parts <-> .parts via "p.mapping"'])
def test_what_is_left_out_of_elements(rule):
    part = (
        OF_ELEMENTS.replace("h.W", "h.P")
        .replace("lab/msg/Whole\n", "lab/msg/Part\n")
        .replace(".count <-> .count", ".x <-> .x\n  ignore .note")
    )
    files = {**ELEMENTS, "p.mapping": part, "m.mapping": f"{OF_ELEMENTS}  {rule}\n"}
    found = rj.check("m.mapping", schema=files)
    assert [(each.code, each.message.split("`")[1]) for each in found] == [("left-out", ".parts[].memo"), ("never-read", ".parts[].memo")]
    assert [loss.place for loss in found.laws.holders.losses] == [".parts[].memo"]
    meant = rj.check("m.mapping", schema={**files, "m.mapping": f"{OF_ELEMENTS}  {rule}\n  default .parts[].memo\n"})
    assert not meant.warnings
    assert [loss.place for loss in meant.laws.holders.losses] == [".parts[].memo"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_other_cases_of_a_union_are_no_rest(backend):
    files = {
        "wire.bottle-schema": '"wire" (("n" :int))',
        "holder.proto": 'syntax = "proto2"; message H { optional int32 a = 1; oneof kind { int32 number = 2; string text = 3; } }',
        "m.mapping": 'import "wire.bottle-schema"\nimport "holder.proto"\ndata-holder: H\nwire-schema: wire\nunpack-rules:\n'
        "  .number = .n\n  default rest\n",
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding="yarp3", backend=backend)
    write = rj.Encoder.of("wire", schema=files, imports=["wire.bottle-schema"], encoding="yarp3")
    assert decode(write(write.holder_type.from_dict({"n": 3}))).to_dict() == {"number": 3}


def test_a_length_that_is_read_alone():
    text = f"{OF_ELEMENTS.partition('rules:')[0]}unpack-rules:\n  .count = uint32(len(.parts))\n  len(.parts) = 0\n  ignore .count\n"
    found = rj.check("m.mapping", schema={**ELEMENTS, "m.mapping": text})
    assert [(each.code, each.message.split("`")[1]) for each in found if each.code == "never-read"] == [
        ("never-read", ".parts[].x"),
        ("never-read", ".parts[].note"),
    ]
