"""A draft as the text of a mapping: decided rules, what is left out of both sides, and comments for what a person must decide."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import TYPE_CHECKING

from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.draft.leaves import Leaf, Names
    from rosetta_jit.draft.rules import Decision

VARIABLES = "ijk"

SURE = 0.75
"""The score below which a rule is marked as a guess."""


@dataclass(frozen=True, slots=True)
class Sides:
    """What a draft is of: two types, the files that declare them, and their leaves."""

    holder_type: str
    wire_type: str
    imports: tuple[str, ...]
    holder: list[Leaf]
    wire: list[Leaf]


def draft_text(sides: Sides, found: list[Decision], refused: dict[str, str]) -> str:
    """The mapping; ``refused`` are relations that the checker does not take, with its reasons."""
    lines = [*(f'import "{name}"' for name in sides.imports), "", f"data-holder: {sides.holder_type}", f"wire-schema: {sides.wire_type}"]
    lines += ["", "rules:", *_rules(found, refused)]
    kept = [each for each in found if each.relations and not any(relation in refused for relation in each.relations)]
    partners = _partners(kept)
    for word, why, leaves, used in (
        ("default", "nothing of the wire is like", sides.holder, [leaf for each in kept for leaf in each.holder]),
        ("ignore", "nothing of the holder is like", sides.wire, [leaf for each in kept for leaf in each.wire]),
    ):
        left = list(_left(leaves, used))
        lines += [f"  # not decided: {why} these" for _ in left[:1]]
        lines += _in_loops([_without(word, leaf, count, partners) for leaf, count in left])
    return "\n".join(lines) + "\n"


def _rules(found: Iterable[Decision], refused: dict[str, str]) -> Iterator[str]:
    for each in found:
        if not each.relations:
            yield f"  # not decided: {each.why}"
            continue
        whys = [refused[relation] for relation in each.relations if relation in refused]
        if whys:
            yield f"  # not decided: {whys[0]}"
            yield from (f"  # {relation}" for relation in each.relations)
            continue
        if each.why:
            yield f"  # look at this: {each.why}"
        guess = f"   # a guess: the names are alike by {each.score:.0%}" if each.score < SURE else ""
        yield from (f"  {relation}{guess if number == 0 else ''}" for number, relation in enumerate(each.relations))


def _partners(kept: list[Decision]) -> dict[Names, Leaf]:
    """For each array of either side, by its way, a leaf of the wire that is in as many arrays as one in it."""
    found: dict[Names, Leaf] = {}
    for each in kept:
        for leaf in (*each.holder, *each.wire):
            for number, length in enumerate(leaf.arrays):
                if length is not None and each.wire[0].depth == leaf.depth:
                    found.setdefault(leaf.names[: number + 1], leaf if leaf in each.wire else each.wire[0])
    return found


def _left(leaves: list[Leaf], used: list[Leaf]) -> Iterator[tuple[Leaf, int]]:
    """The outermost fields of which no part is used, each as a leaf within, and how many steps lead to the field."""
    touched = {leaf.names[:count] for leaf in used for count in range(1, len(leaf.names) + 1)}
    seen: set[Names] = set()
    for leaf in leaves:
        count = next((count for count in range(1, len(leaf.names) + 1) if leaf.names[:count] not in touched), 0)
        if count and leaf.names[:count] not in seen:
            seen.add(leaf.names[:count])
            yield leaf, count


def _without(word: str, leaf: Leaf, count: int, partners: dict[Names, Leaf]) -> tuple[tuple[str, ...], str]:
    """The rule that leaves a field alone, and the loops that it stands in where it is one of elements.

    ``partners`` are leaves of the wire by arrays of either side.
    """
    arrays = [number for number, length in enumerate(leaf.arrays[: count - 1]) if length is not None]
    rule = f"{word} {_indexed(leaf, count)}"
    partner = partners.get(leaf.names[: arrays[-1] + 1]) if arrays else None
    if not arrays:
        return (), rule
    if partner is None or len(arrays) > len(VARIABLES):
        return (), f"# {rule}"
    ends = [number + 1 for number, length in enumerate(partner.arrays) if length is not None]
    heads = (f"for {VARIABLES[level]} from 0 to len({_indexed(partner, end)})" for level, end in enumerate(ends[: len(arrays)]))
    return tuple(heads), rule


def _in_loops(rules: list[tuple[tuple[str, ...], str]]) -> Iterator[str]:
    """Rules, those of one loop together."""
    for heads, group in groupby(sorted(rules, key=lambda each: each[0]), key=lambda each: each[0]):
        for level, head in enumerate(heads):
            yield f"{'  ' * (level + 1)}{head}"
        yield from (f"{'  ' * (len(heads) + 1)}{rule}" for _, rule in group)
        for level in range(len(heads), 0, -1):
            yield f"{'  ' * level}end"


def _indexed(leaf: Leaf, count: int) -> str:
    """The way to a field, with a variable for each array before it."""
    text, level = "", 0
    for number in range(count):
        text += f".{leaf.names[number]}"
        if leaf.arrays[number] is not None and number < count - 1:
            text += f"[{VARIABLES[level]}]"
            level += 1
    return text
