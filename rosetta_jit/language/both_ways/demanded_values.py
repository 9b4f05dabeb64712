"""Values that rejections demand: packing writes the one value that a `reject` lets through, where no other rule sets the field.

`reject "why" when .id != 0x201` packs `.id = 0x201`, `… when len(.values) != 3` packs `len(.values) = 3`, and `… when .check != crc(.data,
"CRC-16/X-25")` packs the checksum: what unpacking lets through has one value there. So does `… when .frames[].id != 7`, and a rejection
in a loop, in each element of an array whose length relations say.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.knowledge import Knowledge, Loop, Loops
from rosetta_jit.language.both_ways.named_fields import is_among, set_by
from rosetta_jit.model.expr import Binary, Call, Each, Expr, Index, Len, Literal, Member, Name, Path, Step, Unary
from rosetta_jit.model.mapping import Assign, Assignment, For, Ignore, Reject, Relation, Rule, SameNames, SetLength, When
from rosetta_jit.model.types import Array, Bool, Float
from rosetta_jit.model.walk import Field, every_rule, fields_of, names_of, parts, path_of
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf

    Setting = Assignment | SetLength[Path, Expr] | For[Rule, Expr]


def demanded(rules: tuple[Rule, ...], pack_rules: tuple[Rule, ...], type_of: TypeOf) -> tuple[Setting, ...]:
    """The rules to pack which set the fields that a message has with one value alone, and that nothing else sets.

    Their values may have fields of the wire: `known_to_pack` says what packing knows of these.
    """
    relations = [rule for rule in every_rule(rules) if isinstance(rule, Relation)]
    related = [place for rule in relations for place in fields_of(rule.value, "wire")]
    known = {names_of(place) for place in related if isinstance(place, Path)}
    known |= {names_of(rule.place) for rule in every_rule(rules) if isinstance(rule, Ignore)}
    known |= {*set_by(pack_rules, lengths=True)}
    measured = {*set_by(pack_rules, lengths=True), *(names_of(path_of(place)) for place in related if _tells_length(place))}
    by_name = any(isinstance(rule, SameNames) for rule in every_rule(rules))
    return tuple(_Demands(type_of, frozenset(known), frozenset(measured), frozenset(map(_array, related)), by_name).of(rules, set(), ()))


@dataclass(frozen=True, slots=True)
class _Demands:
    """What the rejections of a text demand, of fields that nothing else tells: the ``known`` ones, and lengths that are ``measured``.

    ``arrays`` are those of which relations say something of each element, and ``by_name`` is whether fields are related by their names.
    """

    type_of: TypeOf
    known: frozenset[tuple[str, ...]]
    measured: frozenset[tuple[str, ...]]
    arrays: frozenset[tuple[str, ...]]
    by_name: bool

    def of(self, rules: tuple[Rule, ...], found: set[tuple[bool, tuple[str, ...]]], variables: tuple[str, ...]) -> Iterator[Setting]:
        """The rules of a block, in loops over these variables; the fields and lengths that are ``found`` before are not set again."""
        for rule in rules:
            match rule:
                case When(condition, (Reject(),), ()):
                    for place, value in _wanted(condition, self.type_of):
                        what = isinstance(place, Len), names_of(path_of(place))
                        if what not in found and self.is_open(place, variables):
                            found.add(what)
                            yield _setting(place, value, rule.span, variables)
                case For(variable, body=body):
                    inner = tuple(self.of(body, found, (*variables, variable)))
                    if inner:
                        yield replace(rule, body=inner)
                case _:
                    pass

    def is_open(self, place: Field, variables: tuple[str, ...]) -> bool:
        """Whether a rejection alone says what a field is, or each element's."""
        path = path_of(place)
        if isinstance(place, Len) or len(names_of(path)) == len(path.steps):
            is_there = not variables
        else:
            is_there = _array(path) in self.arrays and all(_is_counted(step, variables) for step in path.steps)
        has_own = self.by_name and self.type_of(Path("holder", path.steps)) is not None
        return is_there and not has_own and not is_among(path, self.measured if isinstance(place, Len) else self.known)


def known_to_pack(rules: tuple[Rule, ...], known: Knowledge, loops: Loops = ()) -> tuple[Rule, ...]:
    """Such rules with what packing knows in place of fields of the wire, where it knows all: the rejection reports what it does not."""
    return tuple(made for rule in rules for made in _known_rule(rule, known, loops))


def _known_rule(rule: Rule, known: Knowledge, loops: Loops) -> Iterator[Rule]:
    match rule:
        case For(variable, start, stop, body):
            first, last = (known.replaced(bound, loops) for bound in (start, stop))
            inner = known_to_pack(body, known, (*loops, Loop(variable, start, stop)))
            if inner and not fields_of(first, "wire") and not fields_of(last, "wire"):
                yield replace(rule, start=first, stop=last, body=inner)
        case Assign(value=value) | SetLength(value=value):
            value = known.replaced(value, loops)
            if not fields_of(value, "wire"):
                yield replace(rule, value=value)
        case _:
            raise AssertionError(rule)


def _array(place: Field) -> tuple[str, ...]:
    """The fields on the way to the last array on the way to a field."""
    steps = path_of(place).steps
    last = max((number for number, step in enumerate(steps) if isinstance(step, Each | Index)), default=0)
    return tuple(step.name for step in steps[:last] if isinstance(step, Member))


def _is_counted(step: Step, variables: tuple[str, ...]) -> bool:
    """Whether a step is a field, every element, or that of the number of a loop."""
    match step:
        case Member() | Each():
            return True
        case Index(Name(name)):
            return name in variables
        case _:
            return False


def _setting(place: Field, value: Expr, span: Span | None, variables: tuple[str, ...]) -> Assignment | SetLength[Path, Expr]:
    if isinstance(place, Len):
        return SetLength(place.path, value, span)
    counts = any(isinstance(part, Call) or (isinstance(part, Name) and part.name in variables) for part in parts(value))
    return Assign(place, value, span) if _is_constant(value) and not counts else Assign(place, value, span, "checked")


def _tells_length(place: Field) -> bool:
    """Whether a relation to a field tells how long an array is."""
    return isinstance(place, Len) or not place.steps or not isinstance(place.steps[-1], Index)


def _wanted(condition: Expr, type_of: TypeOf) -> Iterator[tuple[Field, Expr]]:
    """The fields, each with the value that it has where a condition does not hold."""
    match condition:
        case Binary("or", left, right):
            yield from _wanted(left, type_of)
            yield from _wanted(right, type_of)
        case Binary("!=", Len(Path() as path) as length, value) | Binary("!=", value, Len(Path() as path) as length) if _is_of_wire(path):
            if _is_constant(value) and isinstance(type_ := type_of(path), Array) and type_.length is None:
                yield length, value
        case Binary("!=", Path() as place, value) | Binary("!=", value, Path() as place) if _is_of_wire(place):
            if not isinstance(type_of(place), Float) and place not in parts(value):  # a float may be -0 where it is compared with 0
                yield place, value
        case Path() as place if _is_of_wire(place) and isinstance(type_of(place), Bool):
            yield place, Literal(False, place.span)
        case Unary("not", Path() as place) if _is_of_wire(place) and isinstance(type_of(place), Bool):
            yield place, Literal(True, place.span)
        case _:
            pass


def _is_of_wire(place: Path) -> bool:
    """Whether a field is of the wire, and no part of an array."""
    return (
        place.side == "wire"
        and all(isinstance(step, Member | Each | Index) for step in place.steps)
        and isinstance(place.steps[-1], Member)
    )


def _is_constant(value: Expr) -> bool:
    return not any(isinstance(part, Path) for part in parts(value)) and not fields_of(value, "wire")
