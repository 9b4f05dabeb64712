"""Filters: `.near[] = .ranges[] where .ranges[] < 1.0` as the rounds of a loop that are kept, of which each sets the next element.

Rules with the same condition keep the same elements. Those for fields of the elements of one array must have it, and share a loop.
"""

from __future__ import annotations

from rosetta_jit.catalogue import layouts as words
from rosetta_jit.language.arrays.counts import ZERO, LayoutError
from rosetta_jit.language.arrays.element_loops import element_at
from rosetta_jit.language.arrays.layouts import View, view_of
from rosetta_jit.language.arrays.parts import has_each, open_parts, sources_in, substituted
from rosetta_jit.model.expr import Call, Each, Expr, Index, Len, Name, Path
from rosetta_jit.model.mapping import Assignment, For, Rule
from rosetta_jit.model.rules import Kept
from rosetta_jit.startup.dataclass import dataclass, replace

FILTERED = "where"
"""What stands for the length of an array that a filter fills: no function that a mapping can call."""


@dataclass(frozen=True, slots=True)
class Filter:
    """A rule with `where`: ``target`` is filled from ``views`` in the rounds of ``loop`` that are kept; ``element`` sets one element."""

    target: View
    views: tuple[View, ...]
    loop: For[Rule, Expr]
    element: Assignment

    @property
    def length(self) -> Expr:
        """What stands for how many elements are kept: filters with the same one keep the same."""
        assert self.loop.kept is not None
        return Call(FILTERED, (self.loop.kept.condition, self.loop.stop), self.loop.span)


def filter_of(rule: Assignment, number: str, kept: str) -> Filter:
    """What a rule with `where` does with each element, in a loop over ``number``, where ``kept`` counts; raises LayoutError."""
    assert rule.where is not None
    is_whole = isinstance(rule.value, Path | Call) and not any(map(has_each, open_parts(rule.value))) and not has_each(rule.place)
    sources = [*sources_in(rule.where), *([rule.value] if is_whole and isinstance(rule.value, Path | Call) else sources_in(rule.value))]
    views = {source: view_of(source) for source in dict.fromkeys(sources)}
    if not views:
        raise LayoutError(words.filter_without_elements(rule.where.span))
    if any(len(view.axes) > 1 or any(axis.listed is not None for axis in view.axes) for view in views.values()):
        raise LayoutError(words.filter_order(rule.span))
    place = rule.place if has_each(rule.place) else replace(rule.place, steps=(*rule.place.steps, Each(rule.place.span)))
    target, round_ = view_of(place), Name(number)
    if target.axes[0].count != Len(target.array):
        raise LayoutError(words.filter_length(rule.place.span))
    elements: dict[Expr, Expr] = {source: element_at(view, [round_]) for source, view in views.items()}
    condition = substituted(rule.where, elements, round_)
    total = next(iter(views.values())).total
    steps = (*target.array.steps, Index(Name(kept), place.span), *target.rest)
    element = replace(rule, place=replace(place, steps=steps), value=substituted(rule.value, elements, round_), where=None)
    loop: For[Rule, Expr] = For(number, ZERO, total, (), rule.span, Kept(condition, kept))
    return Filter(target, tuple(views.values()), loop, element)


def is_filtered(length: Expr | None) -> bool:
    """Whether what is known of the length of an array is that a filter fills it."""
    return isinstance(length, Call) and length.function == FILTERED


def joined(made: list[Rule], loop: For[Rule, Expr]) -> For[Rule, Expr]:
    """A loop with the body of the one among the rules before that keeps the same rounds, which is taken from them."""
    for number in reversed(range(len(made))):
        other = made[number]
        if isinstance(other, For) and replace(other, body=()) == replace(loop, body=()):
            del made[number]
            return replace(other, body=(*other.body, *loop.body))
    return loop
