"""Reductions of the elements for which a condition holds, against a loop of numba's that takes the same ones, and against numpy."""

from __future__ import annotations

import numba
import numpy as np
import pytest

import rosetta_jit as rj
from bench.contest import Contender

CHAPTER = "Mappings"
OURS, BY_HAND, NUMPY = "rosetta_jit", "numba, by hand", "numpy"
AT_MOST = 1.2
COUNT = 10_000
FILES = {
    "lab/msg/Scan.msg": "float64[] ranges\n",
    "lab/msg/Near.msg": "float64 found\n",
}
HEAD = 'import "lab/msg/Scan.msg"\nimport "lab/msg/Near.msg"\ndata-holder: lab/msg/Near\nwire-schema: lab/msg/Scan\nunpack-rules:\n'
FIRST = 12
"""Where numbers begin: behind CDR's header, their number, and what aligns them."""


@numba.njit
def mean_below(data, limit):
    """The mean of the numbers below a limit; the length is checked."""
    count = data[4:8].view(np.uint32)[0]
    if data.shape[0] != FIRST + 8 * count:
        return np.nan
    total, taken = 0.0, 0
    for number in data[FIRST:].view(np.float64):
        if number < limit:
            total += number
            taken += 1
    return total / taken


@numba.njit
def least_above(data, limit):
    """The least of the numbers above a limit, likewise."""
    count = data[4:8].view(np.uint32)[0]
    if data.shape[0] != FIRST + 8 * count:
        return np.nan
    found = np.inf
    for number in data[FIRST:].view(np.float64):
        if number > limit and not number >= found:
            found = number
    return found


CASES = {
    "mean": ("mean(.ranges[] where .ranges[] < 0.5)", mean_below, lambda numbers: numbers[numbers < 0.5].mean()),
    "min": ("min(.ranges[] where .ranges[] > 0.5)", least_above, lambda numbers: numbers[numbers > 0.5].min()),
}


@pytest.mark.parametrize("case", CASES)
def test_by_a_condition(case, effort, compare, record):
    text, by_hand, by_numpy = CASES[case]
    files = {**FILES, "near.mapping": f"{HEAD}  .found = {text}\n"}
    decode = rj.Decoder("near.mapping", schema=files, encoding="cdr")
    write = rj.Encoder.of("lab/msg/Scan", schema=FILES, imports=["lab/msg/Scan.msg"], encoding="cdr")
    message = bytes(write(write.holder_type.from_dict({"ranges": np.random.default_rng(0).random(COUNT)})))
    data = np.frombuffer(message, np.uint8)
    numbers = data[FIRST:].view(np.float64)
    assert decode(message).found == by_hand(data, 0.5)
    assert np.isclose(decode(message).found, by_numpy(numbers))
    what = f"{case} of half of {COUNT:,} numbers"
    outcome = compare(
        CHAPTER,
        what,
        [
            Contender(OURS, "ours", "a message", effort.call(lambda: decode(message))),
            Contender(BY_HAND, "limit", "its bytes", effort.call(lambda: by_hand(data, 0.5))),
            Contender(NUMPY, "peer", "an array", effort.call(lambda: by_numpy(numbers))),
        ],
    )
    took = f"{outcome.took(OURS).median / 1000:.1f} us"
    record(what, outcome.ratio(OURS, BY_HAND), AT_MOST, "x numba by hand", took)
    record(f"{what}, numpy", outcome.ratio(OURS, NUMPY), AT_MOST, "x numpy", took)
