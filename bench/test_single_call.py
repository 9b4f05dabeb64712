"""One call, one message: what the promise of 2 x `len()` rests on."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from bench.messages import joints_mapping, specialised, tagged
from bench.ratios import best_call_ns


@pytest.fixture(scope="module")
def decoder24(tmp_path_factory):
    return rj.Decoder(joints_mapping(24, tmp_path_factory.mktemp("joints")), encoding="yarp3")


@pytest.fixture(scope="module")
def decoder16(tmp_path_factory):
    return rj.Decoder(joints_mapping(16, tmp_path_factory.mktemp("joints")), encoding="yarp3")


def test_24_specialised_doubles_against_len(decoder24, record, benchmark):
    message = specialised(24)
    assert decoder24(message).angles == pytest.approx(np.radians([10.0 * index - 7.25 for index in range(24)]), rel=1e-6)
    times = best_call_ns({"decode": (decoder24, message), "len": (len, message)})
    record("one call, 24 specialised doubles", times["decode"] / times["len"], 2, "x len()", f"{times['decode']:.0f} ns")
    benchmark.extra_info.update(times)
    benchmark(decoder24, message)


def test_16_tagged_doubles_against_len(decoder16, record, benchmark):
    message = tagged(16)
    times = best_call_ns({"decode": (decoder16, message), "len": (len, message)})
    record("one call, 16 tagged doubles", times["decode"] / times["len"], 3, "x len()", f"{times['decode']:.0f} ns")
    benchmark.extra_info.update(times)
    benchmark(decoder16, message)


def test_against_a_dynamic_decoder(decoder24, record, peers):
    message = specialised(24)
    ours = best_call_ns({"decode": (decoder24, message)})["decode"]
    theirs = peers.dynamic_decode_ns(message)
    record("the same against a dynamic C++ decoder", ours / theirs, 1 / 30, "of it", f"{peers.dynamic_decoder}: {theirs:.0f} ns")


def test_against_hand_written_loops(decoder24, record, peers):
    message = specialised(24)
    ours = best_call_ns({"decode": (decoder24, message)})["decode"]
    loop, copy = peers.loop_decode_ns(message, 266), peers.copy_decode_ns(message, 266)
    record(
        "the same against a C++ loop by hand, inside C++",
        ours / loop,
        None,
        "x",
        f"loop {loop:.1f} ns, header check and memcpy {copy:.1f} ns",
    )
