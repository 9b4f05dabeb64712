"""Reports about arrays whose elements are not each set once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import check as words
from rosetta_jit.language.algebra.polynomial import add, number
from rosetta_jit.language.check.tiling import interval, join, overlap
from rosetta_jit.language.limits import MAX_ELEMENTS_SHOWN

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.language.algebra.polynomial import Polynomial
    from rosetta_jit.language.check.tiling import Run
    from rosetta_jit.source import Span


def coverage(path: str, runs: list[Run], length: Polynomial, span: Span | None, *, optional: bool) -> list[Diagnostic]:
    """What is wrong with the runs of elements that rules set, if they are not exactly 0 to ``length``.

    Parameters
    ----------
    span
        The rule that sets the length.
    optional
        Elements may be left out, but none set twice.
    """
    joined = join(runs)
    clash = overlap(joined)
    if clash is not None:
        return [words.overlap(clash[1].span, path, clash[0].span)]
    size = length.constant()
    if not joined and size == 0:
        return []
    if size is not None and (beyond := _beyond(path, [single for run in runs for single in join([run])], size)):
        return beyond
    intervals = [known for run in joined if (known := interval(run)) is not None]
    if size is not None and len(intervals) == len(joined):
        return [] if optional else _missing(path, intervals, size, span)
    if optional or _is_whole(joined, length):
        return []
    place = joined[0].span if joined else span
    if len(joined) == 1 and not joined[0].dimensions and joined[0].start == number(0):
        return [words.loop_of_other_length(place, path, str(length), str(joined[0].length))]
    return [words.coverage(place, path, str(length), tuple(_shown(run) for run in joined[:MAX_ELEMENTS_SHOWN]))]


def _is_whole(joined: list[Run], length: Polynomial) -> bool:
    return len(joined) == 1 and not joined[0].dimensions and joined[0].start == number(0) and joined[0].length == length


def _beyond(path: str, singles: list[Run], size: int) -> list[Diagnostic]:
    wrong = [(run, known) for run in singles if (known := interval(run)) is not None and (known[0] < 0 or known[1] > size)]
    return [words.element_beyond(run.span, path, start if start < 0 else max(start, size), size) for run, (start, _) in wrong]


def _missing(path: str, intervals: list[tuple[int, int]], size: int, span: Span | None) -> list[Diagnostic]:
    problems: list[Diagnostic] = []
    reached = 0
    for start, end in [*sorted(intervals), (size, size)]:
        if start > reached:
            problems.append(words.element_missing(span, path, reached, start - 1))
        reached = max(reached, end)
    return problems


def _shown(run: Run) -> str:
    text = f"{run.start} to {add(run.start, run.length)}"
    return text + "".join(f", {count} times, {stride} apart" for stride, count in run.dimensions)
