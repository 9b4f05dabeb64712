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
BACKENDS = ["numba", "python", "interpreter"]


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
