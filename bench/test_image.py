"""A 320x240 RGB image of a camera, against moving its pixels."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from bench.messages import HEIGHT, MAPPINGS, WIDTH, image
from bench.ratios import best_call_ns, best_ns

PIXELS = (np.arange(WIDTH * HEIGHT * 3) % 251).astype(np.uint8).reshape(HEIGHT, WIDTH, 3)
EXPECTED = {"image_copied": PIXELS, "image_swapped": PIXELS[:, :, ::-1], "image_planar": PIXELS.transpose(2, 0, 1)}


@pytest.mark.parametrize(
    ("mapping", "what", "at_most"),
    [
        ("image_copied", "image, copied", 1.15),
        ("image_swapped", "image, unpadded and channels swapped", 1.6),
        ("image_planar", "image, made planar", 1.6),
    ],
)
def test_image_against_memmove(mapping, what, at_most, record):
    decode, message = rj.Decoder(MAPPINGS / f"{mapping}.mapping", encoding="yarp3"), image()
    assert bytes(decode(message).data) == EXPECTED[mapping].tobytes()
    source, target = np.frombuffer(message, np.uint8, offset=60), np.empty(WIDTH * HEIGHT * 3, np.uint8)
    times = best_ns({"decode": lambda: decode(message), "memmove": lambda: np.copyto(target, source)})
    record(what, times["decode"] / times["memmove"], at_most, "x memmove", f"{times['decode'] / 1000:.2f} µs")


def test_borrowed_image_against_len(record):
    decode, message = rj.Decoder(MAPPINGS / "image_copied.mapping", encoding="yarp3", borrow=True), image()
    times = best_call_ns({"decode": (decode, message), "len": (len, message)})
    record("image, borrowed", times["decode"] / times["len"], 4, "x len()", f"{times['decode']:.0f} ns")
