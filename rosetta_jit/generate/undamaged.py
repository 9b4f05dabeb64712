"""Encoders of objects that were just taken apart, and decoders whose rows are their own: no span of these needs to be checked."""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.kernel.ir import Kernel, Site
from rosetta_jit.kernel.nodes import Block, Expect
from rosetta_jit.kernel.rewrite import with_blocks, with_bodies

DAMAGED = "the holder is damaged"


def undamaged(block: Block, sites: Sequence[Site]) -> Block:
    """A block without the checks of spans."""
    kept = (stmt for stmt in block if not (isinstance(stmt, Expect) and sites[stmt.failure.site].detail == DAMAGED))
    return tuple(with_blocks(stmt, lambda inner: undamaged(inner, sites)) for stmt in kept)


def undamaged_kernel(kernel: Kernel) -> Kernel:
    """A kernel whose bodies have no checks of spans; its routines keep theirs."""
    return with_bodies(kernel, tuple(undamaged(body, kernel.sites) for body in kernel.bodies))
