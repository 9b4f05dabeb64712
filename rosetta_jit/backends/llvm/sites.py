"""The sites of failures: a routine numbers its own, and each of its callers has others for them."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from rosetta_jit.backends.llvm.frame import I64, Frame, constant, state_word
from rosetta_jit.backends.llvm.tables import table

if TYPE_CHECKING:
    from llvmlite import ir

FEW_RUNS = 3
"""Runs of sites one behind the other up to which it is compared which of them a failure is in: of more there is a table."""


def site_of(frame: Frame, number: ir.Value, sites: tuple[int, ...]) -> ir.Value:
    """The caller's site for a routine's failure: mostly they follow one another as the routine's own do."""
    builder = frame.builder
    first = constant(0) if not sites else constant(sites[0]) if frame.stretch is None else frame.stretch.site(builder, sites[0])
    if len(sites) < 2:
        return first
    runs = [(own, site - own - sites[0]) for own, site in enumerate(sites, 1)]
    runs = [runs[0], *(run for before, run in pairwise(runs) if run[1] != before[1])]
    if len(runs) > FEW_RUNS:
        distances = table(frame.module, [0, *(site - sites[0] for site in sites)])
        return builder.add(first, builder.load(state_word(builder, distances, number), typ=I64))
    further: ir.Value = constant(runs[0][1])
    for own, distance in runs[1:]:
        further = builder.select(builder.icmp_signed(">=", number, constant(own)), constant(distance), further)
    return builder.add(first, builder.add(number, further))
