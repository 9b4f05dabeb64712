"""A proven kernel without the checks that cannot fail: it does the same, so it needs no proof of its own."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.rewrite import may_return, with_blocks, with_bodies
from rosetta_jit.kernel.walk import blocks_of


def is_less(kernel: ir.Kernel, proven: ir.Kernel, known: frozenset[int]) -> bool:
    """Whether a kernel is a proven one without what `settled` knows of it: checks are gone, Ifs have become their first blocks.

    Where such a first block may return, no path may reach what stands behind the If. Then the answer is No, and only a proof can tell.
    """
    if len(kernel.bodies) != len(proven.bodies) or with_bodies(proven, kernel.bodies) != kernel:
        return False
    return all(map(partial(_is_less, known), kernel.bodies, proven.bodies))


def _is_less(known: frozenset[int], block: nodes.Block, proven: nodes.Block) -> bool:
    rest = iter(block)
    return _goes_on(rest, proven, known) and next(rest, None) is None


def _goes_on(rest: Iterator[nodes.Stmt], proven: nodes.Block, known: frozenset[int]) -> bool:
    """Whether a proven block, without what is known, comes next."""
    for stmt in proven:
        if id(stmt) not in known:
            other = next(rest, None)
            if other is not stmt and (other is None or not _is_alike(other, stmt, known)):
                return False
        elif isinstance(stmt, nodes.If):
            if may_return(stmt.then) or not _goes_on(rest, stmt.then, known):
                return False
        elif not isinstance(stmt, nodes.Require | nodes.Expect):
            return False
    return True


def _is_alike(stmt: nodes.Stmt, proven: nodes.Stmt, known: frozenset[int]) -> bool:
    """Whether two statements differ at most in the blocks inside, and these only by what is known."""
    inside, before = blocks_of(stmt), blocks_of(proven)
    if type(stmt) is not type(proven) or len(inside) != len(before):
        return False
    inner = iter(inside)
    return with_blocks(proven, lambda _: next(inner)) == stmt and all(map(partial(_is_less, known), inside, before))
