"""Functions of several values in rules: which numbers stand for a group, and what each component of a call is.

`.orientation = quaternion(.roll, .pitch, .yaw)` sets `.orientation.x` to the component `quaternion.x` of the call, and so on. Which places
the components go to depends on the type of the place: a struct has fields of their names, an array has them in their order.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import groups as words
from rosetta_jit.catalogue import resolve as names
from rosetta_jit.language.conversions import FLOAT64, convert, describe
from rosetta_jit.language.groups import FLOATS, Group, GroupFunction, Member, arguments_of, component, function_of, group_of
from rosetta_jit.language.scope import Broken, Scope, Sought, members_of, resolve_path
from rosetta_jit.language.typed import Call, Expr
from rosetta_jit.language.units.conversion import factors_between, unit_of
from rosetta_jit.language.units.numbers import scaled
from rosetta_jit.model import expr as model
from rosetta_jit.model import mapping
from rosetta_jit.model.types import Array, Struct, Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    TypeExpr = Callable[[model.Expr, Scope], Expr | None]
    TypeIndex = Callable[[model.Expr | Sought, Scope], Expr | None]


# --- values --------------------------------------------------------------------------------------------------------------


def type_component(item: model.Item, scope: Scope, type_expr: TypeExpr, type_index: TypeIndex) -> Expr | None:
    """One number of a group, by its position."""
    assert isinstance(item.index, model.Literal)
    of_items = group_of(item.items)
    assert of_items is not None
    number = [each.names[0] for each in of_items.components].index(str(item.index.value))
    if function_of(item.items) is not None:
        typed = type_group(item.items, scope, type_expr, type_index)
        return None if typed is None else typed[number]
    found = components_of(item.items, of_items, scope, type_index)
    return None if found is None else type_expr(found[number], scope)


def type_group(value: model.Expr, scope: Scope, type_expr: TypeExpr, type_index: TypeIndex) -> list[Expr] | None:
    """All numbers of a value that is a group; None where one has no type."""
    match value:
        case model.Coerced(value=inner):
            return type_group(inner, scope, type_expr, type_index)
        case model.Call() if (function := function_of(value)) is not None:
            return _called(value, function, scope, type_expr, type_index)
        case _:
            group = group_of(value)
            assert group is not None
            found = components_of(value, group, scope, type_index)
            typed = [type_expr(each, scope) for each in found or ()]
            known = [each for each in typed if each is not None]
            return known if found is not None and len(known) == len(typed) else None


def _called(call: model.Call, function: GroupFunction, scope: Scope, type_expr: TypeExpr, type_index: TypeIndex) -> list[Expr] | None:
    """The components of a call, which all have its arguments: all numbers of all groups that it takes."""
    arguments = arguments_of(call, function)
    if arguments is None:
        groups = [(each.group.name, [member.names[0] for member in each.group.components]) for each in function.parameters]
        scope.problems.append(words.arguments(call.span, call.function, groups, len(call.arguments)))
        return None
    typed: list[Expr] = []
    for argument, parameter in zip(arguments, function.parameters, strict=True):
        found = _argument(argument, parameter.group, scope, type_expr, type_index)
        if found is None:
            return None
        typed += found
    return [Call(each.name, tuple(typed), FLOAT64, call.span) for each in function.components]


def _argument(value: model.Expr, group: Group, scope: Scope, type_expr: TypeExpr, type_index: TypeIndex) -> list[Expr] | None:
    """The numbers of an argument, each in the unit that the function takes."""
    own = group_of(value)
    if own is not None and own != group:
        scope.problems.append(words.other_group(value.span, own.name, group.name))
        return None
    if own is not None and function_of(value) is not None:
        return type_group(value, scope, type_expr, type_index)
    found = components_of(value, group, scope, type_index)
    typed = [_typed(each, member, scope, type_expr) for each, member in zip(found or (), group.components, strict=False)]
    known = [each for each in typed if each is not None]
    return known if found is not None and len(known) == len(typed) else None


def _typed(value: model.Expr, member: Member, scope: Scope, type_expr: TypeExpr) -> Expr | None:
    """A number of a group as a float64, in the unit of the component that it stands for."""
    typed = type_expr(value, scope)
    if typed is None:
        return None
    wide = convert(typed, FLOAT64)
    if wide is None:
        scope.problems.append(names.needs_word(typed.span, describe(typed.type), "float64", "`float64(...)` rounds to the nearest"))
        return None
    known = unit_of(typed)
    if member.unit is None or not isinstance(known, str) or known == member.unit:
        return wide
    factors = factors_between(known, member.unit, typed.span, scope.problems)
    return wide if factors == (1.0, 0.0) or factors is None else scaled(wide, FLOAT64, factors)


# --- what stands for a group -----------------------------------------------------------------------------------------------


def components_of(value: model.Expr, group: Group, scope: Scope, type_index: TypeIndex) -> list[model.Expr] | None:
    """An expression for each number of a group that a value stands for; None where it stands for none, which is reported."""
    match value:
        case model.Coerced(value=inner):
            return components_of(inner, group, scope, type_index)
        case model.Choice(cases, otherwise):
            return _chosen(value, cases, otherwise, group, scope, type_index)
        case model.Call(function, (inner, *rest)) if function in FLOATS and group_of(inner) is not None:
            found = components_of(inner, group, scope, type_index)
            return None if found is None else [replace(value, arguments=(each, *rest)) for each in found]
        case model.Call() if group_of(value) is not None:
            return [component(value, number) for number in range(len(group.components))]
        case model.List(items):
            return _of_count([*items], len(items), group, value.span, scope)
        case model.Given(name, _, element, is_list=True):
            count = len(group.components)
            return [model.Given(name, (model.Literal(number, value.span),), element, value.span) for number in range(count)]
        case model.Path():
            place = resolve_path(value, scope, type_index)
            paths = None if isinstance(place, Broken) else paths_of(value, place.type, group, scope)
            return None if paths is None else [*paths]
        case _ if len(group.components) == 1:
            return [value]
        case _:
            scope.problems.append(words.not_a_group(value.span, "one value", group.name))
            return None


def _chosen(
    choice: model.Choice,
    cases: tuple[tuple[model.Expr, model.Expr], ...],
    otherwise: model.Expr | None,
    group: Group,
    scope: Scope,
    type_index: TypeIndex,
) -> list[model.Expr] | None:
    """A choice among groups as one among the numbers of each."""
    values = [components_of(value, group, scope, type_index) for _, value in cases]
    rest = None if otherwise is None else components_of(otherwise, group, scope, type_index)
    known = [each for each in values if each is not None]
    if len(known) < len(values) or (rest is None) != (otherwise is None):
        return None
    conditions = [condition for condition, _ in cases]
    return [
        replace(
            choice,
            cases=tuple((condition, value[number]) for condition, value in zip(conditions, known, strict=True)),
            otherwise=None if rest is None else rest[number],
        )
        for number in range(len(group.components))
    ]


def _of_count(found: list[model.Expr], count: int, group: Group, span: Span | None, scope: Scope) -> list[model.Expr] | None:
    if count == len(group.components):
        return found
    scope.problems.append(words.list_size(span, group.name, _names(group), count))
    return None


def paths_of(path: model.Path, type_: Type, group: Group, scope: Scope) -> list[model.Path] | None:
    """The places of the numbers of a group at a place: the fields of a struct, or the elements of an array."""
    if isinstance(type_, Array):
        numbers = range(len(group.components))
        if type_.fixed is not None and type_.fixed != len(numbers):
            scope.problems.append(words.list_size(path.span, group.name, _names(group), type_.fixed))
            return None
        return [replace(path, steps=(*path.steps, model.Index(model.Literal(number, path.span), path.span))) for number in numbers]
    if isinstance(type_, Struct):
        return _fields(path, type_, group, scope)
    if len(group.components) == 1 and path.side != scope.target:
        return [path]
    report = words.alone(path.span, group.name, _names(group)) if path.side == scope.target else None
    scope.problems.append(report or words.not_a_group(path.span, describe(type_), group.name))
    return None


def _fields(path: model.Path, type_: Struct, group: Group, scope: Scope) -> list[model.Path] | None:
    message = scope.messages[path.side]
    members = members_of(type_, message.schema)
    found: list[model.Path] = []
    missing: list[str] = []
    for member in group.members:
        name = next((each for each in member.names if each in members), None)
        if name is None:
            missing.append(member.names[0])
            continue
        inner = replace(path, steps=(*path.steps, model.Member(name, path.span)))
        within = [inner] if member.group is None else paths_of(inner, message.value_type(members[name][-1].type), member.group, scope)
        if within is None:
            return None
        found += within
    if missing:
        scope.problems.append(words.missing_members(path.span, type_.name, group.name, missing))
    return None if missing else found


def _names(group: Group) -> list[str]:
    return [each.names[0] for each in group.components]


# --- lengths ---------------------------------------------------------------------------------------------------------------


def length_rules(rule: mapping.Assignment, type_: Type, group: Group, scope: Scope, type_index: TypeIndex) -> list[mapping.Rule]:
    """What a rule says of lengths besides: that of the array which it sets, and of those that it reads."""
    quiet = replace(scope, problems=[])
    found: list[mapping.Rule] = []
    for path, wanted in _paths_in(rule.value):
        place = resolve_path(path, quiet, type_index)
        if not isinstance(place, Broken) and isinstance(place.type, Array) and place.type.fixed is None:
            count = len(wanted.components)
            other = model.Binary("!=", model.Len(path, path.span), model.Literal(count, path.span), path.span)
            found.append(mapping.When(other, (mapping.Reject(words.wrong_length(wanted.name, count), rule.span),), (), rule.span))
    if isinstance(type_, Array) and type_.fixed is None:
        found.append(mapping.SetLength(rule.place, model.Literal(len(group.components), rule.span), rule.span))
    return found


def _paths_in(value: model.Expr) -> list[tuple[model.Path, Group]]:
    """The places that stand for groups in a value, each with the group that it stands for."""
    match value:
        case model.Coerced(value=inner):
            return _paths_in(inner)
        case model.Choice(cases, otherwise):
            return [each for chosen in (*(value for _, value in cases), otherwise) if chosen is not None for each in _paths_in(chosen)]
        case model.Call() if (function := function_of(value)) is not None:
            pairs = zip(arguments_of(value, function) or (), function.parameters, strict=False)
            return [each for argument, parameter in pairs for each in _standing(argument, parameter.group)]
        case model.Call(function, (inner, *_)) if function in FLOATS:
            return _paths_in(inner)
        case model.Item(items=items):
            return _paths_in(items)
        case _:
            return []


def _standing(argument: model.Expr, group: Group) -> list[tuple[model.Path, Group]]:
    match argument:
        case model.Path():
            return [(argument, group)]
        case model.Coerced(value=inner):
            return _standing(inner, group)
        case model.List(items):
            return [each for item in items for each in _paths_in(item)]
        case _:
            return _paths_in(argument)
