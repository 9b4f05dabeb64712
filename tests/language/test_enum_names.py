"""Constants of enums by name: as texts and back, exact in both directions, on all backends."""

from __future__ import annotations

from typing import Any

import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
FILES = {
    "lab/msg/State.msg": "string mode\nstring[] modes\nstring label\n",
    "lab.proto": """syntax = "proto3"; package lab;
message State { enum Mode { IDLE = 0; FAST = 3; REVERSE = -2; } Mode mode = 1; repeated Mode modes = 2; string label = 3; }
message Same { enum Gear { option allow_alias = true; LOW = 0; SLOW = 0; HIGH = 1; } Gear gear = 1; string label = 2; }""",
    "rtc.idl": "module RTC { enum Power { OFF, ON }; struct Motor { Power state; }; };",
    "lab/msg/Power.msg": "string power\n",
}
HEAD = 'import "lab/msg/State.msg"\nimport "lab.proto"\n'
OUT_OF_TEXTS = (
    HEAD + "data-holder: lab.State\nwire-schema: lab/msg/State\nrules:\n  .mode <-> lab.State.Mode(.mode)\n"
    "  .modes[] <-> lab.State.Mode(.modes[])\n  .label <-> .label\n"
)
INTO_TEXTS = (
    HEAD
    + 'data-holder: lab/msg/State\nwire-schema: lab.State\nrules:\n  .mode <-> "mode " + text(.mode)\n'
    + ("  .modes[] <-> text(.modes[])\n  .label <-> .label\n")
)


def program(kind: Any, text: str, backend: str = "interpreter", encoding: str = "cdr") -> Any:
    return kind("m.mapping", schema={**FILES, "m.mapping": text}, encoding=encoding, backend=backend)


@pytest.mark.parametrize("backend", BACKENDS)
def test_texts_of_the_wire_are_constants_of_the_holder(backend):
    decode, encode = program(rj.Decoder, OUT_OF_TEXTS, backend), program(rj.Encoder, OUT_OF_TEXTS, backend)
    write = rj.Encoder.of("lab/msg/State", schema=FILES, imports=["lab/msg/State.msg"], encoding="cdr", backend="interpreter")
    assert str(decode.mapping.laws) == "messages: exact inverse\nholders: exact inverse"
    values = {"mode": "REVERSE", "modes": ["FAST", "IDLE", "FAST"], "label": "é"}
    message = write(write.holder_type.from_dict(values))
    assert decode(message).to_dict() == values
    assert encode(decode(message)) == message
    for wrong, path in (({"mode": "fast"}, ".mode"), ({"mode": "IDLE", "modes": ["FAST", ""]}, ".modes[1]")):
        with pytest.raises(rj.DecodeError) as error:
            decode(write(write.holder_type.from_dict({**values, **wrong})))
        assert (error.value.kind, error.value.path) == ("range", path)
        assert "enum lab.State.Mode has no constant of this name" in str(error.value)
    with pytest.raises(rj.EncodeError) as refused:
        encode(encode.holder_type.from_dict({**values, "mode": 7}))
    assert (refused.value.kind, refused.value.path) == ("range", ".mode")


@pytest.mark.parametrize("backend", BACKENDS)
def test_constants_of_the_wire_are_texts_of_the_holder(backend):
    decode = program(rj.Decoder, INTO_TEXTS, backend, "protobuf")
    encode = program(rj.Encoder, INTO_TEXTS, backend, "protobuf")
    assert str(decode.mapping.laws) == "messages: exact inverse\nholders: exact inverse"
    values = {"mode": "mode FAST", "modes": ["IDLE", "REVERSE"], "label": "x"}
    assert decode(encode(encode.holder_type.from_dict(values))).to_dict() == values
    for wrong, kind in (("mode SLOW", "range"), ("FAST", "text")):
        with pytest.raises(rj.EncodeError) as error:
            encode(encode.holder_type.from_dict({**values, "mode": wrong}))
        assert (error.value.kind, error.value.path) == (kind, ".mode")
    write = rj.Encoder.of("lab.State", schema=FILES, imports=["lab.proto"], encoding="protobuf", backend="interpreter")
    with pytest.raises(rj.DecodeError) as refused:
        decode(write(write.holder_type.from_dict({"mode": 1})))
    assert (refused.value.kind, refused.value.path) == ("range", ".mode")


@pytest.mark.parametrize("backend", BACKENDS)
def test_of_several_names_the_first_is_written(backend):
    head = HEAD + "data-holder: lab/msg/State\nwire-schema: lab.Same\n"
    text = head + "unpack-rules:\n  .mode = text(.gear)\n  .label = .label\n  default .modes\npack-rules:\n"
    text += "  .gear = lab.Same.Gear(.mode)\n  .label = .label\n  ignore .modes\n"
    decode, encode = program(rj.Decoder, text, backend, "protobuf"), program(rj.Encoder, text, backend, "protobuf")
    laws = decode.mapping.laws
    assert laws.messages.kind == "exact"
    assert ("of several names of one number the first is written") in [loss.why for loss in laws.holders.losses]
    for name, back in (("LOW", "LOW"), ("SLOW", "LOW"), ("HIGH", "HIGH")):
        assert decode(encode(encode.holder_type.from_dict({"mode": name}))).mode == back


@pytest.mark.parametrize("backend", BACKENDS)
def test_enums_of_omg_idl(backend):
    text = 'import "rtc.idl"\nimport "lab/msg/Power.msg"\ndata-holder: RTC::Motor\nwire-schema: lab/msg/Power\nrules:\n'
    text += "  .state <-> RTC::Power(.power)\n"
    decode, encode = program(rj.Decoder, text, backend), program(rj.Encoder, text, backend)
    for name in ("OFF", "ON"):
        assert decode(encode(decode.holder_type.from_dict({"state": name}))).to_dict() == {"state": name}


def test_what_is_known_is_computed_beforehand():
    text = HEAD + "data-holder: lab/msg/State\nwire-schema: lab.State\nunpack-rules:\n  ignore .mode\n  .modes[] = text(.modes[])\n"
    text += '  .mode = text(lab.State.Mode("FAST"))\n  .label = .label\n'
    decode = program(rj.Decoder, text, encoding="protobuf")
    assert decode(b"").mode == "FAST"
    assert "has no constant" not in decode.stage("kernel").partition(".modes")[0]
