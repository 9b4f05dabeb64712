"""The Requires of a straight run become one at its front, which still knows which field each byte belongs to.

As in `hoist` a check may move up across everything but a Return and what it reads. Where several bodies are attempted, or another kernel
goes on, the first Expect behind a Require is what tells their formats from each other; checks stay behind it, so that a message that is cut
off is reported by the attempt whose format it has.
"""

from __future__ import annotations

from rosetta_jit.kernel.ir import Kernel, Part, Site
from rosetta_jit.kernel.nodes import Block, Const, Expect, Expr, Failure, Require, Stmt
from rosetta_jit.kernel.rewrite import locals_in, may_return, reads_memory, with_blocks, with_bodies
from rosetta_jit.kernel.terms import index, split
from rosetta_jit.kernel.walk import blocks_of, changed_names
from rosetta_jit.startup.dataclass import dataclass, field, replace

_Key = tuple["Expr", tuple["Expr", ...], str]
"""What Requires have in common that can be merged: the base of their positions, the indices, the kind of failure."""


@dataclass(slots=True)
class _Group:
    """Requires that become one: the first, its place among the statements, where all begin and end, and whose the bytes are."""

    first: Require
    number: int
    begin: int
    end: int
    parts: list[Part]


@dataclass(slots=True)
class _Open:
    """The groups that the next Require may join, and which of them read a local: of thousands, a statement ends few."""

    by_key: dict[_Key, _Group] = field(default_factory=dict["_Key", "_Group"])
    readers: dict[str, list[_Key]] = field(default_factory=dict[str, "list[_Key]"])

    def open(self, key: _Key, group: _Group) -> None:
        """Start a group, in place of one that has the same in common."""
        if key not in self.by_key:
            for name in {name for expr in (key[0], *key[1]) for name in locals_in(expr)}:
                self.readers.setdefault(name, []).append(key)
        self.by_key[key] = group

    def clear(self) -> None:
        """End all."""
        self.by_key.clear()
        self.readers.clear()

    def close_behind(self, stmt: Stmt) -> None:
        """End the groups that may not reach beyond a statement."""
        if not self.by_key:
            return
        if any(map(may_return, blocks_of(stmt))):
            self.clear()
        for name in changed_names((stmt,)):
            for key in self.readers.pop(name, ()):
                self.by_key.pop(key, None)


def merge(kernel: Kernel) -> Kernel:
    """The kernel with fewer Requires."""
    sites = list(kernel.sites)
    is_attempt = kernel.goes_on or len(kernel.bodies) > 1
    bodies = tuple(_block(body, sites, is_attempt=is_attempt) for body in kernel.bodies)
    changed = with_bodies(kernel, bodies)
    return kernel if changed is kernel else replace(changed, sites=tuple(sites))


def _block(block: Block, sites: list[Site], *, is_attempt: bool = False) -> Block:
    result: list[Stmt] = []
    groups = _Open()
    made: list[_Group] = []
    for stmt in block:
        match stmt:
            case Require(at, Const(_, size), failure) if not reads_memory(at):
                base, offset = split(at)
                site = sites[failure.site]
                key = base, failure.indices, site.kind
                group = groups.by_key.get(key)
                if group is not None and _joins(group, offset, int(size), site):
                    continue
                made.append(_Group(stmt, len(result), offset, offset + int(size), _parts(site, int(size), 0)))
                groups.open(key, made[-1])
            case Expect() if is_attempt and groups.by_key:
                groups.clear()
                is_attempt = False
            case _:
                groups.close_behind(stmt)
        result.append(with_blocks(stmt, lambda inner: _block(inner, sites)))
    for group in made:
        result[group.number] = _whole(group, sites)
    return tuple(result)


def _joins(group: _Group, offset: int, size: int, site: Site) -> bool:
    """Make a Require a part of a group, if it can be. A stretch that repeats is the last: nothing says where it ends."""
    if offset < group.begin or group.parts[-1].step:
        return False
    group.parts += _parts(site, size, offset - group.begin)
    group.end = max(group.end, offset + size)
    return True


def _parts(site: Site, size: int, offset: int) -> list[Part]:
    if not site.parts:
        return [Part(offset, size, site.path)]
    return [replace(part, offset=part.offset + offset) for part in site.parts]


def _whole(group: _Group, sites: list[Site]) -> Require:
    """The one Require of a group."""
    first = group.first
    old = sites[first.failure.site]
    if len(group.parts) == max(1, len(old.parts)):
        return first
    sites.append(replace(old, parts=tuple(group.parts)))
    failure = Failure(len(sites) - 1, first.at, first.failure.indices)
    return Require(first.at, index(group.end - group.begin), failure)
