"""The sites of failures: a routine numbers its own, and each of its callers has others for them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from rosetta_jit.backends.llvm.alike import Number
from rosetta_jit.backends.llvm.frame import Frame, Stretch
from rosetta_jit.backends.llvm.tables import table
from rosetta_jit.backends.llvm.values import I64, constant, state_word

if TYPE_CHECKING:
    from llvmlite import ir

FEW_RUNS = 3
"""Runs of sites one behind the other up to which it is compared which of them a failure is in: of more there is a table."""


def site_of(frame: Frame, number: ir.Value, sites: tuple[int, ...]) -> tuple[ir.Value, int | None]:
    """The caller's site for a routine's failure: mostly they follow one another as the routine's own do.

    With it the column of the stretch's row whose number has to be added to it, where there is one.
    """
    builder = frame.builder
    if not sites:
        return constant(0), None
    runs = [(own, site - own - sites[0]) for own, site in enumerate(sites, 1)]
    runs = [runs[0], *(run for before, run in pairwise(runs) if run[1] != before[1])]
    if frame.stretch is not None:
        return _looked_up(frame, frame.stretch, number, [(own, sites[own - 1]) for own, _ in runs], is_alone=len(sites) == 1)
    first = constant(sites[0])
    if len(sites) == 1:
        return first, None
    if len(runs) > FEW_RUNS:
        distances = table(frame.module, [0, *(site - sites[0] for site in sites)])
        return builder.add(first, builder.load(state_word(builder, distances, number), typ=I64)), None
    further: ir.Value = constant(runs[0][1])
    for own, distance in runs[1:]:
        further = builder.select(builder.icmp_signed(">=", number, constant(own)), constant(distance), further)
    return builder.add(first, builder.add(number, further)), None


def _looked_up(
    frame: Frame, stretch: Stretch, number: ir.Value, runs: Sequence[tuple[int, int]], *, is_alone: bool
) -> tuple[ir.Value, int | None]:
    """The same where sites are other ones for each stretch, and so are the distances of runs."""
    builder, column = frame.builder, _column_of(stretch, [site for _, site in runs])

    def before(own: int, site: int) -> ir.Value:
        """What a routine's own number is added to."""
        found = stretch.sites.get(site)
        if found is None:
            return constant(site - own)
        distance = found.further - own
        return stretch.number(builder, Number(found.column, distance)) if column is None else constant(distance)

    (own, first), *others = runs
    if is_alone:
        return before(0, first), column
    further = before(own, first)
    for own, site in others:
        further = builder.select(builder.icmp_signed(">=", number, constant(own)), before(own, site), further)
    return builder.add(further, number), column


def _column_of(stretch: Stretch, sites: Sequence[int]) -> int | None:
    """The one column of all these sites: in a function, failures at them lead through a block that adds its number."""
    columns = {None if (found := stretch.sites.get(each)) is None else found.column for each in sites}
    return columns.pop() if stretch.is_whole and len(columns) == 1 else None
