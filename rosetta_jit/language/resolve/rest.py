"""``ignore rest`` and ``default rest``: the fields that no rule reads, or sets, as rules that say so.

A note says which fields they are, so that a field which a schema gets later is not overlooked.
"""

from __future__ import annotations

from rosetta_jit.catalogue import rest as words
from rosetta_jit.language import typed
from rosetta_jit.language.limits import MAX_DEFAULTS
from rosetta_jit.language.places import field_names, places_in, rules_within, shown_names, shown_place, value_inside
from rosetta_jit.language.resolve.element_defaults import Elements, elements_of, lengths_in
from rosetta_jit.language.scope import Message, Scope
from rosetta_jit.language.typed import INT64, Assign, Const, Expr, FieldStep, Ignore, IndexStep, Place, Rule, SetLength
from rosetta_jit.language.untouched import Names, never_set, unread, untouched
from rosetta_jit.model.expr import Member, Path
from rosetta_jit.model.mapping import Default, Rest
from rosetta_jit.model.types import Array, Bool, Float, Int, Struct, Union
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace


def ignored(rest: Rest, rules: tuple[Rule, ...], scope: Scope) -> list[Ignore[Place]]:
    """That nothing reads each field which the rules do not read."""
    side = scope.origin
    source, within = scope.messages[side], field_names(scope.base(side))
    found = unread(rules, source, within)
    _note(rest, found, within, scope)
    return [Ignore(_place(names[len(within) :], scope.base(side), source, rest.span), rest.span) for names in found]


def defaulted(
    rest: Rest, rules: tuple[Rule, ...], broken: list[Names], scope: Scope
) -> tuple[list[Default[Path]], list[tuple[Elements, Span | None]]]:
    """That each field which the rules do not set has its default, and each within the elements of an array whose length they set."""
    side = scope.target
    target, within = scope.messages[side], field_names(scope.base(side))
    single = [names for names in never_set(rules, target, within) if not _is_broken(names, broken)]
    single = [names for names in single if not _is_in_array(names[len(within) :], target) and not _is_case(names[len(within) :], target)]
    touched = {field_names(rule.place) for rule in rules_within(rules) if isinstance(rule, Assign | typed.Default)}
    known, elements = lengths_in(rules), dict["Names", "Elements"]()
    for names in untouched(touched, target, target.root, within):
        inner = elements_of(names, target, within)
        if inner is not None and inner.array in known and not _is_broken(names, broken):
            elements[names] = inner
    _note(rest, [*single, *elements], within, scope)
    rules_of_fields = [Default(Path(side, tuple(Member(name) for name in names[len(within) :]), rest.span), rest.span) for names in single]
    return rules_of_fields, [(each, rest.span) for each in elements.values()]


def _is_broken(names: Names, broken: list[Names]) -> bool:
    return any(names[: len(each)] == each for each in broken)


def elements_filled(rules: tuple[Rule, ...], scope: Scope) -> tuple[Rule, ...]:
    """The rules, with 0 in place of each number of an array of known length that no rule sets, where all others are named."""
    return (*rules, *(made for rule in rules if isinstance(rule, SetLength) for made in _filled(rule, rules, scope)))


def _filled(rule: SetLength[Place, Expr], rules: tuple[Rule, ...], scope: Scope) -> list[Rule]:
    array, length = rule.place, rule.value
    type_ = array.type.element if isinstance(array.type, Array) else None
    if not isinstance(length, Const) or not isinstance(type_, Int | Float | Bool) or int(length.value) > MAX_DEFAULTS:
        return []
    size = len(array.steps)
    inside = [place for place in places_in(rules) if len(place.steps) > size and place.steps[:size] == array.steps]
    named = {step.index.value for place in inside if isinstance(step := place.steps[size], IndexStep) and isinstance(step.index, Const)}
    if len(named) < len(inside):
        return []  # what loops set is known to the checks alone
    left = [number for number in range(int(length.value)) if number not in named]
    if left:
        shown = [shown_place((*array.steps, IndexStep(Const(number, INT64)))) for number in left]
        scope.problems.append(words.rest(rule.span, "default", _direction(scope), shown))
    zero = Const(value=False if isinstance(type_, Bool) else 0, type=type_, span=rule.span)
    number = replace(zero, value=0.0) if isinstance(type_, Float) else zero
    places = (Place(array.side, (*array.steps, IndexStep(Const(each, INT64))), type_, rule.span) for each in left)
    return [Assign(place, number, rule.span) for place in places]


def _direction(scope: Scope) -> str:
    return "unpacking" if scope.target == "holder" else "packing"


def _note(rest: Rest, found: list[Names], within: Names, scope: Scope) -> None:
    side = scope.origin if rest.word == "ignore" else scope.target
    shown = [shown_names(names[len(within) :], scope.messages[side]) for names in found]
    if shown or rest.written:
        scope.problems.append(words.rest(rest.span, rest.word, _direction(scope), shown))


def _place(names: Names, base: Place, message: Message, span: Span | None) -> Place:
    """A field of a message that lies at ``base``; of the elements of an array, any one."""
    steps, type_ = [*base.steps], message.value_type(message.root)
    for name in names:
        assert isinstance(type_, Struct | Union)
        field = next(each for each in (type_.fields if isinstance(type_, Struct) else type_.cases) if each.name == name)
        steps.append(FieldStep(field))
        type_ = value_inside(message, field.type)
    return Place(base.side, tuple(steps), type_, span)


def _is_case(names: Names, message: Message) -> bool:
    """Whether a field is a case of a union of which rules set another case, or lies in one."""
    around = (_place(names[:count], Place(side="wire", steps=(), type=message.root), message, None) for count in range(1, len(names)))
    return any(isinstance(place.type, Union) for place in around)


def _is_in_array(names: Names, message: Message) -> bool:
    """Whether a field is one of an array's elements."""
    around = [_place(names[:count], Place(side="wire", steps=(), type=message.root), message, None) for count in range(1, len(names))]
    fields = (place.steps[-1] for place in around)
    return any(isinstance(step, FieldStep) and isinstance(message.value_type(step.field.type), Array) for step in fields)
