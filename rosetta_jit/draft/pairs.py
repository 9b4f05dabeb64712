"""Pairs of leaves that mean the same in two messages: found by their names, by what stands around them, and by what is beside them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rosetta_jit.draft.conversions import kind
from rosetta_jit.draft.words import GENERIC, alike, shared, tokens
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.draft.leaves import Leaf

    Group = tuple[tuple[str, ...], tuple[int | None, ...]]

ENOUGH = 0.45
"""The score from which on two leaves are taken for one."""

NAME, AROUND, BESIDE = 0.5, 0.25, 0.25

IN_ORDER = 0.35
"""How alike two leaves are of which only the place among their neighbours tells."""

SAID = 0.8
"""How alike two leaves are of which one is a value, and its message is named as the other."""

CONVERTED = 0.1
"""What two leaves lose that are a number and a text."""

DOUBTFUL = 0.55
"""The score from which on leaves are taken for one that only a person can relate."""

FAMILIES = frozenset(("number", "text"))


@dataclass(frozen=True, slots=True)
class Pair:
    """A leaf of the holder, one of the wire, and from 0 to 1 how likely they are one value."""

    holder: Leaf
    wire: Leaf
    score: float


def pairs(holder: list[Leaf], wire: list[Leaf]) -> list[Pair]:
    """The likeliest pairs, each leaf in at most one, the likeliest first."""
    holder_groups, wire_groups = _grouped(holder), _grouped(wire)
    candidates: list[Pair] = []
    for mine in holder_groups.values():
        for theirs in wire_groups.values():
            candidates += _between(mine, theirs)
    candidates.sort(key=lambda each: (-each.score, each.holder.names, len(each.wire.names), each.wire.names))
    found: list[Pair] = []
    taken: set[int] = set()
    for each in candidates:
        if not {id(each.holder), id(each.wire)} & taken:
            taken |= {id(each.holder), id(each.wire)}
            found.append(each)
    return found


def _grouped(leaves: Iterable[Leaf]) -> dict[Group, list[Leaf]]:
    """The leaves of each message together."""
    groups: dict[Group, list[Leaf]] = {}
    for each in leaves:
        groups.setdefault(each.group, []).append(each)
    return groups


def _between(mine: list[Leaf], theirs: list[Leaf]) -> list[Pair]:
    """The pairs of two messages' leaves that may be."""
    names = {(id(one), id(other)): _alike(one, other) for one in mine for other in theirs if fit(one, other)}
    if not names:
        return []
    if not any(names.values()) and _in_step(mine, theirs):
        names = {(id(one), id(other)): IN_ORDER for one, other in zip(mine, theirs, strict=True)}
    beside = _together(mine, theirs, names)
    found = [Pair(one, other, _score(one, other, names.get((id(one), id(other)), 0.0), beside)) for one in mine for other in theirs]
    return [each for each in found if names.get((id(each.holder), id(each.wire))) and each.score >= _enough(each)]


def _score(one: Leaf, other: Leaf, name: float, beside: float) -> float:
    converted = 0.0 if kind(one.type) == kind(other.type) else CONVERTED
    return NAME * name + AROUND * around(one, other) + BESIDE * beside - converted


def _enough(pair: Pair) -> float:
    """The score that leaves must have: more where no conversion makes one of the other."""
    kinds = {kind(pair.holder.type), kind(pair.wire.type)}
    return ENOUGH if len(kinds) == 1 or kinds <= FAMILIES else DOUBTFUL


def _alike(one: Leaf, other: Leaf) -> float:
    """How alike the names of two leaves are; of one that is called a value, its message says which.

    One name may be said by two fields: ``joint_names`` is ``joints[].name``.
    """
    found = alike(one.names[-1], other.names[-1])
    for value, named in ((one, other), (other, one)):
        name, way = named.names[-1], "_".join(value.names[-2:])
        if len(tokens(name)) == len(tokens(way)):
            found = max(found, alike(name, way))
        if {*tokens(value.names[-1])} <= GENERIC:
            types = [name.replace("/", ".").split(".")[-1] for name in value.types]
            found = max(found, SAID * shared([named.names[-1]], types))
    return found


def fit(one: Leaf, other: Leaf) -> bool:
    """Whether two leaves can be one value: as deep in arrays, and of types that become each other."""
    lengths = [(a, b) for a, b in zip(_lengths(one), _lengths(other), strict=False) if a and b]
    kinds = {kind(one.type), kind(other.type)}
    return one.depth == other.depth and all(a == b for a, b in lengths) and (len(kinds) == 1 or kinds <= FAMILIES or "text" in kinds)


def _lengths(leaf: Leaf) -> list[int]:
    return [each for each in leaf.arrays if each is not None]


def around(one: Leaf, other: Leaf) -> float:
    """How much alike is what stands around two leaves: fields on the way, and the types of these."""
    first, second = ((*each.names[:-1], *(name.replace("/", ".").split(".")[-1] for name in each.types)) for each in (one, other))
    return shared(first, second)


def _in_step(mine: list[Leaf], theirs: list[Leaf]) -> bool:
    """Whether two messages have as many fields of one kind, of which only the order tells."""
    kinds = [kind(each.type) for each in (*mine, *theirs)]
    return len(mine) == len(theirs) > 1 and kinds == ["number"] * len(kinds) and all(map(fit, mine, theirs))


def _together(mine: list[Leaf], theirs: list[Leaf], names: dict[tuple[int, int], float]) -> float:
    """How well two messages fit as a whole: what each leaf of the smaller finds in the other, and a little less for each that is left."""
    best = sum(max((names.get((id(one), id(other)), 0.0) for other in theirs), default=0.0) for one in mine)
    few, many = sorted((len(mine), len(theirs)))
    return min(1.0, best / few) * (0.5 + 0.5 * few / many)
