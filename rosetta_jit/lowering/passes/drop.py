"""Checks that cannot fail go."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.kernel.rewrite import with_blocks
from rosetta_jit.kernel.verify import redundant_checks

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Block, Kernel


def drop(kernel: Kernel) -> Kernel:
    """The kernel without the Require and Expect that follow from what is known before them."""
    redundant = redundant_checks(kernel)
    if not redundant:
        return kernel

    def kept(block: Block) -> Block:
        return tuple(with_blocks(stmt, kept) for stmt in block if id(stmt) not in redundant)

    return replace(kernel, bodies=tuple(map(kept, kernel.bodies)))
