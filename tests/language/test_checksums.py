"""Checksums: each code gives what its catalogue says of the digits 1 to 9, and the common ones what Python's own functions give."""

from __future__ import annotations

import binascii
import random
import zlib

import pytest

import rosetta_jit as rj
from rosetta_jit.functions.checksums import CODES

BACKENDS = ["llvm", "python", "interpreter"]
OF_DIGITS = {
    "CRC-8": 0xF4,
    "CRC-8/AUTOSAR": 0xDF,
    "CRC-8/MAXIM-DOW": 0xA1,
    "CRC-8/SAE-J1850": 0x4B,
    "CRC-16/ARC": 0xBB3D,
    "CRC-16/CCITT-FALSE": 0x29B1,
    "CRC-16/KERMIT": 0x2189,
    "CRC-16/MODBUS": 0x4B37,
    "CRC-16/X-25": 0x906E,
    "CRC-16/XMODEM": 0x31C3,
    "CRC-32": 0xCBF43926,
    "CRC-32/BZIP2": 0xFC891918,
    "CRC-32/MPEG-2": 0x0376E6E7,
    "CRC-32C": 0xE3069283,
}
SCHEMAS = {
    "lab/msg/Frame.msg": "string name\nuint8[] data\nuint32 check\n",
    "h.proto": """syntax = "proto3"; package lab;
message Sum { int64 a = 1; uint32 b = 2; }
message Payload { bytes data = 1; }""",
}
HEAD = 'import "lab/msg/Frame.msg"\nimport "h.proto"\ndata-holder: lab.{}\nwire-schema: lab/msg/Frame\n'


def decoder(a, b="0", backend="llvm"):
    rules = f"unpack-rules:\n  .a = {a}\n  .b = {b}\n  ignore .name\n  ignore .check\n  ignore .data\n"
    decode = rj.Decoder("m.mapping", schema={**SCHEMAS, "m.mapping": HEAD.format("Sum") + rules}, backend=backend)
    write = rj.Encoder.of("lab/msg/Frame", schema=SCHEMAS, imports=["lab/msg/Frame.msg"], backend="interpreter")
    return lambda data: decode(write(write.holder_type.from_dict({"name": "frame", "data": data, "check": 0})))


def test_every_code_has_its_check_value():
    assert CODES.keys() == OF_DIGITS.keys()


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", OF_DIGITS)
def test_of_the_digits(name, backend):
    assert decoder(f'crc(.data, "{name}")', backend=backend)(b"123456789").a == OF_DIGITS[name]


@pytest.mark.parametrize("backend", BACKENDS)
def test_as_python_computes_them(backend):
    run = decoder('crc(.data, "CRC-32")', 'crc(.data, "CRC-16/XMODEM")', backend)
    rng = random.Random(4)
    for size in (0, 1, 2, 3, 7, 64, 301):
        data = rng.randbytes(size)
        found = run(data)
        assert (found.a, found.b) == (zlib.crc32(data), binascii.crc_hqx(data, 0))


@pytest.mark.parametrize("backend", BACKENDS)
def test_of_a_part_and_of_texts(backend):
    run = decoder('crc(slice(.data, 1, len(.data) - 2), "CRC-32")', 'crc(.name + "!", "CRC-32")', backend)
    assert run(b"_123456789..").a == 0xCBF43926
    assert run(b"...").b == zlib.crc32(b"frame!")
    with pytest.raises(rj.DecodeError) as error:
        run(b"_")
    assert error.value.kind == "index"


@pytest.mark.parametrize("backend", BACKENDS)
def test_sums_and_exclusive_ors_are_reductions(backend):
    run = decoder("sum(.data[]) & 255", "uint32(xor(.data[0 to 3]))", backend)
    assert (run(bytes([200, 100, 7])).a, run(bytes([1, 2, 4, 8])).b) == (51, 7)


BOTH = """rules:
  .data <-> .data
unpack-rules:
  reject "the checksum is {.check}" when .check != crc(.data, "CRC-32C")
  ignore .name
pack-rules:
  default .name
  .check = crc(.data, "CRC-32C")
"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_both_ways(backend):
    files = {**SCHEMAS, "m.mapping": HEAD.format("Payload") + BOTH}
    decode, encode = (each("m.mapping", schema=files, backend=backend) for each in (rj.Decoder, rj.Encoder))
    sent = bytearray(encode(encode.holder_type.from_dict({"data": b"123456789"})))
    assert sent[-4:] == OF_DIGITS["CRC-32C"].to_bytes(4, "little")
    assert decode(bytes(sent)).data == b"123456789"
    sent[sent.index(b"9")] ^= 1
    with pytest.raises(rj.DecodeError, match="the checksum is 3808858755") as error:
        decode(bytes(sent))
    assert error.value.kind == "rejected"


@pytest.mark.parametrize("backend", BACKENDS)
def test_as_a_relation(backend):
    """The field of the wire is told by another relation, so that packing checks."""
    rules = 'rules:\n  .data <-> .data\n  .a <-> crc(.data, "CRC-32")\n  ignore .name\n  ignore .check\n'
    schema = {**SCHEMAS, "h.proto": 'syntax = "proto3"; package lab; message Sealed { bytes data = 1; int64 a = 2; }'}
    files = {**schema, "m.mapping": HEAD.format("Sealed") + rules}
    decode, encode = (each("m.mapping", schema=files, backend=backend) for each in (rj.Decoder, rj.Encoder))
    held = {"data": b"123456789", "a": OF_DIGITS["CRC-32"]}
    assert decode(encode(encode.holder_type.from_dict(held))).to_dict() == held
    with pytest.raises(rj.EncodeError) as error:
        encode(encode.holder_type.from_dict({**held, "a": 5}))
    assert error.value.kind == "rejected"
