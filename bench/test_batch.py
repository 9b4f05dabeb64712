"""A million messages in one call, against moving their bytes."""

from __future__ import annotations

import numpy as np

import rosetta_jit as rj
from bench.messages import batch, joints_mapping
from bench.ratios import best_ns

COUNT = 1_000_000


def test_many_against_memmove(tmp_path, record):
    decoder = rj.Decoder(joints_mapping(24, tmp_path), encoding="yarp3")
    buffer, offsets = batch(COUNT)
    target = np.empty_like(buffer)
    rows = decoder.many(buffer, offsets)
    assert len(rows) == COUNT
    times = best_ns({"many": lambda: decoder.many(buffer, offsets, into=rows), "memmove": lambda: np.copyto(target, buffer)}, rounds=7)
    record("`many`, 10⁶ such messages", times["many"] / times["memmove"], 1.2, "x memmove", f"{times['many'] / COUNT:.1f} ns a message")
