"""A user's own loop in numba over a recording: it decodes each message and reads fields by name; `many` decodes as many messages."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from numba import njit

import rosetta_jit as rj
from bench import varied
from bench.contest import Contender

CHAPTER, LOOP, MANY, MOVED, COUNT = "Numba", "rosetta_jit, a loop of one's own", "its decode, `many(into=)`", "each message copied", 10_000
AT_MOST = {"Imu": 0.3, "JointState, 32 joints": 1.0}
"""Of copying each message, where that takes longer than to read so few bytes."""


def _of(made):
    return made.subject.type, made.subject.decoder(), made.messages


def _torso():
    """Bottles of three degrees, which the mapping turns into radians."""
    messages = [struct.pack("<ii3d", 266, 3, 0.01 * number, -20.0, 30.0 + number % 7) for number in range(1000)]
    return "yarp.icub.torso.state", rj.Decoder("yarp/icub/torso_state.mapping"), messages


READS = {
    "Imu": (lambda: _of(varied.imu(1)), "holder.angular_velocity.z + holder.orientation_covariance[8]"),
    "JointState, 32 joints": (lambda: _of(varied.joint_state(1)), "holder.position[0] + len(holder.name)"),
    "an iCub's torso, as in the README": (_torso, "holder.angles[1] + holder.angles[2]"),
}


@pytest.mark.parametrize("what", READS)
def test_loop(what, effort, compare, record):
    make, expression = READS[what]
    type_, decode, made = make()
    messages = (list(made) * (COUNT // len(made) + 1))[:COUNT]
    recording, offsets = b"".join(messages), np.cumsum([0, *map(len, messages)])
    octets = np.frombuffer(recording, np.uint8)
    batch, holder, run = decode.many(recording, offsets), decode.new(), loop(decode.kernel, expression)
    wanted = sum(float(eval(expression, {"holder": each})) for each in batch)  # noqa: S307 - our own text
    assert run(recording, offsets, holder) == pytest.approx(wanted)
    outcome = compare(
        CHAPTER,
        f"{COUNT:,} messages of {type_}",
        [
            Contender(LOOP, "ours", "a sum of two values of each message", effort.call(run, recording, offsets, holder, messages=COUNT)),
            Contender(
                MANY, "limit", "a batch, used again", effort.call(lambda: decode.many(recording, offsets, into=batch), messages=COUNT)
            ),
            Contender(MOVED, "limit", "a copy", effort.call(copied, octets, offsets, np.empty_like(octets), messages=COUNT)),
        ],
    )
    took = f"{outcome.took(LOOP).median:.0f} ns"
    record(f"{what}, a loop in numba that reads two fields", outcome.ratio(LOOP, MANY), 1.2, "x many", took)
    record(f"{what}, that loop against a copy", outcome.ratio(LOOP, MOVED), AT_MOST.get(what), "x copying each message in numba", took)


def loop(kernel, expression):
    """A compiled function that decodes messages into one holder and adds up what an expression reads of them."""
    scope = {"kernel": kernel}
    exec(  # noqa: S102 - the bench's own text
        "def run(recording, offsets, holder):\n"
        "    total = 0.0\n"
        "    for index in range(len(offsets) - 1):\n"
        "        kernel(recording, holder, offsets[index], offsets[index + 1])\n"
        f"        total += {expression}\n"
        "    return total\n",
        scope,
    )
    return njit(nogil=True)(scope["run"])


@njit(nogil=True)
def copied(octets, offsets, copies):
    """What no loop that reads all of each message gets below."""
    for index in range(len(offsets) - 1):
        copies[offsets[index] : offsets[index + 1]] = octets[offsets[index] : offsets[index + 1]]
