"""From a holder to bytes."""

from __future__ import annotations

import rosetta_jit as rj
from bench.messages import joints_mapping, specialised
from bench.ratios import best_call_ns


def test_encode_against_len(tmp_path, record, benchmark):
    mapping = joints_mapping(24, tmp_path)
    message = specialised(24)
    angles = rj.Decoder(mapping, encoding="yarp3")(message)
    encode = rj.Encoder(mapping, encoding="yarp3")
    assert len(encode(angles)) == len(message)
    times = best_call_ns({"encode": (encode, angles), "len": (len, message)})
    record("`encode`, one call, 24 doubles", times["encode"] / times["len"], 3, "x len()", f"{times['encode']:.0f} ns")
    benchmark.extra_info.update(times)
    benchmark(encode, angles)
