"""Rules for both directions as rules for each.

`.a <-> f(.b)` unpacks as `.a = f(.b)`, and packs as `lowering.packing` says. Behind them stand the rules of the direction's own block.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import derive as words
from rosetta_jit.lowering.packing import Packing, checks_of
from rosetta_jit.model.expr import Len
from rosetta_jit.model.mapping import Arranged, Assign, For, Relation, SetLength, When

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.lowering.knowledge import Beside
    from rosetta_jit.model import mapping as model
    from rosetta_jit.model.mapping import Rule


def derive(mapping: model.Mapping, problems: list[Diagnostic]) -> model.Mapping:
    """The mapping with each direction's rules complete, those of its own block behind those for both."""
    if mapping.rules is None:
        return mapping
    packing = Packing.of(mapping.pack_rules or (), problems)
    pack_rules = packing.block(mapping.rules, ())
    written = set(_relations(mapping.rules))
    checked = (each for each in packing.known.beside.values() if each.side == "wire" and each.digits)
    problems.extend(words.conditional_parts(each.rule.span) for each in checked if id(each.rule) not in written)
    return replace(
        mapping,
        unpack_rules=(*_unpacking(mapping.rules, packing.known.beside), *(mapping.unpack_rules or ())),
        pack_rules=(*pack_rules, *(mapping.pack_rules or ())),
    )


def _relations(rules: tuple[Rule, ...]) -> Iterator[int]:
    """The relations that the mapping writes down; others were made of these."""
    for rule in rules:
        match rule:
            case Relation():
                yield id(rule)
            case For(body=body):
                yield from _relations(body)
            case When(then=then, otherwise=otherwise):
                yield from _relations((*then, *otherwise))
            case _:
                pass


def _unpacking(rules: tuple[Rule, ...], checked: Mapping[int, Beside]) -> tuple[Rule, ...]:
    return tuple(made for rule in rules for made in _unpacked(rule, checked))


def _unpacked(rule: Rule, checked: Mapping[int, Beside]) -> tuple[Rule, ...]:
    """The rules of a relation, and of what it needs to be the only one that packs so."""
    match rule:
        case Relation(place, value, span, via):
            beside = checked.get(id(rule))
            checks = () if beside is None or beside.side == "holder" else checks_of(beside)
            set_to = SetLength(place.path, value, span) if isinstance(place, Len) else Assign(place, value, span, via=via)
            return (*checks, set_to)
        case For(body=body):
            return (replace(rule, body=_unpacking(body, checked)),)
        case When(then=then, otherwise=otherwise):
            return (replace(rule, then=_unpacking(then, checked), otherwise=_unpacking(otherwise, checked)),)
        case Arranged(cases=cases):
            return (replace(rule, cases=cases[:1]),)
        case _:
            return (rule,)
