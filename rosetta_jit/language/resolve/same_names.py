"""The rules that `same names` stands for, one for each field.

In `rules:` a number becomes a narrower one of its kind, where the other direction widens it: of an integer, what does not fit is refused; a
float is rounded, and the law says so. All else that takes a word is reported with the rule to write.
"""

from __future__ import annotations

from rosetta_jit.catalogue import resolve as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.conversions import describe, same, widens, word_for
from rosetta_jit.language.resolve.expressions import type_index
from rosetta_jit.language.scope import Broken, Scope, resolve_path
from rosetta_jit.model.expr import Member, Path
from rosetta_jit.model.mapping import Assign, Assignment, SameNames
from rosetta_jit.model.printer import show_expr
from rosetta_jit.model.types import Array, Float, Int, Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace

OF_TYPES = frozenset(("lossy-conversion", "type-clash"))
"""Mistakes that a field's name alone makes."""


def rules_of(rule: SameNames, names: list[str], scope: Scope) -> list[Assignment]:
    """The rules for the fields that are renamed, and for those of ``names``, which both messages have."""
    renamed = [_rule(each.place, each.value, each.span, rule, scope) for each in rule.renames]
    own = [[Path(side, (Member(name, rule.span),), rule.span) for side in (scope.target, scope.origin)] for name in names]
    return [*renamed, *(_rule(here, there, rule.span, rule, scope) for here, there in own)]


def _rule(here: Path, there: Path, span: Span | None, rule: SameNames, scope: Scope) -> Assignment:
    source, target = (_number(path, scope) for path in (there, here))
    is_narrower = isinstance(source, Int | Float) and isinstance(target, type(source)) and widens(target, source)
    packs = scope.target == "wire" and isinstance(source, Int) and source == target  # perhaps in other units, as by `<->`
    return Assign(here, there, span, by="checked" if rule.both and (is_narrower or packs) else None)


def unlike(rule: Assignment, names: SameNames, scope: Scope) -> Diagnostic | None:
    """What is wrong with fields whose names alone do not map them, and the rule to write; nothing where unpacking said so."""
    assert isinstance(rule.value, Path)
    types = [_type(path, scope) for path in (rule.value, rule.place)]
    source, target = (_number(path, scope) for path in (rule.value, rule.place))
    each = "[]" if isinstance(types[0], Array) and source is not None and target is not None and not same(source, target) else ""
    unpacks, arrow = scope.target == "holder", "<->" if names.both else "="
    value, place = (f"{show_expr(path)}{each}" for path in (rule.value, rule.place))
    line = ""
    if names.both and not unpacks:
        if source is None or target is None or not widens(target, source):
            return None
        line = f"{value} <-> {place}"
    elif source is not None and target is not None:
        word = word_for(source, target).partition("(")[0].lstrip("`")
        line = f"{place} {arrow} {word}({value})" if word else ""
    wire, holder = (describe(each) if each is not None else "nothing" for each in (types if unpacks else reversed(types)))
    return words.unlike_names(rule.span, show_expr(rule.place), wire, holder, line)


def _type(path: Path, scope: Scope) -> Type | None:
    """The type of a field; None where there is none, which the rule for it reports."""
    place = resolve_path(path, replace(scope, problems=[]), type_index)
    return None if isinstance(place, Broken) else scope.messages[path.side].value_type(place.type)


def _number(path: Path, scope: Scope) -> Type | None:
    """The type of a field, or of the elements of one that is an array."""
    found = _type(path, scope)
    return scope.messages[path.side].value_type(found.element) if isinstance(found, Array) else found
