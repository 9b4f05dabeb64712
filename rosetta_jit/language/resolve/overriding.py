"""``edition: 2012``: of several rules for one place the last one counts.

    .a = x                 .a = y                               .a = y
    .p = .q                .p.x = y                             .p.x = y, and each other field of .p from .q
    for i … .a[i] = x      .a[2] = y                            for i … .a[i] = y if i == 2 else x
    .a = .b                .a[2] = y                            the same, of a loop over .b
    .a = x                 when c .a = y end                    when c .a = y else .a = x end

No rule sees what another one has set, so that a rule which is overridden need not run. What is none of these forms is reported as a place
that is set twice, as in every mapping.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import count
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import resolve as words
from rosetta_jit.language.places import shown_place
from rosetta_jit.language.typed import (
    BOOL,
    INT64,
    Access,
    Assign,
    Binary,
    Choice,
    Const,
    Default,
    FieldStep,
    For,
    IndexStep,
    LenOf,
    Local,
    Place,
    SetLength,
    When,
)
from rosetta_jit.model.types import Array, Bool, Enum, Float, Int, Optional, Struct, Union
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.language.scope import Scope
    from rosetta_jit.language.typed import Assignment, Expr, Rule, Step
    from rosetta_jit.model.types import Type
    from rosetta_jit.source import Span


def last_ones(rules: tuple[Rule, ...], scope: Scope) -> tuple[Rule, ...]:
    """Rules of which none sets what a later one sets; a note says of each place which rule counts."""
    return _Overriding(scope, count(1)).block(rules)


@dataclass(frozen=True, slots=True)
class _Overriding:
    scope: Scope
    numbers: Iterator[int]

    def block(self, rules: tuple[Rule, ...]) -> tuple[Rule, ...]:
        kept: list[Rule] = []
        for rule in rules:
            match rule:
                case For(body=body):
                    self.add(kept, replace(rule, body=self.block(body)))
                case When(then=then, otherwise=otherwise):
                    self.add(kept, replace(rule, then=self.block(then), otherwise=self.block(otherwise)))
                case _:
                    self.add(kept, rule)
        return tuple(kept)

    def add(self, kept: list[Rule], rule: Rule) -> None:
        """One more rule behind those that are ``kept``, which lose what it sets."""
        match rule:
            case Assign(place) | Default(place):
                earlier = [made for old in kept for made in self.without(old, place, rule.span)]
                merged = [self.merged(old, rule) for old in earlier]
                kept[:] = [old if found is None else found for old, found in zip(earlier, merged, strict=True)]
                kept += [] if any(merged) else [rule]
            case SetLength(place):
                kept[:] = [old for old in kept if not (isinstance(old, SetLength) and self.is_within(old, place, rule.span))]
                kept.append(rule)
            case When(_, then, otherwise):
                pushed = [old for old in kept if isinstance(old, Assign | Default) and _sets(then, otherwise, old.place)]
                kept[:] = [old for old in kept if old not in pushed]
                kept.append(replace(rule, then=self.block((*pushed, *then)), otherwise=self.block((*pushed, *otherwise))))
            case For(body=body):
                set_ = [each.place for each in body if isinstance(each, Assign)]
                kept[:] = [old for old in kept if not (isinstance(old, Assign) and self.is_element(old, set_, rule))]
                kept.append(rule)
            case _:
                kept.append(rule)

    def without(self, old: Rule, place: Place, span: Span | None) -> Iterator[Rule]:
        """An earlier rule without what it sets at a place."""
        match old:
            case Assign(Place() as whole, Access(), by=None) if _is_around(whole, place) and isinstance(whole.type, Struct):
                parts = self.parts(old, whole.type)
                yield from [old] if not parts else (made for part in parts for made in self.without(part, place, span))
            case Assign(Place() as whole, Access() as value, by=None) if self.is_element_of(place, whole):
                yield from self.loop(old, whole, value)
            case Assign() | Default() | SetLength():
                yield from () if self.is_within(old, place, span) else (old,)
            case For(body=body):
                left = tuple(made for each in body for made in self.without(each, place, span))
                yield from (replace(old, body=left),) if left or not body else ()
            case When(then=then, otherwise=otherwise):
                blocks = [tuple(made for each in block for made in self.without(each, place, span)) for block in (then, otherwise)]
                yield replace(old, then=blocks[0], otherwise=blocks[1])
            case _:
                yield old

    def is_within(self, old: Assignment | Default[Place] | SetLength[Place, Expr], place: Place, span: Span | None) -> bool:
        """Whether a rule sets what a later one sets, or a part of it; then a note says so."""
        found = old.place.steps[: len(place.steps)] == place.steps
        if found:
            self.note(old.place.steps, span, old.span)
        return found

    def is_element(self, old: Assignment, places: list[Place], loop: For[Rule, Expr]) -> bool:
        """Whether a rule sets an element that a later loop sets."""
        found = loop.start == Const(0, INT64) and any(_number(old.place, each, loop.variable) is not None for each in places)
        if found:
            self.note(old.place.steps, loop.span, old.span)
        return found

    def merged(self, old: Rule, rule: Assignment | Default[Place]) -> Rule | None:
        """An earlier loop with the value of a later rule for one of the elements; None where it is no such loop."""
        if not isinstance(old, For) or not isinstance(rule, Assign):
            return None
        for number, each in enumerate(old.body):
            at = _number(rule.place, each.place, old.variable) if isinstance(each, Assign) else None
            if at is not None and isinstance(each, Assign):
                self.note(rule.place.steps, rule.span, each.span)
                here = Binary("==", Local(old.variable, INT64), Const(at, INT64), BOOL)
                value = Choice(((here, rule.value),), each.value, "", each.place.type, rule.span)
                return replace(old, body=(*old.body[:number], replace(each, value=value), *old.body[number + 1 :]))
        return None

    def note(self, steps: tuple[Step, ...], span: Span | None, first: Span | None) -> None:
        self.scope.problems.append(words.overridden(span, shown_place(steps), first))

    # --- wholes ----------------------------------------------------------------------------------------------------------

    def parts(self, old: Assignment, struct: Struct) -> list[Rule]:
        """An assignment of a message field by field; none where one of the fields may be absent."""
        assert isinstance(old.value, Access)
        origin = old.value.place
        if any(isinstance(self.resolved(old.place, field.type), Optional | Union) for field in struct.fields):
            return []
        ends = (
            [self.below(place, FieldStep(field), field.type) for place in (old.place, origin)]
            for field in struct.fields
            if field.constant is None
        )
        return [Assign(place, Access(source, source.type, old.span), old.span) for place, source in ends]

    def loop(self, old: Rule, whole: Place, value: Access) -> Iterator[Rule]:
        """An assignment of an array as a loop over its elements."""
        assert isinstance(whole.type, Array)
        assert isinstance(value.type, Array)
        variable, length = Local(f"whole~{next(self.numbers)}", INT64), LenOf(value.place, span=old.span)
        step = IndexStep(variable)
        place, source = self.below(whole, step, whole.type.element), self.below(value.place, step, value.type.element)
        yield SetLength(whole, length, old.span)
        element: Assignment = Assign(place, Access(source, source.type, old.span), old.span)
        yield For(variable.name, Const(0, INT64), length, (element,), old.span)

    def below(self, place: Place, step: Step, type_: Type) -> Place:
        return Place(place.side, (*place.steps, step), self.scope.messages[place.side].value_type(type_), place.span)

    def resolved(self, place: Place, type_: Type) -> Type:
        return self.scope.messages[place.side].schema.resolve(type_)

    def is_element_of(self, place: Place, whole: Place) -> bool:
        """Whether a place is one number of an array that is assigned as a whole."""
        if not isinstance(whole.type, Array) or whole.type.fixed is not None or len(place.steps) != len(whole.steps) + 1:
            return False
        is_number = isinstance(place.type, Bool | Int | Float | Enum)
        return is_number and place.steps[:-1] == whole.steps and isinstance(place.steps[-1], IndexStep)


def _is_around(whole: Place, place: Place) -> bool:
    """Whether a place lies in another one."""
    return len(whole.steps) < len(place.steps) and place.steps[: len(whole.steps)] == whole.steps


def _sets(then: tuple[Rule, ...], otherwise: tuple[Rule, ...], place: Place) -> bool:
    """Whether a rule of one of two blocks sets a place."""
    set_ = [rule.place for rule in (*then, *otherwise) if isinstance(rule, Assign | Default)]
    inner = [rule for rule in (*then, *otherwise) if isinstance(rule, When)]
    return any(place.steps[: len(each.steps)] == each.steps for each in set_) or any(
        _sets(each.then, each.otherwise, place) for each in inner
    )


def _number(place: Place, element: Place, variable: str) -> int | None:
    """The number of the round in which a loop sets a place that has a constant index; None where it does not."""
    if len(place.steps) != len(element.steps):
        return None
    found: int | None = None
    for step, other in zip(place.steps, element.steps, strict=True):
        match step, other:
            case IndexStep(Const(int(number))), IndexStep(Local(name)) if name == variable:
                found = number
            case _ if step != other:
                return None
            case _:
                pass
    return found
