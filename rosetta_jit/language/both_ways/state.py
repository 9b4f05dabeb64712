"""State among the rules for both directions: each direction has its own, so that no relation can hold between them.

What may read it is the condition of a `reject`, and its text: such a check is no relation.
"""

from __future__ import annotations

from operator import is_

from rosetta_jit.catalogue import state as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.model.expr import Name
from rosetta_jit.model.mapping import For, Reject, Rule, SetState, When
from rosetta_jit.model.walk import expressions_of, parts
from rosetta_jit.startup.dataclass import replace


def without_state(rules: tuple[Rule, ...], names: frozenset[str], problems: list[Diagnostic]) -> tuple[Rule, ...]:
    """The rules without those that set state; these, and those that read one of the ``names``, are reported."""
    found: list[Rule] = []
    for rule in rules:
        match rule:
            case SetState(name, _, span):
                problems.append(words.set_for_both(span, name))
            case When(_, (Reject(),), ()) | Reject():
                found.append(rule)
            case _:
                named = (part for expr in expressions_of(rule) for part in parts(expr) if isinstance(part, Name))
                problems.extend(words.in_relation(part.span, part.name) for part in named if part.name in names)
                found.append(_within(rule, names, problems))
    return rules if len(found) == len(rules) and all(map(is_, found, rules)) else tuple(found)


def _within(rule: Rule, names: frozenset[str], problems: list[Diagnostic]) -> Rule:
    """A rule with its blocks looked through; the same one where nothing is to be changed."""
    match rule:
        case For(body=body):
            inside = without_state(body, names, problems)
            return rule if inside is body else replace(rule, body=inside)
        case When(then=then, otherwise=otherwise):
            blocks = [without_state(block, names, problems) for block in (then, otherwise)]
            return rule if blocks[0] is then and blocks[1] is otherwise else replace(rule, then=blocks[0], otherwise=blocks[1])
        case _:
            return rule
