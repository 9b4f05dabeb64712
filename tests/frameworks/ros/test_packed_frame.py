"""Bytes with a checksum as they go over a serial line: what a rejection asks for is what packing writes."""

from __future__ import annotations

import struct

import pytest

import rosetta_jit as rj

FRAME = "packed/checked_frame.mapping"


def modbus(data: bytes) -> int:
    """CRC-16/MODBUS bit by bit."""
    found = 0xFFFF
    for byte in data:
        found ^= byte
        for _ in range(8):
            found = found >> 1 ^ (0xA001 if found & 1 else 0)
    return found


@pytest.mark.parametrize("backend", ["llvm", "python"])
@pytest.mark.parametrize("data", [b"", b"123456789", bytes(range(256)) * 3])
def test_frames(data: bytes, backend: str) -> None:
    decode, encode = (made(FRAME, encoding="ros1", backend=backend) for made in (rj.Decoder, rj.Encoder))
    sent = struct.pack(f"<HI{len(data)}sH", 0x5AA5, len(data), data, modbus(data))
    held = encode.holder_type.from_dict({"data": data})
    assert encode(held) == sent
    assert decode(sent).to_dict() == held.to_dict()
    for at in {0, len(sent) - 1}:
        damaged = bytearray(sent)
        damaged[at] ^= 0x10
        with pytest.raises(rj.DecodeError, match="no start of a frame" if at == 0 else "the frame is damaged"):
            decode(bytes(damaged))


def test_what_does_not_come_back() -> None:
    laws = rj.check(FRAME, framework="ros1").laws
    assert laws is not None
    assert str(laws.messages) == "exact inverse"
    assert [loss.place for loss in laws.holders.losses] == [".layout"]
