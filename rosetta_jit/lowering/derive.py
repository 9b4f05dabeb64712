"""Rules for both directions as rules for each.

`.a <-> f(.b)` unpacks as `.a = f(.b)`, and packs as `lowering.packing` says. Behind them stand the rules of the direction's own block.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.lowering.packing import Packing
from rosetta_jit.model.expr import Len, Path
from rosetta_jit.model.mapping import Arranged, Assign, For, Relation, SetLength, When

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.model.mapping import Mapping, Rule


def derive(mapping: Mapping, problems: list[Diagnostic]) -> Mapping:
    """The mapping with each direction's rules complete, those of its own block behind those for both."""
    if mapping.rules is None:
        return mapping
    packing = Packing.of(mapping.pack_rules or (), problems)
    return replace(
        mapping,
        unpack_rules=(*_unpacking(mapping.rules), *(mapping.unpack_rules or ())),
        pack_rules=(*packing.block(mapping.rules, ()), *(mapping.pack_rules or ())),
    )


def _unpacking(rules: tuple[Rule, ...]) -> tuple[Rule, ...]:
    return tuple(map(_unpacked, rules))


def _unpacked(rule: Rule) -> Rule:
    match rule:
        case Relation(Len(place), value, span):
            return SetLength(place, value, span)
        case Relation(Path() as place, value, span, via):
            return Assign(place, value, span, via=via)
        case For(body=body):
            return replace(rule, body=_unpacking(body))
        case When(then=then, otherwise=otherwise):
            return replace(rule, then=_unpacking(then), otherwise=_unpacking(otherwise))
        case Arranged(cases=cases):
            return replace(rule, cases=cases[:1])
        case _:
            return rule
