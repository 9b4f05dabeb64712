"""The checksum is zlib's, whatever the length, the place and the bytes."""

from __future__ import annotations

import zlib

import numpy as np
import pytest

from rosetta_jit.logs import checksum
from rosetta_jit.runtime.code import processor

BYTES = np.random.default_rng(0).integers(0, 256, 100_000).astype(np.uint8)


@pytest.mark.parametrize("least", [64, 4096, 1 << 30])
def test_it_is_that_of_zlib(monkeypatch, least):
    monkeypatch.setattr(checksum, "LEAST", least)
    for size in (*range(300), 4095, 4096, 4097, 65_536, 99_990):
        for begin in (0, 1, 7):
            data = BYTES[begin : begin + size]
            assert checksum.crc32(data) == zlib.crc32(data.data)
    for data in (np.zeros(5000, np.uint8), np.full(5000, 255, np.uint8)):
        assert checksum.crc32(data) == zlib.crc32(data.data)


def test_cpus_that_cannot_fold(monkeypatch):
    for known in ("aarch64-unknown-linux-gnu apple-m1 +neon,+pclmul", "x86_64-linux x86-64 +sse2,-pclmul", "1 0 ff ff 0 0 fd ff"):
        monkeypatch.setattr(processor, "processor", lambda known=known: known)
        assert checksum._fold.__wrapped__() is None
    monkeypatch.setattr(processor, "processor", lambda: "1 0 ff ff 0 0 3 ff")
    assert processor.multiplies_without_carries()
