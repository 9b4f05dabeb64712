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

from collections.abc import Iterator
from itertools import count

from rosetta_jit.catalogue import resolve as words
from rosetta_jit.language import typed
from rosetta_jit.language.places import shown_place
from rosetta_jit.language.scope import Scope
from rosetta_jit.model.types import Array, Bool, Enum, Float, Int, Optional, Struct, Type, Union
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace


def last_ones(rules: tuple[typed.Rule, ...], scope: Scope) -> tuple[typed.Rule, ...]:
    """Rules of which none sets what a later one sets; a note says of each place which rule counts."""
    return _Overriding(scope, count(1)).block(rules)


@dataclass(frozen=True, slots=True)
class _Overriding:
    scope: Scope
    numbers: Iterator[int]

    def block(self, rules: tuple[typed.Rule, ...]) -> tuple[typed.Rule, ...]:
        kept: list[typed.Rule] = []
        for rule in rules:
            match rule:
                case typed.For(body=body):
                    self.add(kept, replace(rule, body=self.block(body)))
                case typed.When(then=then, otherwise=otherwise):
                    self.add(kept, replace(rule, then=self.block(then), otherwise=self.block(otherwise)))
                case _:
                    self.add(kept, rule)
        return tuple(kept)

    def add(self, kept: list[typed.Rule], rule: typed.Rule) -> None:
        """One more rule behind those that are ``kept``, which lose what it sets."""
        match rule:
            case typed.Assign(place) | typed.Default(place):
                earlier = [made for old in kept for made in self.without(old, place, rule.span)]
                merged = [self.merged(old, rule) for old in earlier]
                kept[:] = [old if found is None else found for old, found in zip(earlier, merged, strict=True)]
                kept += [] if any(merged) else [rule]
            case typed.SetLength(place):
                kept[:] = [old for old in kept if not (isinstance(old, typed.SetLength) and self.is_within(old, place, rule.span))]
                kept.append(rule)
            case typed.When(_, then, otherwise):
                pushed = [old for old in kept if isinstance(old, typed.Assign | typed.Default) and _sets(then, otherwise, old.place)]
                kept[:] = [old for old in kept if old not in pushed]
                kept.append(replace(rule, then=self.block((*pushed, *then)), otherwise=self.block((*pushed, *otherwise))))
            case typed.For(body=body):
                set_ = [each.place for each in body if isinstance(each, typed.Assign)]
                kept[:] = [old for old in kept if not (isinstance(old, typed.Assign) and self.is_element(old, set_, rule))]
                kept.append(rule)
            case _:
                kept.append(rule)

    def without(self, old: typed.Rule, place: typed.Place, span: Span | None) -> Iterator[typed.Rule]:
        """An earlier rule without what it sets at a place."""
        match old:
            case typed.Assign(typed.Place() as whole, typed.Access(), by=None) if _is_around(whole, place) and isinstance(
                whole.type, Struct
            ):
                parts = self.parts(old, whole.type)
                yield from [old] if not parts else (made for part in parts for made in self.without(part, place, span))
            case typed.Assign(typed.Place() as whole, typed.Access() as value, by=None) if self.is_element_of(place, whole):
                yield from self.loop(old, whole, value)
            case typed.Assign() | typed.Default() | typed.SetLength():
                yield from () if self.is_within(old, place, span) else (old,)
            case typed.For(body=body):
                left = tuple(made for each in body for made in self.without(each, place, span))
                yield from (replace(old, body=left),) if left or not body else ()
            case typed.When(then=then, otherwise=otherwise):
                blocks = [tuple(made for each in block for made in self.without(each, place, span)) for block in (then, otherwise)]
                yield replace(old, then=blocks[0], otherwise=blocks[1])
            case _:
                yield old

    def is_within(
        self,
        old: typed.Assignment | typed.Default[typed.Place] | typed.SetLength[typed.Place, typed.Expr],
        place: typed.Place,
        span: Span | None,
    ) -> bool:
        """Whether a rule sets what a later one sets, or a part of it; then a note says so."""
        found = old.place.steps[: len(place.steps)] == place.steps
        if found:
            self.note(old.place.steps, span, old.span)
        return found

    def is_element(self, old: typed.Assignment, places: list[typed.Place], loop: typed.For[typed.Rule, typed.Expr]) -> bool:
        """Whether a rule sets an element that a later loop sets."""
        found = loop.start == typed.Const(0, typed.INT64) and any(_number(old.place, each, loop.variable) is not None for each in places)
        if found:
            self.note(old.place.steps, loop.span, old.span)
        return found

    def merged(self, old: typed.Rule, rule: typed.Assignment | typed.Default[typed.Place]) -> typed.Rule | None:
        """An earlier loop with the value of a later rule for one of the elements; None where it is no such loop."""
        if not isinstance(old, typed.For) or not isinstance(rule, typed.Assign):
            return None
        for number, each in enumerate(old.body):
            at = _number(rule.place, each.place, old.variable) if isinstance(each, typed.Assign) else None
            if at is not None and isinstance(each, typed.Assign):
                self.note(rule.place.steps, rule.span, each.span)
                here = typed.Binary("==", typed.Local(old.variable, typed.INT64), typed.Const(at, typed.INT64), typed.BOOL)
                value = typed.Choice(((here, rule.value),), each.value, "", each.place.type, rule.span)
                return replace(old, body=(*old.body[:number], replace(each, value=value), *old.body[number + 1 :]))
        return None

    def note(self, steps: tuple[typed.Step, ...], span: Span | None, first: Span | None) -> None:
        self.scope.problems.append(words.overridden(span, shown_place(steps), first))

    # --- wholes ----------------------------------------------------------------------------------------------------------

    def parts(self, old: typed.Assignment, struct: Struct) -> list[typed.Rule]:
        """An assignment of a message field by field; none where one of the fields may be absent."""
        assert isinstance(old.value, typed.Access)
        origin = old.value.place
        if any(isinstance(self.resolved(old.place, field.type), Optional | Union) for field in struct.fields):
            return []
        ends = (
            [self.below(place, typed.FieldStep(field), field.type) for place in (old.place, origin)]
            for field in struct.fields
            if field.constant is None
        )
        return [typed.Assign(place, typed.Access(source, source.type, old.span), old.span) for place, source in ends]

    def loop(self, old: typed.Rule, whole: typed.Place, value: typed.Access) -> Iterator[typed.Rule]:
        """An assignment of an array as a loop over its elements."""
        assert isinstance(whole.type, Array)
        assert isinstance(value.type, Array)
        variable, length = typed.Local(f"whole~{next(self.numbers)}", typed.INT64), typed.LenOf(value.place, span=old.span)
        step = typed.IndexStep(variable)
        place, source = self.below(whole, step, whole.type.element), self.below(value.place, step, value.type.element)
        yield typed.SetLength(whole, length, old.span)
        element: typed.Assignment = typed.Assign(place, typed.Access(source, source.type, old.span), old.span)
        yield typed.For(variable.name, typed.Const(0, typed.INT64), length, (element,), old.span)

    def below(self, place: typed.Place, step: typed.Step, type_: Type) -> typed.Place:
        return typed.Place(place.side, (*place.steps, step), self.scope.messages[place.side].value_type(type_), place.span)

    def resolved(self, place: typed.Place, type_: Type) -> Type:
        return self.scope.messages[place.side].schema.resolve(type_)

    def is_element_of(self, place: typed.Place, whole: typed.Place) -> bool:
        """Whether a place is one number of an array that is assigned as a whole."""
        if not isinstance(whole.type, Array) or whole.type.fixed is not None or len(place.steps) != len(whole.steps) + 1:
            return False
        is_number = isinstance(place.type, Bool | Int | Float | Enum)
        return is_number and place.steps[:-1] == whole.steps and isinstance(place.steps[-1], typed.IndexStep)


def _is_around(whole: typed.Place, place: typed.Place) -> bool:
    """Whether a place lies in another one."""
    return len(whole.steps) < len(place.steps) and place.steps[: len(whole.steps)] == whole.steps


def _sets(then: tuple[typed.Rule, ...], otherwise: tuple[typed.Rule, ...], place: typed.Place) -> bool:
    """Whether a rule of one of two blocks sets a place."""
    set_ = [rule.place for rule in (*then, *otherwise) if isinstance(rule, typed.Assign | typed.Default)]
    inner = [rule for rule in (*then, *otherwise) if isinstance(rule, typed.When)]
    return any(place.steps[: len(each.steps)] == each.steps for each in set_) or any(
        _sets(each.then, each.otherwise, place) for each in inner
    )


def _number(place: typed.Place, element: typed.Place, variable: str) -> int | None:
    """The number of the round in which a loop sets a place that has a constant index; None where it does not."""
    if len(place.steps) != len(element.steps):
        return None
    found: int | None = None
    for step, other in zip(place.steps, element.steps, strict=True):
        match step, other:
            case typed.IndexStep(typed.Const(int(number))), typed.IndexStep(typed.Local(name)) if name == variable:
                found = number
            case _ if step != other:
                return None
            case _:
                pass
    return found
