"""The rules that `same names` stands for, one for each field.

In `rules:` an integer becomes a narrower one, where the other direction widens it, and what does not fit is refused: no value changes. All
else that takes a word is reported with the rule to write.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import resolve as words
from rosetta_jit.language.conversions import describe, same, widens, word_for
from rosetta_jit.model.expr import Member, Path
from rosetta_jit.model.mapping import Assign
from rosetta_jit.model.types import Array, Int

OF_TYPES = frozenset(("lossy-conversion", "type-clash"))
"""Mistakes that a field's name alone makes."""

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.language.scope import Message, Scope
    from rosetta_jit.model.mapping import Assignment, SameNames
    from rosetta_jit.model.types import Type


def rule_for(name: str, rule: SameNames, scope: Scope) -> Assignment:
    """The rule for a field that both messages have."""
    there, here = (Path(side, (Member(name, rule.span),), rule.span) for side in (scope.origin, scope.target))
    source, target = (_number(scope.messages[side], name) for side in (scope.origin, scope.target))
    fits = rule.both and isinstance(source, Int) and isinstance(target, Int) and widens(target, source)
    return Assign(here, there, rule.span, by="checked" if fits else None)


def unlike(name: str, rule: SameNames, scope: Scope) -> Diagnostic | None:
    """What is wrong with a field that its name alone does not map, and the rule to write for it; nothing where unpacking said so."""
    types = [_type(scope.messages[side], name) for side in (scope.origin, scope.target)]
    source, target = (_number(scope.messages[side], name) for side in (scope.origin, scope.target))
    each = "[]" if isinstance(types[0], Array) and not same(source, target) else ""
    unpacks, arrow = scope.target == "holder", "<->" if rule.both else "="
    value = f".{name}{each}"
    if rule.both and not unpacks:
        if not widens(target, source):
            return None
        line = f"{value} <-> {value}"
    else:
        word = word_for(source, target).partition("(")[0].lstrip("`")
        line = f"{value} {arrow} {word}({value})" if word else ""
    wire, holder = map(describe, types if unpacks else reversed(types))
    return words.unlike_names(rule.span, f".{name}", wire, holder, line)


def _type(message: Message, name: str) -> Type:
    return message.value_type(next(field.type for field in message.root.fields if field.name == name))


def _number(message: Message, name: str) -> Type:
    """The type of a field, or of the elements of one that is an array."""
    found = _type(message, name)
    return message.value_type(found.element) if isinstance(found, Array) else found
