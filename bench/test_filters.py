"""Filters: points and ranges that are kept, against numpy's masks; arrays made of others, against what numpy has for each."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from bench.contest import Contender

CHAPTER = "Filters"
NUMPY = "numpy"
OURS, MASKED, GIVEN = "rosetta_jit", "numpy, mask and a[mask]", "numpy, a[mask]"
AT_MOST = 1.2
COUNT = 100_000
FILES = {
    "lab/msg/Point.msg": "float32 x\nfloat32 y\nfloat32 z\nfloat32 intensity\n",
    "lab/msg/Cloud.msg": "Point[] points\n",
    "lab/msg/Scan.msg": "float32[] ranges\nfloat32[] intensities\n",
    "cloud.mapping": 'import "lab/msg/Cloud.msg"\ndata-holder: lab/msg/Cloud\nwire-schema: lab/msg/Cloud\nunpack-rules:\n'
    + "".join(
        f"  .points[].{name} = .points[].{name} where isfinite(.points[].x) and isfinite(.points[].y) and isfinite(.points[].z)\n"
        for name in ("x", "y", "z", "intensity")
    ),
    "scan.mapping": 'import "lab/msg/Scan.msg"\ndata-holder: lab/msg/Scan\nwire-schema: lab/msg/Scan\nunpack-rules:\n'
    "  .ranges = .ranges where .ranges[] < 0.5\n  .intensities = .intensities where .ranges[] < 0.5\n",
}


def sequence(array):
    """A sequence of ROS 1: how many elements, and their bytes."""
    return np.uint32(len(array)).tobytes() + array.tobytes()


@pytest.mark.parametrize("kept", ["half, at random", "99 %"])
def test_points_against_numpy(kept, effort, compare, record):
    rng = np.random.default_rng(0)
    cloud = rng.random((COUNT, 4), np.float32)
    cloud[rng.random(COUNT) < (0.5 if "half" in kept else 0.01), 0] = np.nan
    message, decode = sequence(cloud), rj.Decoder("cloud.mapping", schema=FILES, encoding="ros1")
    points = np.frombuffer(message, "<f4", offset=4).reshape(-1, 4)

    def mask():
        return np.isfinite(points[:, 0]) & np.isfinite(points[:, 1]) & np.isfinite(points[:, 2])

    held, known = decode(message), mask()
    assert np.array_equal([each.intensity for each in held.points[:100]], points[known][:100, 3])
    assert len(held.points) == known.sum()
    others = (MASKED, lambda: points[mask()]), (GIVEN, lambda: points[known])
    contest(f"{COUNT:,} points, {kept}", lambda: decode(message), others, (effort, compare, record))


@pytest.mark.parametrize("kept", ["half, at random", "the nearer half, sorted"])
def test_ranges_against_numpy(kept, effort, compare, record):
    rng = np.random.default_rng(0)
    ranges, intensities = rng.random(COUNT, np.float32), rng.random(COUNT, np.float32)
    if "sorted" in kept:
        ranges.sort()
    message, decode = sequence(ranges) + sequence(intensities), rj.Decoder("scan.mapping", schema=FILES, encoding="ros1")
    known = ranges < 0.5
    held = decode(message)
    assert np.array_equal(held.ranges, ranges[known])
    assert np.array_equal(held.intensities, intensities[known])

    def masked():
        near = ranges < 0.5
        return ranges[near], intensities[near]

    others = (MASKED, masked), (GIVEN, lambda: (ranges[known], intensities[known]))
    contest(f"{COUNT:,} ranges with intensities, {kept}", lambda: decode(message), others, (effort, compare, record))


def contest(subject, ours, others, bench):
    effort, compare, record = bench
    contenders = [Contender(OURS, "ours", "a holder, used again", effort.call(ours))]
    contenders += [Contender(name, "peer", "an array, anew", effort.call(call)) for name, call in others]
    outcome = compare(CHAPTER, subject, contenders)
    took = f"{outcome.took(OURS).median / COUNT:.2f} ns an element"
    record(f"a filter, {subject}", outcome.ratio(OURS, others[0][0]), AT_MOST, "x numpy", took)


MADE_FILES = {
    "lab/msg/In.msg": "int32[] numbers\nuint16[] counts\nuint8[] octets\n",
    "lab/msg/Numbers.msg": "int32[] numbers\n",
    "lab/msg/Flags.msg": "bool[] flags\n",
    "lab/msg/Octets.msg": "uint8[] octets\n",
}
MADE = {
    "deltas": ("Numbers", ".numbers = deltas(.numbers)", lambda n, _c, _o: np.diff(n, prepend=np.int32(0))),
    "running_sums": ("Numbers", ".numbers = running_sums(.numbers)", lambda n, _c, _o: np.cumsum(n, dtype=np.int32)),
    "bits": ("Flags", ".flags = bits(.octets)", lambda _n, _c, o: np.unpackbits(o, bitorder="little")),
    "repeated": ("Octets", ".octets = repeated(.octets, .counts)", lambda _n, c, o: np.repeat(o, c)),
}


@pytest.mark.parametrize("name", MADE)
def test_arrays_made_of_others(name, effort, compare, record):
    holder, rule, peer = MADE[name]
    rng = np.random.default_rng(0)
    numbers = rng.integers(-100, 100, COUNT if holder == "Numbers" else 0, np.int32)
    octets = rng.integers(0, 101, COUNT // 20 if name == "repeated" else COUNT // 8 if name == "bits" else 0, np.uint8)
    counts = rng.integers(1, 40, len(octets) if name == "repeated" else 0, np.uint16)
    text = f'import "lab/msg/In.msg"\nimport "lab/msg/{holder}.msg"\ndata-holder: lab/msg/{holder}\nwire-schema: lab/msg/In\n'
    decode = rj.Decoder("m.mapping", schema={**MADE_FILES, "m.mapping": f"{text}unpack-rules:\n  ignore rest\n  {rule}\n"}, encoding="ros1")
    message = sequence(numbers) + sequence(counts) + sequence(octets)
    wanted = peer(numbers, counts, octets)
    (found,) = decode(message).to_dict().values()
    assert np.array_equal(np.frombuffer(found, np.uint8) if isinstance(found, bytes) else found, wanted)
    outcome = compare(
        CHAPTER,
        f"{name}, {len(wanted):,} elements",
        [
            Contender(OURS, "ours", "a holder, used again", effort.call(decode, message)),
            Contender(NUMPY, "peer", "an array, anew", effort.call(peer, numbers, counts, octets)),
        ],
    )
    record(
        f"{name} of an array",
        outcome.ratio(OURS, NUMPY),
        AT_MOST,
        "x numpy",
        f"{outcome.took(OURS).median / len(wanted):.2f} ns an element",
    )
