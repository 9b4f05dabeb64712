"""Constants that rejections of a mapping for both directions ask for: `reject "why" when .id != 0x201` packs `.id = 0x201`.

What unpacking lets through has one value in such a field, so that packing writes it, where no other rule says what it is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.named_fields import is_among, set_by
from rosetta_jit.model.expr import Binary, Literal, Path, Unary
from rosetta_jit.model.mapping import Assign, Ignore, Reject, Relation, SameNames, When
from rosetta_jit.model.types import Bool, Float
from rosetta_jit.model.walk import every_rule, fields_of, names_of, parts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.language.both_ways.inverse import TypeOf
    from rosetta_jit.model.expr import Expr
    from rosetta_jit.model.mapping import Rule


def demanded(rules: tuple[Rule, ...], pack_rules: tuple[Rule, ...], type_of: TypeOf) -> tuple[Rule, ...]:
    """The rules to pack which set the fields that a message has with one value alone, and that nothing else sets."""
    relations = [rule for rule in every_rule(rules) if isinstance(rule, Relation)]
    known = {names_of(place) for rule in relations for place in fields_of(rule.value, "wire") if isinstance(place, Path)}
    known |= {names_of(rule.place) for rule in every_rule(rules) if isinstance(rule, Ignore)}
    known |= {*set_by(pack_rules, lengths=True)}
    by_name = any(isinstance(rule, SameNames) for rule in every_rule(rules))
    found: dict[Path, Rule] = {}
    for rule in rules:
        match rule:
            case When(condition, (Reject(),), ()):
                for place, value in _wanted(condition, type_of):
                    has_own = by_name and type_of(Path("holder", place.steps)) is not None
                    if not has_own and not is_among(place, frozenset(known)):
                        found.setdefault(place, Assign(place, value, rule.span))
            case _:
                pass
    return tuple(found.values())


def _wanted(condition: Expr, type_of: TypeOf) -> Iterator[tuple[Path, Expr]]:
    """The fields, each with the value that it has where a condition does not hold."""
    match condition:
        case Binary("or", left, right):
            yield from _wanted(left, type_of)
            yield from _wanted(right, type_of)
        case Binary("!=", Path() as place, value) | Binary("!=", value, Path() as place) if _is_single(place) and _is_constant(value):
            if not isinstance(type_of(place), Float):  # which may be -0 where it is compared with 0
                yield place, value
        case Path() as place if _is_single(place) and isinstance(type_of(place), Bool):
            yield place, Literal(False, place.span)
        case Unary("not", Path() as place) if _is_single(place) and isinstance(type_of(place), Bool):
            yield place, Literal(True, place.span)
        case _:
            pass


def _is_single(place: Path) -> bool:
    """Whether a field is of the wire and none of an array's elements."""
    return place.side == "wire" and len(names_of(place)) == len(place.steps)


def _is_constant(value: Expr) -> bool:
    return not any(isinstance(part, Path) for part in parts(value)) and not fields_of(value, "wire")
