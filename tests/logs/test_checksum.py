"""The checksum is zlib's, whatever the length, the place and the bytes."""

from __future__ import annotations

import zlib

import numpy as np
import pytest

from rosetta_jit.logs.reading import checksum
from rosetta_jit.runtime.code import processor


def answers(usable_ecx, usable_ebx_7, usable_ecx_7):
    """As glibc has the answers to CPUID 1 and 7: four words that the processor gave, four with what can be used."""
    words = [1, 0, 0xFF, 0xFF, 0, 0, usable_ecx, 0xFF, 0, ~0 & 0xFFFFFFFF, ~0 & 0xFFFFFFFF, 0, 0, usable_ebx_7, usable_ecx_7, 0]
    return " ".join(f"{word:x}" for word in words)


def fold_of(bits):
    """As `checksum._fold` on a CPU that can do so much."""
    return {0: lambda: None, 128: lambda: checksum._compiled("fold.ll", 64), 512: lambda: checksum._compiled("fold_wide.ll", 256)}[bits]


BYTES = np.random.default_rng(0).integers(0, 256, 100_000).astype(np.uint8)


@pytest.mark.parametrize("bits", [0, 128, 512])
@pytest.mark.parametrize("least", [64, 4096, 1 << 30])
def test_it_is_that_of_zlib(monkeypatch, least, bits):
    if bits > processor.carryless_bits():
        pytest.skip(f"the CPU has no registers of {bits} bits to multiply without carries in")
    monkeypatch.setattr(checksum, "LEAST", least)
    monkeypatch.setattr(checksum, "_fold", fold_of(bits))
    for size in (*range(300), *range(508, 530), 4095, 4096, 4097, 65_536, 99_990):
        for begin in (0, 1, 7):
            data = BYTES[begin : begin + size]
            assert checksum.crc32(data) == zlib.crc32(data.data)
    for data in (np.zeros(5000, np.uint8), np.full(5000, 255, np.uint8)):
        assert checksum.crc32(data) == zlib.crc32(data.data)


@pytest.mark.parametrize(
    ("known", "bits"),
    [
        ("aarch64-unknown-linux-gnu apple-m1 +neon,+pclmul", 0),
        ("x86_64-linux x86-64 +sse2,-pclmul", 0),
        ("x86_64-linux haswell +avx2,+pclmul,-vpclmulqdq", 128),
        ("x86_64-linux znver3 +pclmul,+vpclmulqdq,-avx512f", 128),
        ("x86_64-linux znver4 +pclmul,+vpclmulqdq,+avx512f", 512),
        (answers(0xFD, 0, 0), 0),
        (answers(0x03, 0, 0), 128),
        (answers(0x03, 1 << 16, 0), 128),
        (answers(0x03, 0, 1 << 10), 128),
        (answers(0x03, 1 << 16, 1 << 10), 512),
        (answers(0xFD, 1 << 16, 1 << 10), 0),
    ],
)
def test_what_cpus_can(monkeypatch, known, bits):
    monkeypatch.setattr(processor, "processor", lambda: known)
    assert processor.carryless_bits() == bits
    found = checksum._fold.__wrapped__
    monkeypatch.setattr(checksum, "_compiled", lambda _, block: block)
    assert found() == {0: None, 128: 64, 512: 256}[bits]
