"""Names and types of a mapping's rules: `model.mapping` → `language.typed`.

Every rule that can be typed is typed; what cannot be is reported, and the field that it meant is remembered, so that
the checks that follow do not report the same mistake in other words.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.catalogue import layouts
from rosetta_jit.catalogue import resolve as words
from rosetta_jit.catalogue import rest as about_rest
from rosetta_jit.catalogue import state as states
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language import typed
from rosetta_jit.language.arrays.elementwise import elementwise
from rosetta_jit.language.conversions import FLOAT64, describe, is_single, same
from rosetta_jit.language.groups import Group, group_of
from rosetta_jit.language.limits import MAX_DEFAULTS, MAX_PROBLEMS
from rosetta_jit.language.places import field_names, places_in
from rosetta_jit.language.resolve.defaults import ManyDefaultsError, default_rules, has_array
from rosetta_jit.language.resolve.element_defaults import is_of_elements, named_elements, with_defaults
from rosetta_jit.language.resolve.expressions import type_expr, type_index, type_integer
from rosetta_jit.language.resolve.fitting import fit
from rosetta_jit.language.resolve.keyed_rules import numbered
from rosetta_jit.language.resolve.lengths_first import lengths_first
from rosetta_jit.language.resolve.messages import checked_message, scope_between
from rosetta_jit.language.scope import Broken, Message, Scope, element_type, resolve_path
from rosetta_jit.language.units.conversion import in_unit
from rosetta_jit.language.units.wholes import change_within
from rosetta_jit.language.uses import EnoughError, Signature, UsableMappings
from rosetta_jit.model import expr
from rosetta_jit.model import mapping as model
from rosetta_jit.model.expr import Side
from rosetta_jit.model.rules import Kept
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Map, Schema, String, Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.startup.late import Late, late

if TYPE_CHECKING:
    from rosetta_jit.language.functions import decisions, texts
    from rosetta_jit.language.resolve import coerced_values, groups, nested, overriding, same_names
    from rosetta_jit.language.resolve import rest as rest_rules
else:
    decisions = Late("rosetta_jit.language.functions.decisions")
    coerced_values, groups = late("rosetta_jit.language.resolve", "coerced_values", "groups")
    overriding, rest_rules, same_names = late("rosetta_jit.language.resolve", "overriding", "rest", "same_names")
    nested = Late("rosetta_jit.language.resolve.nested")
    texts = Late("rosetta_jit.language.functions.texts")


@dataclass(frozen=True, slots=True)
class TypedRules:
    """One direction: the rules that have types, and the fields that broken rules meant to set."""

    rules: tuple[typed.Rule, ...]
    broken: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True)
class Resolved:
    """Both directions, None where the mapping has no block; the declarations that they name; what is wrong with names and types."""

    holder: Message
    wire: Message
    unpack: TypedRules | None
    pack: TypedRules | None
    named: frozenset[str]
    problems: tuple[Diagnostic, ...]
    functions: Mapping[str, Signature]


def resolve(
    mapping: model.Mapping, holder: Schema, wire: Schema, usable: UsableMappings, state: Mapping[Side, Mapping[str, typed.StateVariable]]
) -> Resolved | tuple[Diagnostic, ...]:
    """Type the rules of a mapping against the schemas of its two sides; only problems where a side has no message.

    ``usable`` are the mappings that its rules may use; ``state`` has its state variables, for the rules that fill each side.
    """
    problems: list[Diagnostic] = []
    holder_type = checked_message(holder, mapping.holder_type, mapping.holder_span, problems)
    unknown = [each for each in mapping.wires if checked_message(wire, each.type, each.span, problems) is None]
    if unknown:
        return tuple(problems)
    wire_type = checked_message(wire, mapping.wire_type, mapping.wire_span, problems)
    if holder_type is None or wire_type is None:
        return tuple(problems)
    scope = scope_between({"holder": holder_type, "wire": wire_type}, mapping, usable, problems)
    try:
        unpack = _block(mapping.unpack_rules, replace(scope, state=state["holder"]))
        pack = _block(mapping.pack_rules, replace(scope, target="wire", state=state["wire"]))
    except EnoughError:
        return tuple(problems)
    return Resolved(holder_type, wire_type, unpack, pack, frozenset(scope.named), tuple(problems), scope.functions)


@dataclass(frozen=True, slots=True)
class _Block:
    """Types the rules of one direction."""

    broken: list[tuple[str, ...]] = field(default_factory=list[tuple[str, ...]])

    def whole(self, rules: tuple[model.Rule, ...], scope: Scope) -> tuple[typed.Rule, ...]:
        """All rules of one mapping for a direction."""
        left = [rule for rule in rules if isinstance(rule, model.Rest) or is_of_elements(rule)]
        written = tuple(rule for rule in rules if rule not in left)
        found = self.rules(elementwise(numbered(written, scope), scope, self.broken), scope)
        rests = [rule for rule in left if isinstance(rule, model.Rest)]
        if scope.is_old and rules:
            found = rest_rules.elements_filled(overriding.last_ones(found, scope), scope)
            rests += [] if any(rest.word == "default" for rest in rests) else [model.Rest("default", rules[0].span, written=False)]
        found = with_defaults(found, named_elements(left, found, self.broken, scope), scope)
        for rest in rests:
            found = self.rest(rest, found, scope)
        return found

    def rest(self, rule: model.Rest, explicit: tuple[typed.Rule, ...], scope: Scope) -> tuple[typed.Rule, ...]:
        """The rules, and what the fields that none of them reads, or sets, are said to be."""
        if rule.word == "ignore":
            return (*explicit, *rest_rules.ignored(rule, explicit, scope))
        explicit = rest_rules.elements_filled(explicit, scope)
        fields, elements = rest_rules.defaulted(rule, explicit, self.broken, scope)
        made = [made for each in fields for made in self.made(each, scope) if made is not None]
        return (*with_defaults(explicit, elements, scope), *made)

    def rules(self, rules: tuple[model.Rule, ...], scope: Scope) -> tuple[typed.Rule, ...]:
        for rule, behind in pairwise(rules):
            if isinstance(rule, model.Reject):
                scope.problems.append(words.rules_behind_reject(behind.span))
        made = [each for rule in rules for each in self.made(rule, scope)]
        found = tuple(rule for rule in made if rule is not None)
        same = [rule for rule in rules if isinstance(rule, model.SameNames)]
        scope.problems.extend(about_rest.repeated_same_names(rule.span) for rule in same[1:])
        return lengths_first(found if not same else (*found, *self.same_names(same[0], found, scope)))

    def same_names(self, rule: model.SameNames, explicit: tuple[typed.Rule, ...], scope: Scope) -> list[typed.Rule]:
        """Rules for the fields of the message that no other rule sets, and that the other side has too."""
        origin, aim = (scope.messages[side].root for side in (scope.origin, scope.target))
        names = {field.name for field in origin.fields}
        excepted = [resolve_path(path, scope, type_index) for path in rule.but]
        set_already = [field_names(place) for place in (*places_in(explicit), *excepted) if not isinstance(place, Broken)]
        around = len(field_names(scope.base(scope.target)))
        taken = {fields[around] for fields in (*set_already, *self.broken) if len(fields) > around}
        taken |= {step.name for each in rule.renames for step in each.place.steps[:1] if isinstance(step, expr.Member)}
        wanted = [field.name for field in aim.fields if field.name in names - taken and field.constant is None]
        if not wanted and not rule.renames:
            scope.problems.append(about_rest.no_same_names(rule.span, aim.name, origin.name))
        return [each for made in same_names.rules_of(rule, wanted, scope) for each in self.same_name(made, rule, scope)]

    def same_name(self, rule: model.Assignment, names: model.SameNames, scope: Scope) -> list[typed.Rule]:
        """The rules for one field; what is wrong with them is said once, of the field."""
        problems: list[Diagnostic] = []
        tried = replace(scope, problems=problems)
        rules = elementwise((rule,), tried, self.broken)
        found = [made for each in rules for made in self.made(each, tried)]
        if any(problem.code in same_names.OF_TYPES for problem in problems):
            problem = same_names.unlike(rule, names, scope)
            scope.problems.extend([] if problem is None else [problem])
            return []
        scope.problems.extend(problems)
        return [each for each in found if each is not None]

    def made(self, rule: model.Rule, scope: Scope) -> list[typed.Rule | None]:
        """The rules that one of the mapping stands for."""
        if isinstance(rule, model.Assign):
            by_mapping = isinstance(rule.by, model.Via) or scope.usable.by_type()
            if by_mapping and (found := nested.nest(rule, scope, self.whole)) is not None:
                return [*found]
            if (group := group_of(rule.value)) is not None:
                return self.group(rule, group, scope)
        if isinstance(rule, model.For) and rule.kept is not None:
            return self.filtered(rule, rule.kept, scope)
        found = self.rule(rule, scope)
        if not isinstance(found, typed.Default):
            return [found]
        try:
            return [*default_rules(found.place, scope.messages[scope.target], found.span)]
        except ManyDefaultsError:
            scope.problems.append(words.many_defaults(found.span, MAX_DEFAULTS))
            return [found]

    def rule(self, rule: model.Rule, scope: Scope) -> typed.Rule | None:
        if len(scope.problems) >= MAX_PROBLEMS:
            raise EnoughError
        match rule:
            case model.Assign():
                return self.assign(rule, scope)
            case model.SetLength():
                return self.set_length(rule, scope)
            case model.For():
                return self.loop(rule, scope)
            case model.When():
                return self.when(rule, scope)
            case model.Reject(text, span, pieces, written):
                return typed.Reject(text, span, texts.type_pieces(pieces, scope, type_expr), written=written)
            case model.Default() if is_of_elements(rule):
                scope.problems.append(about_rest.elements_in_block(rule.span))
                return None
            case model.Ignore(path) | model.Default(path):
                return self.left_alone(rule, path, scope)
            case model.SetState():
                return self.set_state(rule, scope)
            case model.SameNames():
                return None  # when all other rules of the block are known
            case model.Rest():
                scope.problems.append(about_rest.rest_in_block(rule.span, rule.word))
                return None
            case model.Relation() | model.Arranged() | model.Several():
                raise AssertionError(rule)
            case _:
                assert_never(rule)

    def left_alone(self, rule: model.Ignore[expr.Path] | model.Default[expr.Path], path: expr.Path, scope: Scope) -> typed.Rule | None:
        place = resolve_path(path, scope, type_index)
        if isinstance(place, Broken):
            self.broken.append(place.fields)
            return None
        if isinstance(rule, model.Ignore):
            return typed.Ignore(place, rule.span)
        if has_array(place.type, scope.messages[scope.target].schema, counted=True):
            scope.problems.append(about_rest.no_default(rule.span, describe(place.type)))
            self.broken.append(field_names(place))
            return None
        return typed.Default(place, rule.span)

    def when(self, rule: model.When[model.Rule, expr.Expr], scope: Scope) -> typed.Rule | None:
        condition = decisions.type_condition(rule.condition, scope, type_expr)
        then, otherwise = self.rules(rule.then, scope), self.rules(rule.otherwise, scope)
        if condition is None:
            self.broken.extend(field_names(place) for place in places_in((*then, *otherwise)))
            return None
        return typed.When(condition, then, otherwise, rule.span)

    def group(self, rule: model.Assignment, group: Group, scope: Scope) -> list[typed.Rule | None]:
        """The rules of a group: one for each of its numbers."""
        place = self.place(rule, scope)
        values = groups.type_group(rule.value, scope, type_expr, type_index)
        paths = None if place is None else groups.paths_of(rule.place, place.type, group, scope)
        if place is None or values is None or paths is None:
            self.broken.extend([] if place is None else [field_names(place)])
            return [None]
        lengths = [self.rule(each, scope) for each in groups.length_rules(rule, place.type, group, scope, type_index)]
        ends = [(self.place(replace(rule, place=path), scope), value) for path, value in zip(paths, values, strict=True)]
        return [*lengths, *(self.assigned(end, value, rule, scope) for end, value in ends if end is not None)]

    def assign(self, rule: model.Assignment, scope: Scope) -> typed.Rule | None:
        place = self.place(rule, scope)
        value = type_expr(rule.value, scope)
        return None if place is None else self.assigned(place, value, rule, scope)

    def assigned(self, place: typed.Place, value: typed.Expr | None, rule: model.Assignment, scope: Scope) -> typed.Rule | None:
        """The rule that sets a place to a value, which becomes of its type."""
        if value is not None:
            value = in_unit(value, place, scope, packs=rule.by == "checked")
        if value is not None and rule.by == "checked":
            value = coerced_values.fitted(value, place.type)
        elif value is not None:
            value = _rounded(value, place.type, scope)
        fitting = None if value is None else fit(value, place, scope)
        if fitting is None:
            self.broken.append(field_names(place))
            return None
        change = change_within(fitting, place, scope)
        made = _by_case(place, fitting, rule.span)
        return made if change is None or not isinstance(made, typed.Assign) else replace(made, by=change)

    def set_length(self, rule: model.SetLength[expr.Path, expr.Expr], scope: Scope) -> typed.Rule | None:
        place = self.place(rule, scope)
        value = type_integer(rule.value, scope, "a length")
        if place is None:
            return None
        if value is None or not _length_can_be(value, place, scope):
            self.broken.append(field_names(place))
            return None
        return typed.SetLength(place, value, rule.span)

    def set_state(self, rule: model.SetState[str, expr.Expr], scope: Scope) -> typed.Rule | None:
        variable = scope.state.get(rule.variable)
        value = type_expr(rule.value, scope)
        if variable is None:
            scope.problems.append(states.unknown(rule.span, rule.variable, scope.state))
        if variable is None or value is None:
            return None
        fitting = fit(_rounded(value, variable.type, scope), typed.Place(scope.target, (), variable.type), scope)
        return None if fitting is None else typed.SetState(variable, fitting, rule.span)

    def place(self, rule: model.Assignment | model.SetLength[expr.Path, expr.Expr], scope: Scope) -> typed.Place | None:
        place = resolve_path(rule.place, scope, type_index)
        if isinstance(place, Broken):
            self.broken.append(place.fields)
            return None
        return place

    def loop(self, rule: model.For[model.Rule, expr.Expr], scope: Scope) -> typed.Rule | None:
        if rule.variable in scope.locals:
            scope.problems.append(words.shadowed(rule.span, rule.variable))
        if rule.variable in scope.state:
            scope.problems.append(states.repeated(rule.span, rule.variable, "a state variable"))
        start = type_integer(rule.start, scope, "where a loop starts")
        stop = type_integer(rule.stop, scope, "where a loop ends")
        body = self.rules(rule.body, scope.inside(rule.variable, start))
        if start is None or stop is None:
            self.broken.extend(field_names(place) for place in places_in(body))
            return None
        if isinstance(start, typed.Const) and isinstance(stop, typed.Const) and int(stop.value) < int(start.value):
            scope.problems.append(words.loop_range(rule.stop.span, int(start.value), int(stop.value)))
            self.broken.extend(field_names(place) for place in places_in(body))
            return None
        return typed.For(rule.variable + scope.suffix, start, stop, body, rule.span)

    def filtered(self, rule: model.For[model.Rule, expr.Expr], kept: Kept[expr.Expr], scope: Scope) -> list[typed.Rule | None]:
        """A loop of which some rounds are kept, behind the lengths of the arrays that have an element for each of them."""
        inside = scope.inside(rule.variable, typed.Const(0, typed.INT64))
        stop = type_integer(rule.stop, scope, "where a loop ends")
        condition = decisions.type_condition(kept.condition, inside, type_expr)
        body = self.rules(rule.body, inside.inside(kept.variable))
        if stop is None or condition is None:
            self.broken.extend(field_names(place) for place in places_in(body))
            return [None]
        variable, counter = typed.Local(rule.variable + scope.suffix), kept.variable + scope.suffix
        count = typed.Reduce("count", variable, stop, condition, typed.INT64, span=rule.span)
        loop = typed.For(variable.name, typed.Const(0, typed.INT64), stop, body, rule.span, Kept(condition, counter, count))
        arrays = dict.fromkeys(array for place in places_in(body) if (array := _array_of(place, counter, scope)) is not None)
        return [*(typed.SetLength(array, count, rule.span) for array in arrays), loop]


def _array_of(place: typed.Place, counter: str, scope: Scope) -> typed.Place | None:
    """The array whose element of a counter's number a place is, or is in."""
    number = next((number for number, step in enumerate(place.steps) if step == typed.IndexStep(typed.Local(counter))), None)
    if number is None:
        return None
    message = scope.messages[place.side]
    type_: Type = message.root
    for step in place.steps[:number]:
        if isinstance(step, typed.FieldStep):
            type_ = message.value_type(step.field.type)
        elif isinstance(type_, Array | Bytes | Map):
            type_ = message.value_type(element_type(type_))
    return typed.Place(place.side, place.steps[:number], type_, place.span)


def _rounded(value: typed.Expr, target: Type, scope: Scope) -> typed.Expr:
    """A float64 as a float32 is set to it, where the mapping says that it is rounded."""
    if not scope.rounds or isinstance(value, typed.Const) or not (is_single(target) and same(value.type, FLOAT64)):
        return value
    scope.problems.extend([words.rounded_silently(value.span)] if scope.is_old else [])
    return typed.Convert(value, target, "nearest", value.span)


def _block(rules: tuple[model.Rule, ...] | None, scope: Scope) -> TypedRules | None:
    if rules is None:
        return None
    block = _Block()
    whole = block.whole(rules, scope)
    return TypedRules(whole, tuple(block.broken))


def _by_case(place: typed.Place, value: typed.Expr, span: Span | None) -> typed.Rule:
    """A choice among texts as one rule a text: numbers alone are chosen in an expression."""
    if not (isinstance(value, typed.Choice) and isinstance(place.type, String | Bytes)):
        return typed.Assign(place, value, span)
    rest: tuple[typed.Rule, ...] = (
        (typed.Reject(value.reason, span, value.pieces),) if value.otherwise is None else (_by_case(place, value.otherwise, span),)
    )
    for condition, chosen in reversed(value.cases):
        rest = (typed.When(condition, (_by_case(place, chosen, span),), rest, span),)
    return rest[0]


def _length_can_be(value: typed.Expr, place: typed.Place, scope: Scope) -> bool:
    match place.type:
        case Array(length=int(length)) if not (isinstance(value, typed.Const) and value.value == length):
            scope.problems.append(words.length_not_settable(place.span, describe(place.type)))
            return False
        case Array() | Bytes() | Map():
            return True
        case Bool() | Int() | Float() | Enum() as one:
            scope.problems.append(layouts.length_of_one(place.span, describe(one)))
            return False
        case other:
            scope.problems.append(words.length_not_settable(place.span, describe(other)))
            return False
