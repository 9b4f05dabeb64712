"""Values that rejections demand: packing writes the one value that a `reject` lets through, where no other rule sets the field.

`reject "why" when .id != 0x201` packs `.id = 0x201`, `… when len(.values) != 3` packs `len(.values) = 3`, and `… when .check != crc(.data,
"CRC-16/X-25")` packs the checksum: what unpacking lets through has one value there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.named_fields import is_among, set_by
from rosetta_jit.model.expr import Binary, Expr, Index, Len, Literal, Path, Unary
from rosetta_jit.model.mapping import Assign, Assignment, Ignore, Reject, Relation, Rule, SameNames, SetLength, When
from rosetta_jit.model.types import Array, Bool, Float
from rosetta_jit.model.walk import Field, every_rule, fields_of, names_of, parts, path_of
from rosetta_jit.source import Span

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf
    from rosetta_jit.language.both_ways.knowledge import Knowledge

    Setting = Assignment | SetLength[Path, Expr]


def demanded(rules: tuple[Rule, ...], pack_rules: tuple[Rule, ...], type_of: TypeOf) -> tuple[Setting, ...]:
    """The rules to pack which set the fields that a message has with one value alone, and that nothing else sets.

    Their values may have fields of the wire: `known_to_pack` says what packing knows of these.
    """
    relations = [rule for rule in every_rule(rules) if isinstance(rule, Relation)]
    related = [place for rule in relations for place in fields_of(rule.value, "wire")]
    known = {names_of(place) for place in related if isinstance(place, Path)}
    known |= {names_of(rule.place) for rule in every_rule(rules) if isinstance(rule, Ignore)}
    known |= {*set_by(pack_rules, lengths=True)}
    by_name = any(isinstance(rule, SameNames) for rule in every_rule(rules))
    measured = {*set_by(pack_rules, lengths=True), *(names_of(path_of(place)) for place in related if _tells_length(place))}
    found: dict[Field, Setting] = {}
    for rule in rules:
        match rule:
            case When(condition, (Reject(),), ()):
                for place, value in _wanted(condition, type_of):
                    path = path_of(place)
                    has_own = by_name and type_of(Path("holder", path.steps)) is not None
                    if not has_own and not is_among(path, frozenset(measured if isinstance(place, Len) else known)):
                        found.setdefault(place, _setting(place, value, rule.span))
            case _:
                pass
    return tuple(found.values())


def known_to_pack(rules: tuple[Setting, ...], known: Knowledge) -> tuple[Rule, ...]:
    """Such rules with what packing knows in place of fields of the wire, where it knows all: the rejection reports what it does not."""
    made = (replace(rule, value=known.replaced(rule.value, ())) for rule in rules)
    return tuple(rule for rule in made if not fields_of(rule.value, "wire"))


def _setting(place: Field, value: Expr, span: Span | None) -> Setting:
    if isinstance(place, Len):
        return SetLength(place.path, value, span)
    return Assign(place, value, span) if _is_constant(value) else Assign(place, value, span, "checked")


def _tells_length(place: Field) -> bool:
    """Whether a relation to a field tells how long an array is."""
    return isinstance(place, Len) or not place.steps or not isinstance(place.steps[-1], Index)


def _wanted(condition: Expr, type_of: TypeOf) -> Iterator[tuple[Field, Expr]]:
    """The fields, each with the value that it has where a condition does not hold."""
    match condition:
        case Binary("or", left, right):
            yield from _wanted(left, type_of)
            yield from _wanted(right, type_of)
        case Binary("!=", Len(Path() as path) as length, value) | Binary("!=", value, Len(Path() as path) as length) if _is_single(path):
            if _is_constant(value) and isinstance(type_ := type_of(path), Array) and type_.length is None:
                yield length, value
        case Binary("!=", Path() as place, value) | Binary("!=", value, Path() as place) if _is_single(place):
            if not isinstance(type_of(place), Float) and place not in parts(value):  # a float may be -0 where it is compared with 0
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
