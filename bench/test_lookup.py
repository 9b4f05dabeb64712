"""Elements by key: positions of joints by their names, in an order of one's own, against a loop of numba's over the same bytes."""

from __future__ import annotations

import numba
import numpy as np
import pytest

import rosetta_jit as rj
from bench.contest import Contender

CHAPTER = "Mappings"
OURS, BY_HAND = "rosetta_jit", "numba, by hand"
AT_MOST = 1.2
MESSAGES = 2000
"""Each has its joints in another order."""


def mapping(joints):
    keys = ", ".join(f'"{each}"' for each in joints)
    return f"""import "ros1/sensor_msgs/JointState.msg"
import "chain.proto"
parameter joints: list of string = [{keys}]
data-holder: Chain
wire-schema: sensor_msgs/JointState
unpack-rules:
  len(.angles) = len(joints)
  for i from 0 to len(joints)
    .angles[i] = .position[.name[] = joints[i]]
  end
  ignore .header
  ignore .velocity
  ignore .effort
"""


@numba.njit
def u32(data, at):
    return np.int64(data[at]) | np.int64(data[at + 1]) << 8 | np.int64(data[at + 2]) << 16 | np.int64(data[at + 3]) << 24


@numba.njit
def looked_up(data, keys, ends, angles, starts):
    """The position of each key; -1 or what is wrong. All lengths are checked, each name is compared with each key that has its length."""
    end = data.shape[0]
    if end < 16:
        return 1
    at = 16 + u32(data, 12)
    if at + 4 > end:
        return 1
    count = u32(data, at)
    at += 4
    if count > starts.shape[0]:
        return 2
    for i in range(count):
        if at + 4 > end or at + 4 + u32(data, at) > end:
            return 1
        starts[i] = at
        at += 4 + u32(data, at)
    if at + 4 > end or u32(data, at) != count or at + 4 + 8 * count > end:
        return 3
    positions = data[at + 4 : at + 4 + 8 * count].view(np.float64)
    first = 0
    for key in range(ends.shape[0]):
        size, found = ends[key] - first, -1
        for i in range(count):
            start = starts[i]
            if u32(data, start) == size:
                k = 0
                while k < size and data[start + 4 + k] == keys[first + k]:
                    k += 1
                if k == size:
                    if found >= 0:
                        return 4
                    found = i
        if found < 0:
            return 5
        angles[key] = positions[found]
        first = ends[key]
    return -1


@numba.njit
def all_looked_up(data, offsets, keys, ends, angles, starts):
    """As many messages as are good."""
    for i in range(offsets.shape[0] - 1):
        if looked_up(data[offsets[i] : offsets[i + 1]], keys, ends, angles[i], starts) >= 0:
            return i
    return offsets.shape[0] - 1


@pytest.mark.parametrize("count", [7, 32])
def test_joints_by_name(count, effort, compare, record):
    joints = [f"arm_joint_{number}" for number in range(count)]
    files = {
        "chain.proto": 'syntax = "proto2"; message Chain { repeated double angles = 1 [packed = true]; }',
        "chain.mapping": mapping(joints),
    }
    decode = rj.Decoder("chain.mapping", schema=files, encoding="ros1")
    write = rj.Encoder.of("sensor_msgs/JointState", encoding="ros1")
    rng = np.random.default_rng(0)
    orders = [rng.permutation(count) for _ in range(MESSAGES)]
    sent = [write(write.holder_type.from_dict({"name": [joints[i] for i in order], "position": order + 0.5})) for order in orders]
    data, offsets = b"".join(sent), np.concatenate([[0], np.cumsum([len(each) for each in sent])])
    keys, ends = np.frombuffer("".join(joints).encode(), np.uint8), np.cumsum([len(each) for each in joints])
    angles, starts, octets = np.empty((MESSAGES, count)), np.empty(64, np.int64), np.frombuffer(data, np.uint8)
    batch = decode.many(data, offsets)
    assert all_looked_up(octets, offsets, keys, ends, angles, starts) == MESSAGES
    assert np.array_equal(angles, np.tile(np.arange(count) + 0.5, (MESSAGES, 1)))
    assert all(np.array_equal(each.angles, angles[0]) for each in batch)

    def ours():
        decode.many(data, offsets, into=batch)

    def by_hand():
        all_looked_up(octets, offsets, keys, ends, angles, starts)

    what = f"mapping, {count} joints by their names"
    outcome = compare(
        CHAPTER,
        what,
        [
            Contender(OURS, "ours", "objects of another type, used again", effort.call(ours, messages=MESSAGES, different=MESSAGES)),
            Contender(BY_HAND, "limit", "arrays, used again", effort.call(by_hand, messages=MESSAGES, different=MESSAGES)),
        ],
    )
    record(what, outcome.ratio(OURS, BY_HAND), AT_MOST, "x numba by hand", f"{outcome.took(OURS).median:.0f} ns a message")
