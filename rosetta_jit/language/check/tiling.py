"""Proof that writes fill an array: each element from 0 to its length once, none twice, none left out.

A write in loops covers a run of adjacent elements, repeated along dimensions: `(y*w + x)*3 + c` with `c` to 3, `x` to
`w`, `y` to `h` is a run of 1 along strides 1, 3 and 3w. Two rules join runs until one is left or nothing fits:

- a dimension whose stride is the run's length, up or down, makes the run longer (mixed radix);
- two runs with the same dimensions, one starting where the other ends, are one (channels one by one; padded rows).

Lengths and counts are never negative: a loop that ends below its start is an error when it runs.
"""

from __future__ import annotations

from collections import Counter
from itertools import pairwise

from rosetta_jit.language.algebra.polynomial import Polynomial, add, multiply, number
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, field, replace

Dimension = tuple["Polynomial", "Polynomial"]
"""Stride and count."""

Key = tuple[frozenset[tuple[Dimension, int]], "Polynomial"]
"""Dimensions in any order, and a place."""


@dataclass(frozen=True, slots=True)
class Run:
    """Elements ``start`` to ``start + length``, and the same again along each dimension. ``span`` is of its first writer."""

    start: Polynomial
    length: Polynomial
    dimensions: tuple[Dimension, ...]
    span: Span | None = field(default=None, compare=False)


def join(runs: list[Run]) -> list[Run]:
    """The fewest runs that the two rules come to."""
    while True:
        longer = [_absorb(run) for run in runs if not _empty(run)]
        joined = _concatenate(longer)
        if len(joined) == len(runs):
            return joined
        runs = joined


def overlap(runs: list[Run]) -> tuple[Run, Run] | None:
    """Two runs that certainly share an element: equal starts, or constant intervals that meet."""
    seen: dict[Key, Run] = {}
    for run in runs:
        earlier = seen.setdefault(_key(run, run.start), run)
        if earlier is not run:
            return earlier, run
    known = sorted((bounds, index) for index, run in enumerate(runs) if (bounds := interval(run)) is not None)
    for ((_, end), first), ((start, _), second) in pairwise(known):
        if start < end:
            return runs[min(first, second)], runs[max(first, second)]
    return None


def interval(run: Run) -> tuple[int, int] | None:
    """First element and end of a run without dimensions whose bounds are numbers."""
    start, length = run.start.constant(), run.length.constant()
    return None if start is None or length is None or run.dimensions else (start, start + length)


def _empty(run: Run) -> bool:
    return any(size.constant() == 0 for size in (run.length, *(count for _, count in run.dimensions)))


def _absorb(run: Run) -> Run:
    for position, (stride, count) in enumerate(run.dimensions):
        rest = (*run.dimensions[:position], *run.dimensions[position + 1 :])
        if count == number(1):
            return _absorb(replace(run, dimensions=rest))
        if stride == run.length:
            return _absorb(replace(run, length=multiply(run.length, count), dimensions=rest))
        if add(stride, run.length) == number(0):  # counting down: the last round is the first element
            first = add(run.start, multiply(stride, add(count, number(-1))))
            return _absorb(replace(run, start=first, length=multiply(run.length, count), dimensions=rest))
    return run


def _concatenate(runs: list[Run]) -> list[Run]:
    """Runs that continue one another, as one."""
    by_start = {_key(run, run.start): run for run in runs}
    if len(by_start) < len(runs):
        return runs  # two of them overlap
    ends = {_key(run, _end(run)) for run in runs}
    joined: list[Run] = []
    used = 0
    for run in runs:
        if _key(run, run.start) in ends:
            continue
        whole = run
        used += 1
        while used <= len(runs) and (following := by_start.get(_key(whole, _end(whole)))) is not None:
            whole = replace(whole, length=add(whole.length, following.length))
            used += 1
        joined.append(whole)
    return joined if used == len(runs) else runs


def _end(run: Run) -> Polynomial:
    return add(run.start, run.length)


def _key(run: Run, place: Polynomial) -> Key:
    return frozenset(Counter(run.dimensions).items()), place
