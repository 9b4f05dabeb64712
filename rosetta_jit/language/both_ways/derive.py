"""Rules for both directions as rules for each.

`.a <-> f(.b)` unpacks as `.a = f(.b)`, and packs as `language.both_ways.packing` says. Behind them stand the rules of the direction's own
block.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import derive as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.both_ways.bit_sums import with_sums
from rosetta_jit.language.both_ways.bits import Bits
from rosetta_jit.language.both_ways.checks import checks_of
from rosetta_jit.language.both_ways.demanded_values import demanded, known_to_pack
from rosetta_jit.language.both_ways.inverse import condition_in
from rosetta_jit.language.both_ways.knowledge import Beside
from rosetta_jit.language.both_ways.packing import Packing
from rosetta_jit.language.both_ways.presence import with_flags
from rosetta_jit.language.groups import component
from rosetta_jit.language.limits import MAX_CONDITIONS
from rosetta_jit.model import mapping as model
from rosetta_jit.model.expr import Expr, Len, List, Path
from rosetta_jit.model.mapping import Arranged, Assign, For, Relation, Rule, SameNames, SetLength, Via, When
from rosetta_jit.model.walk import every_rule
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.bits import ConstantOf
    from rosetta_jit.language.both_ways.inverse import TypeOf


def derive(mapping: model.Mapping, type_of: TypeOf, constant_of: ConstantOf, problems: list[Diagnostic], depth: int = 0) -> model.Mapping:
    """The mapping with each direction's rules complete, those of its own block behind those for both.

    ``depth`` is how many conditions of its relations have become blocks.
    """
    if mapping.rules is None:
        return mapping
    found: list[Diagnostic] = []
    wanted = demanded(mapping.rules, mapping.pack_rules or (), type_of)
    own = (*(mapping.pack_rules or ()), *wanted)
    packing, bits = Packing.of(own, type_of, found), Bits(type_of, constant_of, {})
    rules = bits.rules(with_sums(mapping.rules, packing.is_completed, constant_of))
    pack_rules = packing.block(with_flags(rules, packing.is_completed), ())
    conditional = _conditional(rules, packing)
    if conditional and depth < MAX_CONDITIONS:
        split = tuple(_by_blocks(rule, conditional) for rule in mapping.rules)
        return derive(replace(mapping, rules=split), type_of, constant_of, problems, depth + 1)
    own = (*(mapping.pack_rules or ()), *known_to_pack(wanted, packing.known))
    problems.extend((*found, *(words.too_many_blocks(span, MAX_CONDITIONS) for span in conditional)))
    return replace(
        mapping,
        unpack_rules=(
            *_unpacking(rules, {**packing.known.beside, **packing.known.unpacked}, bits.written),
            *(mapping.unpack_rules or ()),
        ),
        pack_rules=(*pack_rules, *own),
    )


def _conditional(rules: tuple[Rule, ...], packing: Packing) -> frozenset[Span | None]:
    """The relations that choose among fields which are parts of one value: unpacking checks such fields block by block."""
    written = {id(rule) for rule in every_rule(rules) if isinstance(rule, Relation)}  # others are made of these
    checked = (each for each in packing.known.beside.values() if each.side == "wire" and each.digits)
    return frozenset(each.rule.span for each in checked if id(each.rule) not in written)


def _by_blocks(rule: Rule, conditional: frozenset[Span | None]) -> Rule:
    """A rule with a `when` in place of relations that choose among several fields, each of which unpacking then checks."""
    match rule:
        case Relation(value=value, span=span) if span in conditional and (ways := condition_in(value)) is not None:
            then, other = (replace(rule, value=way) for way in ways[1:])
            return When(ways[0], (then,), (other,), span)
        case For(body=body):
            return replace(rule, body=tuple(_by_blocks(each, conditional) for each in body))
        case When(then=then, otherwise=otherwise):
            first, second = (tuple(_by_blocks(each, conditional) for each in block) for block in (then, otherwise))
            return replace(rule, then=first, otherwise=second)
        case _:
            return rule


def _set(place: Path | Len | List, value: Expr, span: Span | None, via: Via | None) -> tuple[Rule, ...]:
    match place:
        case Len(path):
            return (SetLength(path, value, span),)
        case List(items):
            return tuple(Assign(each, component(value, number), span) for number, each in enumerate(items) if isinstance(each, Path))
        case Path():
            return (Assign(place, value, span, via),)


def _unpacking(rules: tuple[Rule, ...], checked: Mapping[int, Beside], written: Mapping[int, Expr]) -> tuple[Rule, ...]:
    return tuple(made for rule in rules for made in _unpacked(rule, checked, written))


def _unpacked(rule: Rule, checked: Mapping[int, Beside], written: Mapping[int, Expr]) -> tuple[Rule, ...]:
    """The rules of a relation, and of what it needs to be the only one that packs so."""
    match rule:
        case Relation(place, value, span, via):
            beside = checked.get(id(rule))
            checks = () if beside is None or beside.side == "holder" else checks_of(beside)
            return (*checks, *_set(place, written.get(id(rule), value), span, via))
        case For(body=body):
            return (replace(rule, body=_unpacking(body, checked, written)),)
        case When(then=then, otherwise=otherwise):
            return (replace(rule, then=_unpacking(then, checked, written), otherwise=_unpacking(otherwise, checked, written)),)
        case SameNames():
            return (replace(rule, both=True),)
        case Arranged(cases=cases):
            return (replace(rule, cases=cases[:1]),)
        case _:
            return (rule,)
