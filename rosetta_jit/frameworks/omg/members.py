"""The members of structs and the cases of unions, with their ids."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.omg import diagnostics as say
from rosetta_jit.frameworks.omg import tree
from rosetta_jit.frameworks.omg.annotations import Annotations
from rosetta_jit.frameworks.omg.constants import evaluate, fit, word_of
from rosetta_jit.frameworks.omg.problems import LookupProblem
from rosetta_jit.frameworks.omg.scopes import Entry, Scope
from rosetta_jit.frameworks.omg.types import TypeMaker, value_of
from rosetta_jit.model.types import Bool, Constant, Declaration, Enum, Field, Int, Optional, Ref, Type, Union
from rosetta_jit.model.units import with_unit
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace

DISCRIMINATOR, CASES = "_d", "_u"
"""The fields of the struct that a union is."""


@dataclass(frozen=True, slots=True)
class MemberMaker:
    """Makes fields; ``hashed`` says whether ids are hashes of names where nothing else is said."""

    maker: TypeMaker
    types: Mapping[str, Declaration]
    problems: list[Diagnostic]
    hashed: bool

    def struct(self, scope: Scope, definition: tree.Aggregate, notes: Annotations, base: tuple[Field, ...]) -> tuple[Field, ...]:
        """The members of a struct after those that it inherits."""
        hashed = notes.hashed_ids(outer=self.hashed)
        fields = list(base)
        ids = {each.number: each.name for each in base if each.number is not None}
        for inherited in base:
            at = inherited.span or definition.name.span
            scope.entries.setdefault(inherited.name.lower(), Entry("member", inherited.name, inherited.name, at))
        following = (base[-1].number or 0) + 1 if base else 0
        for member in definition.members or ():
            for field in self.guarded(scope, member, following, hashed=hashed):
                self.unique(field, ids)
                following = (field.number or 0) + 1
                fields.append(field)
        return tuple(fields)

    def guarded(self, scope: Scope, member: tree.Member, following: int, *, hashed: bool) -> Iterator[Field]:
        """The fields of one statement, as far as they can be made."""
        try:
            yield from self.member(scope, member, following, hashed=hashed)
        except LookupProblem as error:
            self.problems.append(error.problem)

    def member(self, scope: Scope, member: tree.Member, following: int, *, hashed: bool) -> Iterator[Field]:
        free = member.declarators[0].name.free
        notes = Annotations(member.annotations, lambda name: value_of(scope, name, free=free))
        plain = self.maker.type(scope, member.type, free=free)
        for declarator in member.declarators:
            name = declarator.name
            type_ = self.maker.declared(scope, plain, declarator)
            scope.declare(name, Entry("member", name.text, scope.join(name), name.span))
            number = notes.member_id(name.text, following, hashed=hashed)
            following = number + 1
            default, options = notes.of_member(type_, self.default_of(scope, type_))
            shown = Optional(type_) if notes.flag("optional") else type_
            field = Field(name.text, shown, number, default=default, options=options, doc=notes.doc, span=name.span)
            yield with_unit(field, notes.text("unit"))

    def unique(self, field: Field, ids: dict[int, str]) -> None:
        assert field.number is not None
        first = ids.setdefault(field.number, field.name)
        if first != field.name and field.span is not None:
            self.problems.append(say.repeated_id(field.span, field.number, first))

    def default_of(self, scope: Scope, type_: Type) -> Constant | None:
        """The number of an enum's `@default_literal`."""
        declared = self.types.get(type_.name) if isinstance(type_, Ref) else None
        if not isinstance(declared, Enum):
            return None
        around: Scope = scope
        while around.outer is not None:
            around = around.outer
        entry: Entry | None = None
        for part in declared.name.split("::"):
            entry = around.entries.get(part.lower())
            if entry is None or entry.scope is None:
                break
            around = entry.scope
        return entry.value.value if entry is not None and entry.kind == "enum" and entry.value is not None else None

    # Unions

    def union(self, outer: Scope, scope: Scope, definition: tree.Aggregate, notes: Annotations) -> tuple[Field, ...]:
        """The two fields of the struct that a union is."""
        assert definition.switch is not None
        name, free = definition.name, definition.name.free
        switch = self.maker.type(scope, definition.switch, free=free)
        declared = self.types.get(switch.name) if isinstance(switch, Ref) else switch
        if not isinstance(declared, Bool | Int | Enum):
            span = getattr(definition.switch, "span", name.span)
            raise LookupProblem(say.union_switch(span, word_of(switch)))
        switch_notes = Annotations(definition.switch_annotations, lambda each: value_of(outer, each, free=free))
        cases, labels, default = self.cases(scope, definition, switch, notes)
        if default is not None and _exhausted(declared, labels):
            self.problems.append(say.needless_default(cases[default].span or name.span))
        options = switch_notes.of_member(switch, None)[1]
        discriminator = Field(DISCRIMINATOR, switch, 0, options=options, span=name.span)
        made = Union(f"{scope.full}::{CASES}", tuple(cases), name.span, DISCRIMINATOR, tuple(labels), default)
        return (discriminator, Field(CASES, made, span=name.span))

    def cases(
        self, scope: Scope, definition: tree.Aggregate, switch: Type, notes: Annotations
    ) -> tuple[list[Field], list[tuple[int, ...]], int | None]:
        hashed = notes.hashed_ids(outer=self.hashed)
        cases: list[Field] = []
        labels: list[tuple[int, ...]] = []
        seen: dict[int | None, Span] = {}
        ids = {0: DISCRIMINATOR}
        default: int | None = None
        following = 1  # the discriminator has the id 0 (DDS-XTypes 1.3, 7.3.1.2.1.1)
        for member in definition.members or ():
            own = self.labels(scope, member, switch, definition.name.free, seen)
            for field in self.guarded(scope, member, following, hashed=hashed):
                self.unique(field, ids)
                following = (field.number or 0) + 1
                default = len(cases) if None in member.labels else default
                cases.append(replace(field, default=None) if isinstance(field.type, Optional) else field)
                labels.append(own)
        return cases, labels, default

    def labels(self, scope: Scope, member: tree.Member, switch: Type, free: bool, seen: dict[int | None, Span]) -> tuple[int, ...]:
        found: list[int] = []
        for label in member.labels:
            try:
                span = member.declarators[0].name.span if label is None else label.span
                number = None if label is None else int(fit(evaluate(label, lambda name: value_of(scope, name, free=free)), switch, span))
            except LookupProblem as error:
                self.problems.append(error.problem)
                continue
            if number in seen:
                self.problems.append(say.repeated_label(span, seen[number]))
            seen.setdefault(number, span)
            found += [] if number is None else [number]
        return tuple(found)


def _exhausted(switch: Bool | Int | Enum, labels: list[tuple[int, ...]]) -> bool:
    """Whether every value of a discriminator has a case."""
    used = {number for each in labels for number in each}
    match switch:
        case Bool():
            return used == {0, 1}
        case Enum():
            return used >= {number for _, number in switch.values}
        case Int(bits):
            return len(used) == 1 << bits
