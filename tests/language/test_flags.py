"""Bits and digits of one integer: each relation takes some of them, and together they pack the integer."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from tests.language.pairs import BACKENDS

STATUS = "uint8 READY = 1\nuint8 HOT = 2\nuint8 status\n"


def programs(fields: str, rules: str, message: str = STATUS, backend: str = "interpreter"):
    """A decoder, an encoder, and what reads and writes the message as it is."""
    files = {
        "lab/msg/W.msg": message,
        "h.proto": f'syntax = "proto2"; package lab; enum Mode {{ OFF = 0; SLOW = 1; FAST = 2; }} message H {{ {fields} }}',
        "m.mapping": f'import "lab/msg/W.msg"\nimport "h.proto"\ndata-holder: lab.H\nwire-schema: lab/msg/W\nrules:\n{rules}\n',
    }
    own = {"schema": files, "imports": ["lab/msg/W.msg"], "backend": "interpreter"}
    decode, encode = (made("m.mapping", schema=files, backend=backend) for made in (rj.Decoder, rj.Encoder))
    return decode, encode, rj.Decoder.of("lab/msg/W", **own), rj.Encoder.of("lab/msg/W", **own)


@pytest.mark.parametrize("backend", BACKENDS)
def test_flags_by_name_and_what_is_above_them(backend):
    fields = "required bool ready = 1; required bool cold = 2; required int32 rest = 3;"
    rules = "  .ready <-> .status & lab/msg/W.READY != 0\n  .cold <-> .status & W.HOT == 0\n  .rest <-> int32(.status >> 2)"
    decode, encode, read, write = programs(fields, rules, backend=backend)
    assert str(decode.mapping.laws) == "messages: exact inverse\nholders: exact inverse"
    for status in range(256):
        holder = decode(write(write.holder_type.from_dict({"status": status})))
        assert holder.to_dict() == {"ready": status & 1 == 1, "cold": status & 2 == 0, "rest": status >> 2}
        assert read(encode(holder)).status == status
    for rest, kind in ((64, "range"), (-1, "range")):
        with pytest.raises(rj.EncodeError) as error:
            encode(encode.holder_type.from_dict({"ready": True, "cold": True, "rest": rest}))
        assert (error.value.kind, error.value.path) == (kind, ".status")


@pytest.mark.parametrize(
    ("test", "means"),
    [
        (".status & 4 != 0", True),
        (".status & 4 == 4", True),
        ("bool(.status >> 2 & 1)", True),
        (".status >> 2 & 1 == 1", True),
        ("0 != 4 & .status", None),
        ("not (.status & 4 == 0)", True),
        (".status & 4 != 4", False),
    ],
)
def test_each_way_to_ask_for_a_bit(test, means):
    if means is None:
        with pytest.raises(rj.MappingError):
            programs("required bool flag = 1;", f"  .flag <-> {test}")
        return
    decode, encode, read, write = programs("required bool flag = 1;", f"  .flag <-> {test}")
    for status, is_set in ((4, True), (0, False)):
        message = write(write.holder_type.from_dict({"status": status}))
        assert decode(message).flag is (is_set == means)
        assert encode(decode(message)) == message
    assert str(decode.mapping.laws.holders) == "exact inverse"
    assert str(decode.mapping.laws.messages) == "lossy\n  .status: what no relation takes of it comes back as 0"
    assert read(encode(decode(write(write.holder_type.from_dict({"status": 0xFF}))))).status == 4


@pytest.mark.parametrize("backend", BACKENDS)
def test_enums_and_scaled_numbers(backend):
    fields = "required Mode mode = 1; required double volts = 2; required bool ok = 3;"
    rules = "  .mode <-> lab.Mode(.n >> 1 & 3)\n  .volts <-> (.n & 0x7ff0) * 0.0625 - 40\n  .ok <-> .n & 1 == 1"
    decode, encode, read, write = programs(fields, rules, "uint16 n\n", backend)
    for n in (0, 1, 0x7FF5, 0x1233, 0x10):
        holder = decode(write(write.holder_type.from_dict({"n": n})))
        assert holder.to_dict() == {"mode": ["OFF", "SLOW", "FAST"][n >> 1 & 3], "volts": (n & 0x7FF0) * 0.0625 - 40, "ok": n & 1 == 1}
        assert read(encode(holder)).n == n & 0x7FF7
    for wrong in ({"volts": -41.0}, {"volts": -39.5}, {"volts": 2008.0}):
        with pytest.raises(rj.EncodeError) as error:
            encode(encode.holder_type.from_dict({"mode": "OFF", "volts": 0.0, "ok": False, **wrong}))
        assert error.value.kind in ("range", "rejected")


def test_digits_of_three():
    fields = "required int32 h = 1; required int32 m = 2; required int32 s = 3;"
    rules = "  .h <-> int32(floor_divide(.n, 3600))\n  .m <-> int32(modulo(floor_divide(.n, 60), 60))\n  .s <-> int32(modulo(.n, 60))"
    decode, encode, read, write = programs(fields, rules, "int32 n\n")
    assert str(decode.mapping.laws) == "messages: exact inverse\nholders: exact inverse"
    for n in (0, 59, 60, 3599, 3600, -1, -3601, 2**31 - 1, -(2**31)):
        holder = decode(write(write.holder_type.from_dict({"n": n})))
        assert holder.to_dict() == {"h": n // 3600, "m": n // 60 % 60, "s": n % 60}
        assert read(encode(holder)).n == n
    for wrong in ({"m": 60}, {"s": -1}):
        with pytest.raises(rj.EncodeError, match="is not from 0 to 59"):
            encode(encode.holder_type.from_dict({"h": 0, "m": 0, "s": 0, **wrong}))


def test_bits_of_each_element():
    rules = "  .low[] <-> uint32(.n[] & 0x7fffffff)\n  .high[] <-> .n[] >> 31 & 1 == 1"
    decode, encode, _, write = programs("repeated uint32 low = 1; repeated bool high = 2;", rules, "uint32[] n\n")
    assert str(decode.mapping.laws) == "messages: exact inverse\nholders: exact inverse"
    message = write(write.holder_type.from_dict({"n": [0, 1, 2**31, 2**32 - 1]}))
    assert decode(message).to_dict() == {"low": [0, 1, 0, 2**31 - 1], "high": [False, False, True, True]}
    assert encode(decode(message)) == message


def test_a_bit_of_a_larger_part_is_a_check():
    rules = "  .mode <-> int32(.status >> 4)\n  .fast <-> .status & 16 != 0"
    _, encode, read, _ = programs("required int32 mode = 1; required bool fast = 2;", rules)
    assert read(encode(encode.holder_type.from_dict({"mode": 3, "fast": True}))).status == 48
    with pytest.raises(rj.EncodeError) as error:
        encode(encode.holder_type.from_dict({"mode": 2, "fast": True}))
    assert error.value.kind == "rejected"


def test_a_relation_to_all_of_it_counts():
    rules = "  .all <-> .status\n  .fast <-> .status & 16 != 0"
    decode, encode, read, _ = programs("required uint32 all = 1; required bool fast = 2;", rules)
    assert str(decode.mapping.laws) == "messages: exact inverse\nholders: exact inverse"
    assert read(encode(encode.holder_type.from_dict({"all": 0x91, "fast": True}))).status == 0x91


JOINED = "bool ready\nuint8 mode\nuint16 turns\n"


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    "joined",
    [
        "uint32(int32(.ready) | .mode << 1 | .turns << 4)",
        "uint32(.turns << 4 | (.mode << 1 | int32(.ready)))",
        "uint32((.turns << 3 | .mode) << 1 | int32(.ready))",
    ],
)
def test_an_integer_of_several_fields(joined, backend):
    decode, encode, read, write = programs("required uint32 status = 1;", f"  .status <-> {joined}", JOINED, backend)
    assert str(decode.mapping.laws.messages) == "exact inverse"
    for ready, mode, turns in ((False, 0, 0), (True, 7, 65535), (True, 2, 4096)):
        message = write(write.holder_type.from_dict({"ready": ready, "mode": mode, "turns": turns}))
        assert decode(message).status == ready | mode << 1 | turns << 4
        assert encode(decode(message)) == message
    with pytest.raises(rj.DecodeError) as error:  # its bits would be those of `.turns`
        decode(write(write.holder_type.from_dict({"ready": True, "mode": 8, "turns": 0})))
    assert error.value.kind == "rejected"
    assert "`.mode` is not from 0 to 7" in str(error.value)
    with pytest.raises(rj.EncodeError) as refused:
        encode(encode.holder_type.from_dict({"status": 1 << 20}))
    assert refused.value.kind == "range"
    assert read(encode(encode.holder_type.from_dict({"status": 0x1234F}))).turns == 0x1234


def test_bits_of_fields_that_other_rules_know_may_overlap():
    rules = "  .low <-> .mode\n  .high <-> .turns\n  .status <-> uint32(.mode | .turns << 1)"
    fields = "required uint32 status = 1; required uint32 low = 2; required uint32 high = 3;"
    decode, encode, _, write = programs(fields, rules, JOINED.replace("bool ready\n", ""))
    message = write(write.holder_type.from_dict({"mode": 2, "turns": 1}))
    assert decode(message).status == 2
    assert encode(decode(message)) == message
    rules = "  .status <-> uint32(.mode | .turns << 1)\npack-rules:\n  .mode = uint8(.status)\n  .turns = 0"
    decode, _, _, write = programs("required uint32 status = 1;", rules, JOINED.replace("bool ready\n", ""))
    assert decode(write(write.holder_type.from_dict({"mode": 2, "turns": 1}))).status == 2


def test_bits_need_no_conversion_to_what_holds_them():
    fields = "required int32 low = 1; required int32 high = 2; required int32 rest = 3; required double most = 4;"
    rules = "  .low <-> .n & 0x7fff\n  .high <-> .n >> 16\n  .rest <-> modulo(.k, 100)\nunpack-rules:\n  .most = max(.a[]) * 0.5\n"
    rules += "pack-rules:\n  ignore .most\n  default .a"
    decode, encode, read, write = programs(fields, rules, "uint32 n\nint64 k\nuint16[] a\n")
    holder = decode(write(write.holder_type.from_dict({"n": 0x12345678, "k": -1, "a": [3, 65535]})))
    assert holder.to_dict() == {"low": 0x5678, "high": 0x1234, "rest": 99, "most": 32767.5}
    assert read(encode(holder)).n == 0x12345678
    for value in (".n & 0xffffffff", "modulo(.k, 3000000000)", ".k >> 40"):
        with pytest.raises(rj.MappingError, match="lossy-conversion"):
            programs("required int32 low = 1;", f"  .low <-> {value}", "uint32 n\nint64 k\n")


def test_all_bits_above_meet_floats():
    decode, encode, read, write = programs("required double volts = 1;", "  .volts <-> (.n >> 8) * 0.0625", "uint32 n\n")
    for n in (0, 0x100, 0xFFFFFF00):
        holder = decode(write(write.holder_type.from_dict({"n": n})))
        assert (holder.volts, read(encode(holder)).n) == ((n >> 8) * 0.0625, n)
    with pytest.raises(rj.EncodeError) as error:
        encode(encode.holder_type.from_dict({"volts": (1 << 24) * 0.0625}))
    assert error.value.kind == "range"
