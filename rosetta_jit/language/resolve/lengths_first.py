"""Lengths before the elements that they make room for: the order of rules is the writer's, and means nothing.

Only a length behind the first rule for an element of its array is moved, to before that rule: all others fail in the order of the text.
"""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.language.places import places_in
from rosetta_jit.language.typed import IndexStep, Place, Rule, SetLength, Step

Array = tuple["Step", ...]


def lengths_first(rules: tuple[Rule, ...]) -> tuple[Rule, ...]:
    """The rules of a block in an order in which they can run."""
    wanted = {rule.place.steps for rule in rules if isinstance(rule, SetLength)}
    if not wanted:
        return rules
    sizes = {len(steps) for steps in wanted}  # to hash the way to a place is the work here
    first: dict[Array, int] = {}
    early: dict[int, list[Rule]] = {}
    for number, rule in enumerate(rules):
        if isinstance(rule, SetLength) and rule.place.steps in first:
            early.setdefault(first[rule.place.steps], []).append(rule)
        for place in places_in((rule,)):
            for array in _arrays(place, sizes):
                first.setdefault(array, number)
    moved = {id(rule) for found in early.values() for rule in found}
    return tuple(
        each for number, rule in enumerate(rules) for each in (*early.get(number, ()), rule) if each is not rule or id(rule) not in moved
    )


def _arrays(place: Place, sizes: set[int]) -> Iterator[Array]:
    """The arrays that a place is in, of those with so many steps on the way to them."""
    for number, step in enumerate(place.steps):
        if number in sizes and isinstance(step, IndexStep):
            yield place.steps[:number]
