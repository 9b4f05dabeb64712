"""Enums of several frameworks in one mapping: their constants by name, compared and chosen, where a wire holds them in any width."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
FILES = {
    "rtc.idl": "module RTC { enum Power { OFF, ON, AUTO }; struct Command { Power state; double level; }; };",
    "lab.proto": """syntax = "proto3"; package lab;
message Command { enum Mode { IDLE = 0; ACTIVE = 3; } Mode mode = 1; double level = 2; bool on = 3; }""",
}
HEAD = 'import "rtc.idl"\nimport "lab.proto"\ndata-holder: lab.Command\nwire-schema: RTC::Command\n'
RULES = """rules:
  .mode <-> table(.state) { RTC::OFF = lab.Command.Mode.IDLE, RTC::Power::ON = lab.Command.ACTIVE }
  .level <-> .level
unpack-rules:
  reject "unlikely" when .state == RTC::Power.AUTO
  .on = .state != RTC::OFF
pack-rules:
  ignore .on
"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_constants_of_omg_idl(backend):
    options = {"schema": {**FILES, "m.mapping": HEAD + RULES}, "encoding": "cdr", "backend": backend, "byte_order": "little"}
    decode, encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    for mode in ("IDLE", "ACTIVE"):
        held = {"mode": mode, "level": 0.5, "on": mode == "ACTIVE"}
        assert decode(encode(encode.holder_type.from_dict(held))).to_dict() == held
    write = rj.Encoder.of("RTC::Command", imports=["rtc.idl"], **{**options, "backend": "interpreter"})
    with pytest.raises(rj.DecodeError) as error:
        decode(write(write.holder_type.from_dict({"state": "AUTO", "level": 0.5})))
    assert error.value.kind == "rejected"


def test_names_that_are_suggested_can_be_written():
    wrong = RULES.replace("RTC::OFF =", "RTC.OFF =").replace("lab.Command.ACTIVE", "lab.Command.ACTIV")
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema={**FILES, "m.mapping": HEAD + wrong}, encoding="cdr", backend="interpreter")
    assert "did you mean `RTC::OFF`?" in str(error.value)
    assert "did you mean `lab.Command.ACTIVE`?" in str(error.value)


@pytest.mark.parametrize("package", ["", "lab"])
def test_an_enum_of_no_package_is_turned_round_too(package):
    name = f"{package}." if package else ""
    files = {
        "lab/msg/Goal.msg": "uint8 status\nstring word\n",
        "h.proto": f'syntax = "proto2"; {f"package {package};" if package else ""} enum Kind {{ LOW = 0; HIGH = 5; }}\n'
        "message Held { required Kind kind = 1; required Kind named = 2; }",
        "m.mapping": f'import "lab/msg/Goal.msg"\nimport "h.proto"\ndata-holder: {name}Held\nwire-schema: lab/msg/Goal\n'
        f"rules:\n  .kind <-> {name}Kind(.status)\n  .named <-> {name}Kind(.word)\n",
    }
    encode, decode = (each("m.mapping", schema=files, encoding="ros1", backend="interpreter") for each in (rj.Encoder, rj.Decoder))
    held = {"kind": "HIGH", "named": "LOW"}
    message = encode(encode.holder_type.from_dict(held))
    assert message == b"\x05\x03\0\0\0LOW"
    assert decode(message).to_dict() == held


@pytest.mark.parametrize("backend", BACKENDS)
def test_one_enum_becomes_another_by_number_in_both_directions(backend):
    files = {
        "rtc.idl": "module RTC { enum Power { OFF, ON, AUTO }; struct Command { Power state; }; };",
        "lab.proto": """syntax = "proto2"; package lab; enum Mode { IDLE = 0; ACTIVE = 1; BROKEN = 9; }
message Command { required Mode mode = 1; }""",
        "m.mapping": f"{HEAD}rules:\n  .mode <-> lab.Mode(int32(.state))\n",
    }
    decode, encode = (each("m.mapping", schema=files, backend=backend) for each in (rj.Decoder, rj.Encoder))
    for name in ("IDLE", "ACTIVE"):
        assert decode(encode(encode.holder_type.from_dict({"mode": name}))).to_dict() == {"mode": name}
    with pytest.raises(rj.EncodeError) as error:
        encode(encode.holder_type.from_dict({"mode": "BROKEN"}))
    assert (error.value.kind, error.value.path) == ("range", ".state")
