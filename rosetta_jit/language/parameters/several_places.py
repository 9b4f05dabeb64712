"""Rules for several places, and rules that assign a list, as one rule a place.

Of `.roll, .pitch, .yaw = euler(.q)` the value is a group of as many numbers (`language.groups`), of which each place gets one; or a list,
of which each gets an item; or it is computed from the parts of a text, `number(split(.t, ","))`, of which each place gets one. For both
directions a group stays whole, for it is turned round as a whole: a `Relation` with a list of places.

`.names = ["yaw", "roll"]` is `len(.names) = 2`, `.names[0] = "yaw"` and `.names[1] = "roll"`. A long list of constants, and one whose
length is not known, is assigned in a loop.
"""

from __future__ import annotations

from rosetta_jit.catalogue import derive
from rosetta_jit.catalogue import groups as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.groups import component, group_functions, group_of
from rosetta_jit.language.limits import MAX_SINGLE
from rosetta_jit.model.expr import Binary, Call, Expr, Given, Index, Item, Len, List, Literal, Name, Path
from rosetta_jit.model.mapping import Assign, Assignment, Default, For, Reject, Relation, Rule, SetLength, Several, When
from rosetta_jit.model.types import Int
from rosetta_jit.model.walk import parts, rebuilt
from rosetta_jit.startup.dataclass import replace


def one_by_one(rule: Several, problems: list[Diagnostic]) -> tuple[Rule, ...]:
    """The rules that a rule for several places stands for; reported where its value has not as many numbers."""
    group = group_of(rule.value)
    if group is not None:
        values: tuple[Expr, ...] = tuple(component(rule.value, number) for number in range(len(group.components)))
    elif isinstance(rule.value, List):
        values = rule.value.items
    elif any(_is_split(part) for part in parts(rule.value)):
        values = tuple(_with_part(rule.value, number) for number in range(len(rule.places)))
    else:
        called = rule.value.function if isinstance(rule.value, Call) else ""
        problems.append(words.no_group(rule.value.span, called, group_functions()))
        return tuple(Default(place, rule.span) for place in rule.places)  # nothing more is to be said of them
    if len(values) != len(rule.places):
        names = () if group is None else tuple(each.names[0] for each in group.components)
        problems.append(words.other_count(rule.span, len(rule.places), len(values), names))
        return tuple(Assign(place, value, rule.span) for place, value in zip(rule.places, values, strict=False) if not rule.is_relation)
    if rule.is_relation and group is not None:
        return (Relation(List(rule.places, rule.span), rule.value, rule.span),)
    pairs = tuple(zip(rule.places, values, strict=True))
    if rule.is_relation:
        return tuple(Relation(place, value, rule.span) for place, value in pairs)
    checks = tuple(_other_parts(part, len(pairs)) for part in parts(rule.value) if isinstance(part, Call) and _is_split(part))
    return (*checks, *(Assign(place, value, rule.span) for place, value in pairs))


def _is_split(expr: Expr) -> bool:
    return isinstance(expr, Call) and expr.function == "split"


def _with_part(expr: Expr, number: int) -> Expr:
    """An expression of all parts of a text as one of a single part."""
    if isinstance(expr, Call) and _is_split(expr):
        return replace(expr, function="part", arguments=(*expr.arguments, Literal(number, expr.span)))
    return rebuilt(expr, lambda each: _with_part(each, number))


def _other_parts(split: Call, count: int) -> Rule:
    """A rejection of texts with another number of parts than there are places."""
    other = Binary("!=", replace(split, function="parts"), Literal(count, split.span), split.span)
    return When(other, (Reject(derive.OTHER_PARTS, split.span),), (), split.span)


def spread(rule: Rule, variables: tuple[str, ...]) -> tuple[Rule, ...]:
    """The rules that a rule with a list stands for; ``variables`` are those of the loops around it."""
    match rule:
        case Assign(place=Path() as place, value=(List() | Given(is_list=True)) as value):
            return _spread(rule, place, value, variables)
        case Relation(place=Path() as place, value=(List() | Given(is_list=True)) as value):
            return _spread(rule, place, value, variables)
        case _:
            return (rule,)


def _spread(rule: Assignment | Relation, place: Path, value: List | Given, variables: tuple[str, ...]) -> tuple[Rule, ...]:
    match value:
        case List(items) if len(items) > MAX_SINGLE and all(isinstance(item, Literal) for item in items):
            count: Expr = Literal(len(items), value.span)
            return (_length(rule, place, count), *_loop(rule, place, value, count, variables))
        case List(items):
            single = [_item(rule, place, Literal(number, item.span), item, variables) for number, item in enumerate(items)]
            return (_length(rule, place, Literal(len(items), value.span)), *(found for each in single for found in each))
        case Given(name):
            count = Given(f"len({name})", (), Int(64), value.span)
            return (_length(rule, place, count), *_loop(rule, place, value, count, variables))


def _loop(rule: Assignment | Relation, place: Path, value: List | Given, count: Expr, variables: tuple[str, ...]) -> tuple[Rule, ...]:
    variable = next(name for name in ("item", *(f"item_{number}" for number in range(2, 100))) if name not in variables)
    index = Name(variable, value.span)
    if isinstance(value, Given):
        item: Expr = Given(value.name, (index,), value.type, value.span)
    else:
        item = Item(value, index, value.span)
    body = _item(rule, place, index, item, (*variables, variable))
    return (For(variable, Literal(0, value.span), count, body, rule.span),)


def _item(rule: Assignment | Relation, place: Path, index: Expr, value: Expr, variables: tuple[str, ...]) -> tuple[Rule, ...]:
    element = replace(place, steps=(*place.steps, Index(index, place.span)))
    return spread(replace(rule, place=element, value=value), variables)


def _length(rule: Assignment | Relation, place: Path, count: Expr) -> Rule:
    if isinstance(rule, Relation):
        return Relation(Len(place, place.span), count, rule.span)
    return SetLength(place, count, rule.span)
