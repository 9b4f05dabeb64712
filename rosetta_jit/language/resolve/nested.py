"""Messages within messages that have a mapping of their own: its rules, at the place where the message lies.

``.pose = .pose via "pose.mapping"`` becomes the rules of that mapping for `.pose`; of arrays of messages, those of a loop. Without `via`, a
mapping that is imported is found by the two types. A mapping may be used in the direction that it has for them, whichever is its holder.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import layouts
from rosetta_jit.catalogue import nested as words
from rosetta_jit.language import typed
from rosetta_jit.language.conversions import describe
from rosetta_jit.language.limits import MAX_COPIED, MAX_USES, MAX_VIA_DEPTH
from rosetta_jit.language.resolve.expressions import type_index
from rosetta_jit.language.scope import Broken, Message, Scope, resolve_path
from rosetta_jit.language.uses import EnoughError, Use
from rosetta_jit.model import mapping as model
from rosetta_jit.model.expr import Path, Side
from rosetta_jit.model.mapping import Via
from rosetta_jit.model.types import Array, Optional, Struct, Type, same_name
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    RulesOf = Callable[[tuple[model.Rule, ...], Scope], tuple[typed.Rule, ...]]


def nest(rule: model.Assignment, scope: Scope, rules_of: RulesOf) -> tuple[typed.Rule, ...] | None:
    """The rules that an assignment of messages stands for; None if it is none that a mapping makes."""
    via = rule.by if isinstance(rule.by, Via) else None
    if not isinstance(rule.value, Path):
        if via is not None:
            scope.problems.append(words.not_a_field(rule.value.span))
        return None
    ends = _ends(rule, rule.value, scope if via is not None else replace(scope, problems=[]))
    if ends is None:
        return None
    place, origin = ends
    target, source = (_message(end, scope) for end in ends)
    if via is None and (target is None or source is None or target == source):
        return None
    if target is None or source is None:
        scope.problems.append(words.no_messages(rule.span, describe(origin.type), describe(place.type)))
        return _left_out(place, origin, rule.span)
    found = _imported(target, source, scope) if via is None else _named(via, target, source, scope)
    if found is None:
        return None if via is None else _left_out(place, origin, rule.span)
    usable = scope.usable
    usable.uses.append(Use(*found, place, origin, rule.span))
    return _used(usable.uses[-1], None if via is None else via.depth, scope, rules_of)


def _ends(rule: model.Assignment, value: Path, scope: Scope) -> tuple[typed.Place, typed.Place] | None:
    """Both places; without `via`, what does not resolve is reported by whoever assigns it."""
    place, origin = resolve_path(rule.place, scope, type_index), resolve_path(value, scope, type_index)
    return None if isinstance(place, Broken) or isinstance(origin, Broken) else (place, origin)


def _message(place: typed.Place, scope: Scope) -> Struct | None:
    """The message at a place, or that of each element."""
    type_ = place.type.element if isinstance(place.type, Array) else place.type
    found = _value_type(type_, place, scope)
    return found if isinstance(found, Struct) else None


def _value_type(type_: Type, place: typed.Place, scope: Scope) -> Type:
    return scope.messages[place.side].value_type(type_)


def _imported(target: Struct, source: Struct, scope: Scope) -> tuple[model.Mapping, Side] | None:
    """The mapping that is imported for two types, and which of its sides is the target."""
    for each in scope.usable.by_type():
        side = _side(each, target, source)
        if side is not None:
            return each, side
    return None


def _named(via: Via, target: Struct, source: Struct, scope: Scope) -> tuple[model.Mapping, Side] | None:
    """The mapping of a `via`, and which of its sides is the target."""
    other = scope.usable.named(via)
    if other is None:
        return None
    side = _side(other, target, source)
    if side is None:
        names = other.holder_type, other.wire_type
        scope.problems.append(words.other_types(via.span, via.mapping, names, (source.name, target.name)))
    return None if side is None else (other, side)


def _side(mapping: model.Mapping, target: Struct, source: Struct) -> Side | None:
    """Which side of a mapping the target is; where both have one name, as a type of ROS 1 and of ROS 2, that which is written like it."""
    sides: tuple[tuple[Side, bool, str, str], ...] = (
        ("holder", bool(mapping.unpack_rules), mapping.holder_type, mapping.wire_type),
        ("wire", bool(mapping.pack_rules), mapping.wire_type, mapping.holder_type),
    )
    fitting = [each for each in sides if each[1] and same_name(each[2], target.name) and same_name(each[3], source.name)]
    fitting.sort(key=lambda each: each[2] != target.name)
    return fitting[0][0] if fitting else None


def _left_out(place: typed.Place, origin: typed.Place, span: Span | None) -> tuple[typed.Rule, ...]:
    """Rules that say nothing of two places, so that nothing more is reported of them."""
    return (typed.Default(place, span), typed.Ignore(origin, span))


def _used(use: Use, most: int | None, scope: Scope, rules_of: RulesOf) -> tuple[typed.Rule, ...]:
    """The rules of a mapping where it is used; ``most`` is how often it may be within itself, where that is said."""
    name, span, usable = use.mapping.source.name, use.span, scope.usable
    depth = usable.using.count(name)
    if depth and (most is None or most > MAX_VIA_DEPTH):
        scope.problems.append(words.no_depth(span, name, MAX_VIA_DEPTH))
    elif len(usable.uses) > MAX_USES:
        scope.problems.append(words.many_uses(span, MAX_USES))
        raise EnoughError
    elif usable.copied() > MAX_COPIED:
        scope.problems.append(words.many_copies(span, MAX_COPIED))
        raise EnoughError
    elif most is not None and depth > most:
        return _too_deep(most, use.place, use.origin, span)
    else:
        inner = replace(scope, usable=replace(usable, using=(*usable.using, name)), suffix=f"~{len(usable.uses)}")
        return _at(use, inner, rules_of)
    return _left_out(use.place, use.origin, span)


def _too_deep(most: int, place: typed.Place, origin: typed.Place, span: Span | None) -> tuple[typed.Rule, ...]:
    """What is there beyond the depth is refused."""
    if isinstance(origin.type, Array):
        there: typed.Binary | typed.Has = typed.Binary("!=", typed.LenOf(origin), typed.Const(0, typed.INT64), typed.BOOL)
    else:
        there = typed.Has(origin)
    return (typed.When(there, (typed.Reject(words.too_deep(most), span),), (), span), *_left_out(place, origin, span))


def _at(use: Use, scope: Scope, rules_of: RulesOf) -> tuple[typed.Rule, ...]:
    """The rules of a mapping for two messages, or for each of their elements."""
    place, origin, span = use.place, use.origin, use.span
    if not isinstance(place.type, Array) or not isinstance(origin.type, Array):
        rules = _inside(use.mapping, use.side, place, origin, scope, rules_of)
        return (typed.When(typed.Has(origin), rules, (), span),) if _may_lack(place, scope) and _may_lack(origin, scope) else rules
    number = typed.Local(f"each message{scope.suffix}")  # a blank: no loop of the mapping is called so
    element, source = (_element(end, number, scope) for end in (place, origin))
    rules = _inside(use.mapping, use.side, element, source, scope, rules_of)
    fixed, found = place.type.fixed, typed.LenOf(origin)
    count: typed.Expr = found if fixed is None else typed.Const(fixed, typed.INT64)
    length, loop = typed.SetLength(place, count, span), typed.For(number.name, typed.Const(0, typed.INT64), count, rules, span)
    if fixed is None or origin.type.fixed is not None:
        return (length, loop)
    differs = typed.Binary("!=", found, count, typed.BOOL)
    return (typed.When(differs, (typed.Reject(layouts.OTHER_COUNT, span),), (), span), length, loop)


def _element(place: typed.Place, number: typed.Local, scope: Scope) -> typed.Place:
    assert isinstance(place.type, Array)
    return typed.Place(place.side, (*place.steps, typed.IndexStep(number)), _value_type(place.type.element, place, scope), place.span)


def _may_lack(place: typed.Place, scope: Scope) -> bool:
    """Whether a message can be absent."""
    last = place.steps[-1]
    if isinstance(last, typed.IndexStep) or last.field.required:
        return False
    return isinstance(scope.messages[place.side].schema.resolve(last.field.type), Optional)


def _inside(
    mapping: model.Mapping, side: Side, place: typed.Place, origin: typed.Place, scope: Scope, rules_of: RulesOf
) -> tuple[typed.Rule, ...]:
    """The rules of a mapping whose two messages lie at these places."""
    other: Side = "wire" if side == "holder" else "holder"
    schema = scope.messages[place.side].schema
    target, source = place.type, origin.type
    assert isinstance(target, Struct)
    assert isinstance(source, Struct)
    messages: dict[Side, Message] = {side: Message(target, schema), other: Message(source, schema)}
    inner = replace(
        scope,
        messages=messages,
        bases={side: place, other: origin},
        target=side,
        locals=(),
        rounds=mapping.rounds,
        is_old=mapping.is_old,
        state={},
    )
    return rules_of((mapping.unpack_rules if side == "holder" else mapping.pack_rules) or (), inner)
