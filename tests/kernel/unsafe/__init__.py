"""Unsafe kernels by hand: for each refusal of the proof one at least that it must refuse, most with a twin that is safe by a hair."""

from __future__ import annotations

from tests.kernel.unsafe import flow, loops, memory, relations, text, values

GROUPS = memory.CASES, values.CASES, relations.CASES, flow.CASES, loops.CASES, text.CASES
REFUSED = {name: each for cases in GROUPS for name, each in cases.refused.items()}
ACCEPTED = {name: each for cases in GROUPS for name, each in cases.accepted.items()}
assert len(REFUSED) == sum(len(cases.refused) for cases in GROUPS)
