"""What a thousand decoders of one type hold."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest

import rosetta_jit as rj
from bench.messages import joints_mapping, specialised

COUNT = 1000
STATUS = Path("/proc/self/statm")
PAGE_BYTES = 4096


@pytest.mark.skipif(not STATUS.exists(), reason="reads the resident set from /proc")
def test_a_thousand_decoders(tmp_path, record):
    mapping, message = joints_mapping(24, tmp_path), specialised(24)
    warm = [rj.Decoder(mapping, encoding="yarp3") for _ in range(20)]
    before = resident_bytes()
    decoders = [rj.Decoder(mapping, encoding="yarp3") for _ in range(COUNT)]
    for decode in decoders:
        decode(message)
    held = (resident_bytes() - before) / COUNT
    assert len(warm) + len(decoders) == COUNT + 20
    record("memory of 1,000 decoders of one type, each", held / 1000, None, "KB", "aim 20 KB")


def resident_bytes() -> int:
    gc.collect()
    return int(STATUS.read_text().split()[1]) * PAGE_BYTES
