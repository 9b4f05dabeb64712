"""The normal form of typed rules: loops numbered by depth, texts compared like numbers, bits of integers as their digits."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.language import typed
from rosetta_jit.language.algebra.typed_bits import digits
from rosetta_jit.language.walk import placed, rebuilt, renamed
from rosetta_jit.model.rules import Kept
from rosetta_jit.model.types import Bytes, String
from rosetta_jit.startup.dataclass import replace


def normal(rules: tuple[typed.Rule, ...], names: dict[str, typed.Expr] | None = None) -> tuple[typed.Rule, ...]:
    """Rules that do the same are the same: loop variables are called `$0`, `$1`, and so on, by depth."""
    return tuple(_normal(rule, names or {}) for rule in rules)


def _normal(rule: typed.Rule, names: dict[str, typed.Expr]) -> typed.Rule:
    def change(expr: typed.Expr) -> typed.Expr:
        return renamed(_plain(expr), names)

    match rule:
        case typed.Assign(place, value) | typed.SetLength(place, value):
            return replace(rule, place=placed(place, change), value=change(value))
        case typed.Default(place) | typed.Ignore(place):
            return replace(rule, place=placed(place, change))
        case typed.For(variable, start, stop, body):
            number = typed.Local(f"${len(names)}")
            if rule.kept is not None:
                return _kept(rule, rule.kept, names, change)
            inner = normal(body, {**names, variable: number})
            return replace(rule, variable=number.name, start=change(start), stop=change(stop), body=inner)
        case typed.When():
            table = _table(rule)
            if table is not None:
                return _normal(table, names)
            return replace(rule, condition=change(rule.condition), then=normal(rule.then, names), otherwise=normal(rule.otherwise, names))
        case _:
            return rule


def _kept(
    rule: typed.For[typed.Rule, typed.Expr],
    kept: Kept[typed.Expr],
    names: dict[str, typed.Expr],
    change: Callable[[typed.Expr], typed.Expr],
) -> typed.Rule:
    """A loop of which some rounds are kept: what counts these is known by depth, as the variable of a loop over them would be."""
    counter, number = typed.Local(f"${len(names)}"), typed.Local(f"${len(names) + 1}")
    inner = {**names, rule.variable: number}
    condition = renamed(_plain(kept.condition), inner)
    count = None if kept.count is None else change(kept.count)
    body = normal(rule.body, {**names, kept.variable: counter, rule.variable: number})
    found = Kept(condition, counter.name, count)
    return replace(rule, variable=number.name, start=change(rule.start), stop=change(rule.stop), body=body, kept=found)


def _plain(expr: typed.Expr) -> typed.Expr:
    """A text compared with a constant, as numbers are."""
    if isinstance(expr, typed.IsText):
        place = placed(expr.place, _plain)
        return typed.Binary("==", typed.Access(place, place.type), typed.Const(expr.text, String()), typed.BOOL, expr.span)
    return digits(rebuilt(expr, _plain))


def _is_key(condition: typed.Expr) -> bool:
    return isinstance(condition, typed.IsText) or (
        isinstance(condition, typed.Binary) and condition.operator == "==" and isinstance(condition.right, typed.Const)
    )


def _table(rule: typed.When[typed.Rule, typed.Expr]) -> typed.Assignment | None:
    """A choice among texts that was made rules, as a choice again."""
    cases: list[tuple[typed.Expr, typed.Expr]] = []
    place: typed.Place | None = None
    rest: tuple[typed.Rule, ...] = (rule,)
    while True:
        match rest:
            case (typed.When(condition, (typed.Assign(found, typed.Const(str()) as text),), otherwise),) if isinstance(
                found.type, String | Bytes
            ):
                if place not in (None, found) or not otherwise or not _is_key(condition):
                    return None
                place = found
                cases.append((condition, text))
                rest = otherwise
            case (typed.Assign(found, typed.Const(str()) as text),) if place == found:
                return typed.Assign(found, typed.Choice(tuple(cases), text, "", found.type, rule.span), rule.span)
            case _:
                break
    rejects = len(rest) == 1 and isinstance(rest[0], typed.Reject)
    return (
        typed.Assign(place, typed.Choice(tuple(cases), None, "", place.type, rule.span), rule.span)
        if place is not None and rejects
        else None
    )
