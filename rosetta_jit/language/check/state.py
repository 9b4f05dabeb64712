"""Whether rules set and read state as they may: once a message on every way through them, and not in vain."""

from __future__ import annotations

from rosetta_jit.catalogue import check
from rosetta_jit.catalogue import state as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.typed import For, Rule, SetState, When
from rosetta_jit.model import mapping as model
from rosetta_jit.model.expr import Name
from rosetta_jit.model.walk import every_rule, expressions_of, parts
from rosetta_jit.source import Span

Set = dict[str, "Span | None"]
"""The variables that rules have set, each with the rule."""


def set_again(rules: tuple[Rule, ...]) -> list[Diagnostic]:
    """Rules of one direction that set a variable a second time for one message."""
    problems: list[Diagnostic] = []
    _set_in(rules, {}, None, problems)
    return problems


def _set_in(rules: tuple[Rule, ...], before: Set, loop: str | None, problems: list[Diagnostic]) -> Set:
    """What is set behind some rules, given what is set before them, and the innermost loop around them."""
    found = dict(before)
    for rule in rules:
        match rule:
            case SetState(variable, _, span):
                if loop is not None:
                    problems.append(words.set_in_loop(span, variable.name, loop))
                elif variable.name in found:
                    problems.append(check.set_twice(span, f"state {variable.name}", found[variable.name]))
                found.setdefault(variable.name, span)
            case For(variable, _, _, body):
                found = _set_in(body, found, variable, problems)
            case When(_, then, otherwise):
                found = _set_in(then, found, loop, problems) | _set_in(otherwise, found, loop, problems)
            case _:
                pass
    return found


def idle(mapping: model.Mapping) -> list[Diagnostic]:
    """Warnings about variables that no rule of either direction sets, or reads for anything but to set them again."""
    if not mapping.state:
        return []
    every = [*every_rule(mapping.unpack_rules or ()), *every_rule(mapping.pack_rules or ())]
    changed = {rule.variable for rule in every if isinstance(rule, model.SetState)}
    read = {name for rule in every for name in _names(rule) if not (isinstance(rule, model.SetState) and rule.variable == name)}
    return [
        *(words.never_read(each.span, each.name) for each in mapping.state if each.name not in read),
        *(words.never_set(each.span, each.name) for each in mapping.state if each.name in read - changed),
    ]


def _names(rule: model.Rule) -> set[str]:
    """What the expressions of a rule name."""
    return {part.name for expr in expressions_of(rule) for part in parts(expr) if isinstance(part, Name)}
