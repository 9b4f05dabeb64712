"""The normal form of typed rules: loops numbered by depth, texts compared like numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.language.typed import (
    BOOL,
    Access,
    Assign,
    Binary,
    Choice,
    Const,
    Default,
    For,
    Ignore,
    IsText,
    Local,
    Reject,
    SetLength,
    When,
)
from rosetta_jit.language.walk import placed, rebuilt, renamed
from rosetta_jit.model.rules import Kept
from rosetta_jit.model.types import Bytes, String

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.language.typed import Assignment, Expr, Place, Rule


def normal(rules: tuple[Rule, ...], names: dict[str, Expr] | None = None) -> tuple[Rule, ...]:
    """Rules that do the same are the same: loop variables are called `$0`, `$1`, and so on, by depth."""
    return tuple(_normal(rule, names or {}) for rule in rules)


def _normal(rule: Rule, names: dict[str, Expr]) -> Rule:
    def change(expr: Expr) -> Expr:
        return renamed(_plain(expr), names)

    match rule:
        case Assign(place, value) | SetLength(place, value):
            return replace(rule, place=placed(place, change), value=change(value))
        case Default(place) | Ignore(place):
            return replace(rule, place=placed(place, change))
        case For(variable, start, stop, body):
            number = Local(f"${len(names)}")
            if rule.kept is not None:
                return _kept(rule, rule.kept, names, change)
            inner = normal(body, {**names, variable: number})
            return replace(rule, variable=number.name, start=change(start), stop=change(stop), body=inner)
        case When():
            table = _table(rule)
            if table is not None:
                return _normal(table, names)
            return replace(rule, condition=change(rule.condition), then=normal(rule.then, names), otherwise=normal(rule.otherwise, names))
        case _:
            return rule


def _kept(rule: For[Rule, Expr], kept: Kept[Expr], names: dict[str, Expr], change: Callable[[Expr], Expr]) -> Rule:
    """A loop of which some rounds are kept: what counts these is known by depth, as the variable of a loop over them would be."""
    counter, number = Local(f"${len(names)}"), Local(f"${len(names) + 1}")
    inner = {**names, rule.variable: number}
    condition = renamed(_plain(kept.condition), inner)
    count = None if kept.count is None else change(kept.count)
    body = normal(rule.body, {**names, kept.variable: counter, rule.variable: number})
    found = Kept(condition, counter.name, count)
    return replace(rule, variable=number.name, start=change(rule.start), stop=change(rule.stop), body=body, kept=found)


def _plain(expr: Expr) -> Expr:
    """A text compared with a constant, as numbers are."""
    if isinstance(expr, IsText):
        place = placed(expr.place, _plain)
        return Binary("==", Access(place, place.type), Const(expr.text, String()), BOOL, expr.span)
    return rebuilt(expr, _plain)


def _is_key(condition: Expr) -> bool:
    return isinstance(condition, IsText) or (
        isinstance(condition, Binary) and condition.operator == "==" and isinstance(condition.right, Const)
    )


def _table(rule: When[Rule, Expr]) -> Assignment | None:
    """A choice among texts that was made rules, as a choice again."""
    cases: list[tuple[Expr, Expr]] = []
    place: Place | None = None
    rest: tuple[Rule, ...] = (rule,)
    while True:
        match rest:
            case (When(condition, (Assign(found, Const(str()) as text),), otherwise),) if isinstance(found.type, String | Bytes):
                if place not in (None, found) or not otherwise or not _is_key(condition):
                    return None
                place = found
                cases.append((condition, text))
                rest = otherwise
            case (Assign(found, Const(str()) as text),) if place == found:
                return Assign(found, Choice(tuple(cases), text, "", found.type, rule.span), rule.span)
            case _:
                break
    rejects = len(rest) == 1 and isinstance(rest[0], Reject)
    return Assign(place, Choice(tuple(cases), None, "", place.type, rule.span), rule.span) if place is not None and rejects else None
