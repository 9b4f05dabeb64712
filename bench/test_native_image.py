"""An image of a camera, RGB, against moving its pixels: as it is, without padding, with channels swapped, in planes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pytest

import rosetta_jit as rj
from bench.contest import Contender
from bench.messages import HEIGHT, MAPPINGS, WIDTH, anew, image
from bench.peers.native import rounds_of
from bench.peers.yarp_native import Peers

if TYPE_CHECKING:
    from collections.abc import Callable

CHAPTER = "Images"
HEADER = 60
PADDED = 318
"""A width whose rows are padded: 954 bytes to 960."""
OURS, MOVE, LEN = "rosetta_jit", "memmove", "len()"


@dataclass(frozen=True, slots=True)
class Job:
    """What is done to the pixels: by our mapping, by hand in C++, by numpy."""

    what: str
    mapping: str
    at_most: float | None
    native: str
    numpy: Callable[[np.ndarray], np.ndarray]
    width: int = WIDTH


JOBS = (
    Job("image, copied", "image_copied", 1.15, "unpad", lambda pixels: pixels.copy()),
    Job("image of padded rows, unpadded", "image_unpadded", None, "unpad", lambda pixels: pixels.copy(), PADDED),
    Job("image, unpadded and channels swapped", "image_swapped", 1.6, "swap", lambda pixels: pixels[:, :, ::-1].copy()),
    Job("image, made planar", "image_planar", 1.6, "planar", lambda pixels: pixels.transpose(2, 0, 1).copy()),
)


@pytest.mark.parametrize("job", JOBS, ids=lambda job: job.mapping)
def test_image_against_memmove(job, effort, compare, record):
    decode, message, peers = rj.Decoder(MAPPINGS / f"{job.mapping}.mapping", encoding="yarp3"), image(job.width), Peers()
    by_numpy = numpy_decoder(job)
    (by_cpp, pixels), (for_this_machine, same) = (native(peers, job, message, here=here) for here in (False, True))
    assert bytes(decode(message).data) == by_numpy(message).tobytes() == pixels.tobytes() == same.tobytes()

    def decoded():
        return effort.call(rj.Decoder(MAPPINGS / f"{job.mapping}.mapping", encoding="yarp3"), anew(message))

    def moved():
        return effort.call(np.copyto, np.empty(len(message) - HEADER, np.uint8), np.frombuffer(anew(message), np.uint8, offset=HEADER))

    outcome = compare(
        CHAPTER,
        f"{job.what}, {job.width}x{HEIGHT}",
        [
            Contender(OURS, "ours", "an RST image, used again", effort.placed(decoded)),
            Contender(MOVE, "limit", "the pixels, elsewhere", effort.placed(moved)),
            Contender(
                peers.dynamic_decoder,
                "peer",
                "a bottle with a blob, in C++; nothing is converted",
                rounds_of(peers.dynamic(message), effort.round_s),
            ),
            *yarp(peers, message, effort),
            Contender("C++ by hand", "peer", "an array, used again", rounds_of(by_cpp, effort.round_s)),
            Contender("C++ by hand, for this machine", "peer", "an array, used again", rounds_of(for_this_machine, effort.round_s)),
            Contender("numpy, unchecked", "peer", "an array, anew", effort.call(by_numpy, message)),
        ],
    )
    record(job.what, outcome.ratio(OURS, MOVE), job.at_most, "x memmove", f"{outcome.took(OURS).median / 1000:.2f} µs")


def test_borrowed_image_against_len(effort, compare, record):
    decode, message = rj.Decoder(MAPPINGS / "image_copied.mapping", encoding="yarp3", borrow=True), image()
    outcome = compare(
        CHAPTER,
        "image, borrowed",
        [
            Contender(OURS, "ours", "an RST image, used again; its data a view of the message", effort.call(decode, message)),
            Contender(LEN, "limit", "a number", effort.call(len, message)),
        ],
    )
    record("image, borrowed", outcome.ratio(OURS, LEN), 4, "x len()", f"{outcome.took(OURS).median:.0f} ns")


def native(peers, job, message, *, here):
    """The decoder by hand in C++, compiled for this machine or for all of its kind, and what it makes of the message."""
    pixels = np.zeros(job.width * HEIGHT * 3, np.uint8)
    decode = peers.image(job.native, message, pixels, here=here)
    decode(1)
    return decode, pixels


def yarp(peers, message, effort):
    """YARP's own image, where it is installed."""
    read = peers.yarp("image", message)
    if read is not None:
        yield Contender(
            "YARP's Image", "peer", "an image, used again, its rows padded; nothing is converted", rounds_of(read, effort.round_s)
        )


def numpy_decoder(job):
    row = -(-job.width * 3 // 8) * 8

    def decode(message):
        rows = np.frombuffer(message, np.uint8, offset=HEADER).reshape(HEIGHT, row)
        return job.numpy(rows[:, : job.width * 3].reshape(HEIGHT, job.width, 3))

    return decode
