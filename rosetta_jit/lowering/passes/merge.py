"""The Requires of a straight run become one at its front, which still knows which field each byte belongs to.

As in `hoist` a check may move up across everything but a Return and what it reads. Where several bodies are attempted, the first
Expect behind a Require is what tells their formats from each other; checks stay behind it, so that a message that is cut off is
reported by the attempt whose format it has.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Binary, Block, Const, Expect, Failure, Part, Require, Site, index
from rosetta_jit.kernel.loops import changed_names
from rosetta_jit.kernel.rewrite import locals_in, may_return, reads_memory, with_blocks
from rosetta_jit.kernel.shape import blocks_of

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Expr, Kernel, Stmt

_Key = tuple["Expr", tuple["Expr", ...], str]
"""What Requires have in common that can be merged: the base of their positions, the indices, the kind of failure."""


@dataclass(slots=True)
class _Group:
    """Requires that become one: the place of the first among the statements, where they begin and end, and the site of them all."""

    number: int
    begin: int
    end: int
    site: int | None = None


def merge(kernel: Kernel) -> Kernel:
    """The kernel with fewer Requires."""
    sites = list(kernel.sites)
    bodies = tuple(_block(body, sites, is_attempt=len(kernel.bodies) > 1) for body in kernel.bodies)
    return kernel if bodies == kernel.bodies else replace(kernel, bodies=bodies, sites=tuple(sites))


def _block(block: Block, sites: list[Site], *, is_attempt: bool = False) -> Block:
    result: list[Stmt] = []
    groups: dict[_Key, _Group] = {}
    for stmt in block:
        match stmt:
            case Require(at, Const(_, size), failure) if not reads_memory(at):
                base, offset = _split(at)
                key = base, failure.indices, sites[failure.site].kind
                group = groups.get(key)
                if group is not None and _joins(group, offset, result, sites):
                    result[group.number] = _joined(group, stmt, offset, int(size), result, sites)
                    continue
                groups[key] = _Group(len(result), offset, offset + int(size))
            case Expect() if is_attempt and groups:
                groups.clear()
                is_attempt = False
            case _:
                _close(groups, stmt)
        result.append(with_blocks(stmt, lambda inner: _block(inner, sites)))
    return tuple(result)


def _close(groups: dict[_Key, _Group], stmt: Stmt) -> None:
    """End the groups that may not reach beyond a statement."""
    if any(map(may_return, blocks_of(stmt))):
        groups.clear()
    changed = changed_names((stmt,))
    for key in [key for key in groups if any(not changed.isdisjoint(locals_in(expr)) for expr in (key[0], *key[1]))]:
        del groups[key]


def _split(at: Expr) -> tuple[Expr, int]:
    match at:
        case Binary("add", base, Const("i64", value)):
            return base, int(value)
        case _:
            return at, 0


def _joins(group: _Group, offset: int, result: list[Stmt], sites: list[Site]) -> bool:
    """Whether a Require can become part of a group. A stretch that repeats is the last: nothing says where it ends."""
    return offset >= group.begin and not any(part.step for part in sites[_leader(group, result).failure.site].parts)


def _joined(group: _Group, stmt: Require, offset: int, size: int, result: list[Stmt], sites: list[Site]) -> Require:
    """The group's Require with one more in it."""
    leader = _leader(group, result)
    old = sites[leader.failure.site]
    own = _parts(old, group.end - group.begin, 0)
    if group.site is None:
        group.site = len(sites)
        sites.append(old)
    sites[group.site] = replace(old, parts=(*own, *_parts(sites[stmt.failure.site], size, offset - group.begin)))
    group.end = max(group.end, offset + size)
    failure = Failure(group.site, leader.at, leader.failure.indices)
    return Require(leader.at, index(group.end - group.begin), failure)


def _leader(group: _Group, result: list[Stmt]) -> Require:
    first = result[group.number]
    if not isinstance(first, Require):
        raise AssertionError("a group starts with a Require")  # noqa: TRY004  # our bug, not a caller's
    return first


def _parts(site: Site, size: int, offset: int) -> tuple[Part, ...]:
    if not site.parts:
        return (Part(offset, size, site.path),)
    return tuple(replace(part, offset=part.offset + offset) for part in site.parts)
