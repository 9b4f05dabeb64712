"""Encoders of objects that were just taken apart, and decoders whose rows are their own: no span of these needs to be checked.

Where nobody else has the rows, as in C++, nor does what an encoder has measured and written into them itself.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from rosetta_jit.kernel.ir import Kernel, Site
from rosetta_jit.kernel.nodes import Block, Expect
from rosetta_jit.kernel.rewrite import with_blocks, with_bodies

SPANS = frozenset({"the holder is damaged"})
OWN_ROWS = SPANS | {"the holder changed while it was written"}


def undamaged(block: Block, sites: Sequence[Site], details: Collection[str] = SPANS) -> Block:
    """A block without the checks of spans, or those that say such ``details``."""
    kept = (stmt for stmt in block if not (isinstance(stmt, Expect) and sites[stmt.failure.site].detail in details))
    return tuple(with_blocks(stmt, lambda inner: undamaged(inner, sites, details)) for stmt in kept)


def undamaged_kernel(kernel: Kernel, details: Collection[str] = OWN_ROWS) -> Kernel:
    """A kernel whose bodies have no checks of rows that are its own, or those that say such ``details``; its routines keep theirs."""
    return with_bodies(kernel, tuple(undamaged(body, kernel.sites, details) for body in kernel.bodies))
