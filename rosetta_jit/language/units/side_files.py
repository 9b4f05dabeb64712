"""Units of side files, onto the fields that they name: a schema → the same schema with units.

A unit stands at the field where its path begins, so that it holds for messages of that type alone: `sensor_msgs/Imu` can say of a vector
what the vector's own type cannot.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import unit_files as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.conversions import describe
from rosetta_jit.language.limits import MAX_UNIT_PROBLEMS
from rosetta_jit.language.scope import Message, members_of
from rosetta_jit.language.units.dimensions import conversion, is_unit, known_units
from rosetta_jit.model.limits import MAX_UNIT_PARTS
from rosetta_jit.model.types import Array, Declaration, Field, Float, Int, PartUnit, Schema, Struct, Type, Union, name_parts
from rosetta_jit.model.units import Context
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, field, replace

if TYPE_CHECKING:
    from rosetta_jit.language.parse.unit_file import Named, Step, UnitFile, UnitsOf

    Way = tuple[str | int | None, ...]
    Members = dict[str, tuple[Field, ...]]


def annotated(schema: Schema, files: Sequence[UnitFile], is_elsewhere: Callable[[str], bool], problems: list[Diagnostic]) -> Schema:
    """The schema with the units that side files say.

    Parameters
    ----------
    is_elsewhere
        Whether a type that the schema lacks is one that could have been imported: then nothing is wrong with what is said of it.
    """
    adding = _Adding(schema, is_elsewhere)
    for file in files:
        adding.file(file)
    problems += adding.problems[:MAX_UNIT_PROBLEMS]
    types = {name: _with_units(declared, adding.found[name]) for name, declared in schema.types.items()}
    return replace(schema, types=types)


def _with_units(declared: Declaration, units: dict[Way, Named]) -> Declaration:
    if not units or not isinstance(declared, Struct):
        return declared
    own = {way[0]: unit.text for way, unit in units.items() if len(way) == 1}
    parts: defaultdict[str | int | None, list[PartUnit]] = defaultdict(list)
    for way, unit in units.items():
        parts[way[0]] += [(way[1:], unit.text)] if len(way) > 1 else []
    fields = tuple(
        replace(each, unit=own.get(each.name, each.unit), part_units=(*parts[each.name], *each.part_units)) for each in declared.fields
    )
    return replace(declared, fields=fields)


@dataclass(slots=True)
class _Adding:
    """What the files have said so far, by type and way."""

    schema: Schema
    is_elsewhere: Callable[[str], bool]
    found: defaultdict[str, dict[Way, Named]] = field(default_factory=lambda: defaultdict[str, "dict[Way, Named]"](dict))
    counts: Counter[tuple[str, str | int | None]] = field(default_factory=Counter["tuple[str, str | int | None]"])
    members: dict[str, Members] = field(default_factory=dict[str, "Members"])
    problems: list[Diagnostic] = field(default_factory=list["Diagnostic"])

    def file(self, file: UnitFile) -> None:
        names = {name_parts(name): name for name, type_ in self.schema.types.items() if isinstance(type_, Struct)}
        for type_ in file.types:
            if name_parts(type_.text) not in names and len(self.problems) < MAX_UNIT_PROBLEMS and not self.is_elsewhere(type_.text):
                self.problems.append(words.unknown_type(type_.span, type_.text, names.values()))
        for each in file.fields:
            name = names.get(name_parts(each.type.text))
            struct = None if name is None else self.schema.types[name]
            if isinstance(struct, Struct) and len(self.problems) < MAX_UNIT_PROBLEMS:
                self.units(struct, each)

    def units(self, struct: Struct, said: UnitsOf) -> None:
        target = _Target(Message(struct, self.schema), struct, self.members)
        for step in said.path:
            problem = target.step(step)
            if problem is not None:
                self.problems.append(problem)
                return
        for number, unit in enumerate(said.units):
            problem = target.cannot_have(number, unit.span, several=len(said.units) > 1) or self.unknown(unit)
            if problem is not None:
                self.problems.append(problem)
                return
            way, context = target.way, target.context
            if len(said.units) > 1:
                way, context = (*way, number), context.element(number)
            self.add(struct, way, unit, context.unit)

    def add(self, struct: Struct, way: Way, unit: Named, declared: str | None) -> None:
        units = self.found[struct.name]
        first = units.get(way)
        other = first.text if first else declared
        if other is not None and conversion(other, unit.text) != (1.0, 0.0):
            self.problems.append(words.contradicts(unit.span, unit.text, other, first.span if first else None))
        elif self.counts[struct.name, way[0]] >= MAX_UNIT_PARTS:
            self.problems.append(words.too_many_parts(unit.span, MAX_UNIT_PARTS))
        elif first is None:
            self.counts[struct.name, way[0]] += 1
            units[way] = unit

    def unknown(self, unit: Named) -> Diagnostic | None:
        return None if is_unit(unit.text) else words.unknown_unit(unit.span, unit.text, list(known_units()))


@dataclass(slots=True)
class _Target:
    """Where a path has led so far: the type there, the way as fields are found, and what the IDL says of units there."""

    message: Message
    type: Type
    known: dict[str, Members]
    way: Way = ()
    context: Context = field(default_factory=Context)

    def step(self, step: Step) -> Diagnostic | None:
        """Go one step further, or say why not."""
        return self.member(step.to, step.span) if isinstance(step.to, str) else self.element(step.to, step.span)

    def member(self, name: str, span: Span) -> Diagnostic | None:
        if not isinstance(self.type, Struct | Union):
            return words.wrong_step(span, describe(self.type), into="fields")
        owner = self.type.name
        members = self.known[owner] = self.known.get(owner) or members_of(self.type, self.message.schema)
        if name not in members:
            return words.unknown_field(span, name, owner, members.keys())
        found = members[name]
        for each in found:
            self.way, self.context = (*self.way, each.name), self.context.member(each)
        self.enter(found[-1].type)
        return None

    def element(self, number: int | None, span: Span) -> Diagnostic | None:
        if not isinstance(self.type, Array):
            return words.wrong_step(span, describe(self.type), into="elements")
        if number is not None and number >= (self.most or number + 1):
            return words.index_range(span, self.most or 0)
        self.way, self.context = (*self.way, number), self.context.element(number)
        self.enter(self.type.element)
        return None

    def cannot_have(self, number: int, span: Span, *, several: bool) -> Diagnostic | None:
        """Why the type has no unit, or not that many."""
        if several and not isinstance(self.type, Array):
            return words.not_several(span, describe(self.type)) if number else None
        if several and number >= (self.most or number + 1):
            return words.index_range(span, self.most or 0)
        return None if self.numbers(self.type) else words.no_numbers(span, describe(self.type))

    @property
    def most(self) -> int | None:
        return (self.type.fixed or self.type.maximum) if isinstance(self.type, Array) else None

    def enter(self, type_: Type) -> None:
        self.type = self.value(type_)

    def numbers(self, type_: Type) -> bool:
        """Whether a value has or may have numbers within."""
        match type_:
            case Array(element=element):
                return self.numbers(self.value(element))
            case Int() | Float() | Struct() | Union():
                return True
            case _:
                return False

    def value(self, type_: Type) -> Type:
        return self.message.value_type(type_)
