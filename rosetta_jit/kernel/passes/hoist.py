"""Checks move out of loops: what every round checks anew is checked once before the first.

A check that is made earlier fails earlier, and what a failed kernel leaves in the holder is nobody's business; so a check may move
up across everything but a Return and what it reads.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Kernel, Part, Site
from rosetta_jit.kernel.nodes import Block, Compare, Const, Expect, Expr, Failure, Fits, For, If, Local, Require, Stmt
from rosetta_jit.kernel.passes.fold import TRUE, folded
from rosetta_jit.kernel.rewrite import may_return, reads_memory, with_blocks, with_bodies
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.kernel.passes import affine, widen
    from rosetta_jit.kernel.passes.affine import Rounds
else:
    widen = Late("rosetta_jit.kernel.passes.widen")
    affine = Late("rosetta_jit.kernel.passes.affine")


def hoist(kernel: Kernel) -> Kernel:
    """The kernel with checks before loops in place of checks in them."""
    sites = list(kernel.sites)
    bodies = tuple(_block(body, sites) for body in kernel.bodies)
    changed = with_bodies(kernel, bodies)
    return kernel if changed is kernel else replace(changed, sites=tuple(sites))


def _block(block: Block, sites: list[Site]) -> Block:
    result: list[Stmt] = []
    for stmt in block:
        inner = with_blocks(stmt, lambda body: _block(body, sites))
        result.extend(_loop(inner, sites) if isinstance(inner, For) else (inner,))
    return tuple(result)


def _loop(loop: For, sites: list[Site]) -> Block:
    """A loop with its checks before it, where there is a first round."""
    if may_return(loop.body) or reads_memory(loop.count):
        return (loop,)
    rounds = affine.rounds_of(loop)
    moved: list[Stmt] = []
    kept: list[Stmt] = []
    for stmt in loop.body:
        before = _before(stmt, loop.count, rounds, sites)
        moved.extend(before)
        kept.extend(() if before else (stmt,))
    if not moved:
        return (loop,)
    whole = (*moved, replace(loop, body=tuple(kept)))
    some = folded(Compare("gt", loop.count, index(0)))
    return whole if some == TRUE else (If(some, whole),)


def _before(stmt: Stmt, count: Expr, rounds: Rounds, sites: list[Site]) -> Block:
    """What a loop can check before it in place of a statement in it; empty where the statement must stay."""
    match stmt:
        case Expect():
            return widen.widened(stmt, count, rounds)
        case Require(at, size, failure):
            place, extent = rounds.affine(at), rounds.fixed(size)
            if place is None or extent is None:
                return ()
            if place.step == index(0):
                first = _at_first(failure, place.base, rounds)
                return (Require(place.base, extent, first),) if first is not None else ()
            return _widened(Require(place.base, extent, failure), place.step, count, rounds, sites)
        case _:
            return ()


def _at_first(failure: Failure, at: Expr, rounds: Rounds) -> Failure | None:
    """The failure of the first round."""
    first = Failure(failure.site, rounds.at_first(at), tuple(map(rounds.at_first, failure.indices)))
    return first if all(map(rounds.is_fixed, (first.at, *first.indices))) else None


def _widened(first: Require, step: Expr, count: Expr, rounds: Rounds, sites: list[Site]) -> Block:
    """One check for all rounds in place of the first round's and those that lie a constant step behind each other."""
    match first, step:
        case Require(at, Const(_, size), failure), Const(_, distance) if 0 < size <= distance:
            whole = _of_all(Failure(failure.site, at, failure.indices), int(size), int(distance), rounds, sites)
            if whole is None:
                return ()
            fits = Expect(Fits("mul", count, index(int(distance))), whole)
            return fits, Require(at, add(mul(count, int(distance)), int(size - distance)), whole)
        case _:
            return ()


def _of_all(first: Failure, size: int, step: int, rounds: Rounds, sites: list[Site]) -> Failure | None:
    """The failure of all rounds: at the first one's place, with a site that names each element if the path has a place for its index."""
    site = sites[first.site]
    match first.indices:
        case (*outer, Local(_, last)) if last == rounds.variable:
            is_named = site.path.count("{}") == len(first.indices) and not any(part.step for part in site.parts)
            if not is_named or not all(map(rounds.is_fixed, outer)):
                return None
            sites.append(_stepped(site, size, step))
            return Failure(len(sites) - 1, first.at, tuple(outer))
        case indices:
            return first if all(map(rounds.is_fixed, indices)) else None


def _stepped(site: Site, size: int, step: int) -> Site:
    """The site of a check that stands for all elements of a loop."""
    head, _, tail = site.path.rpartition("{}")
    return replace(site, path=head + tail, parts=(Part(0, size, site.path, step),))
