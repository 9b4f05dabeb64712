"""Checks that cannot fail go, and so do Ifs that always choose the same."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, If, Stmt
from rosetta_jit.kernel.proof.verify import settled
from rosetta_jit.kernel.rewrite import with_blocks, with_bodies


def drop(kernel: Kernel) -> Kernel:
    """The kernel without what follows from what is known before it."""
    return without(kernel, settled(kernel))


def without(kernel: Kernel, known: frozenset[int]) -> Kernel:
    """The kernel without the statements that are known to choose nothing, by their ids."""
    if not known:
        return kernel

    def kept(block: Block) -> Block:
        return tuple(part for stmt in block for part in _kept(stmt, kept, known))

    return with_bodies(kernel, tuple(map(kept, kernel.bodies)))


def _kept(stmt: Stmt, kept: Callable[[Block], Block], known: frozenset[int]) -> Block:
    if id(stmt) not in known:
        return (with_blocks(stmt, kept),)
    return kept(stmt.then) if isinstance(stmt, If) else ()
