"""The definitions of a text and of every message that they need, those that others need first."""

from __future__ import annotations

from collections import deque
from dataclasses import field, replace
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.ros import diagnostics as say
from rosetta_jit.frameworks.ros.interfaces import parts
from rosetta_jit.frameworks.ros.limits import MAX_MESSAGES, MAX_PROBLEMS
from rosetta_jit.frameworks.ros.names import SUFFIX, Declared, declared_in, places, split
from rosetta_jit.frameworks.ros.order import dependencies_first
from rosetta_jit.frameworks.ros.reading import read
from rosetta_jit.frameworks.ros.sections import sections
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.ros.dialect import Dialect
    from rosetta_jit.frameworks.ros.sections import Section
    from rosetta_jit.frameworks.ros.tree import Definition, Field, TypeName
    from rosetta_jit.parsing.idl import Load
    from rosetta_jit.source import Source


@dataclass(frozen=True, slots=True)
class Gathered:
    """Definitions, those that others need first; the names of messages that another IDL declares, and the files of that in the text."""

    definitions: tuple[Definition, ...]
    foreign: frozenset[str] = frozenset()
    files: Mapping[str, str] = field(default_factory=dict[str, str])


def gather(source: Source, load: Load, dialect: Dialect, problems: list[Diagnostic]) -> Gathered:
    """Read a source and the messages that it needs; those that the text itself defines come before any on the search path."""
    gathering = _Gathering(source, load, dialect, problems)
    gathering.add(source, declared_in(source.name, dialect))
    while gathering.waiting and len(problems) < MAX_PROBLEMS:
        gathering.find(*gathering.waiting.popleft())
    definitions = () if problems else dependencies_first(gathering.resolved(), problems)
    return Gathered(definitions, frozenset(gathering.foreign), gathering.files)


@dataclass(slots=True)
class _Gathering:
    root: Source
    load: Load
    dialect: Dialect
    problems: list[Diagnostic]
    found: dict[str, Definition] = field(default_factory=dict["str", "Definition"])
    waiting: deque[tuple[TypeName, Definition]] = field(default_factory=deque["tuple[TypeName, Definition]"])
    missing: set[str] = field(default_factory=set[str])
    foreign: set[str] = field(default_factory=set[str])
    files: dict[str, str] = field(default_factory=dict[str, str])

    def add(self, source: Source, declared: Declared) -> None:
        """The definitions of a text, whose first one is that of the named file."""
        for section in sections(source, declared, self.dialect, self.problems):
            if f".{section.kind}" == self.dialect.foreign:
                self.files.setdefault(f"{section.package}/{section.folder}/{section.short}{self.dialect.foreign}", section.text)
            elif section.kind in self.dialect.interfaces:
                self.define(parts(section, self.dialect, self.problems))
            else:
                self.define([section])

    def define(self, found: list[Section]) -> None:
        """What the text of one message, service or action defines."""
        for section in found:
            if section.local and self.problems:
                return  # what peers add to a file that is wrong says nothing new
            definition = read(section, self.dialect, self.problems)
            known = self.found.setdefault(definition.name, definition)
            if known is definition:
                self.waiting += [(each.type, definition) for each in definition.fields if not each.type.builtin]
            elif known.source is section.source and known.text.strip() != definition.text.strip():
                self.problems.append(say.defined_twice(section.named, definition.name, known.span))

    def find(self, type_: TypeName, user: Definition) -> None:
        """Read the file in which a message is declared, if it is not known yet."""
        if type_.base in self.found or type_.base in self.missing or type_.base in self.foreign:
            return
        package, short = split(type_.base)
        asked = tuple(places(type_.base, user.source.name, self.dialect))
        sources = (self.load(place) for place in asked)
        source = next(
            (each for each in sources if each is not None and declared_in(each.name, self.dialect).package in ("", package)), None
        )
        usual = self.usual(type_)
        if type_.base + self.dialect.foreign in self.files or (source is None and self.declared_elsewhere(asked)):
            self.foreign.add(type_.base)
        elif source is None and usual is not None:
            self.waiting.append((usual, user))
        elif source is None:
            self.missing.add(type_.base)
            self.problems.append(say.unknown_message(type_.span, type_.base, type_.written, asked, tuple(self.dialect.scalars)))
        elif len(self.found) >= MAX_MESSAGES:
            self.problems.append(say.too_many(type_.span, MAX_MESSAGES))
            self.waiting.clear()
        else:
            self.add(source, Declared(package, "msg", short))

    def usual(self, type_: TypeName) -> TypeName | None:
        """The message of another package that a word without one stands for."""
        word = type_.written.split("[", 1)[0]
        name = self.dialect.usual.get(word)
        return None if name is None else replace(type_, base=name, written=name + type_.written.removeprefix(word))

    def resolved(self) -> dict[str, Definition]:
        """The definitions, with what words without a package stand for where their own package has no such message."""
        return {name: replace(each, fields=tuple(map(self.known, each.fields))) for name, each in self.found.items()}

    def known(self, field: Field) -> Field:
        usual = self.usual(field.type)
        there = field.type.base in self.found or field.type.base in self.foreign
        return field if there or usual is None else replace(field, type=usual)

    def declared_elsewhere(self, places: tuple[str, ...]) -> bool:
        """Whether there is a file of the other IDL in which the message can be declared."""
        suffix = self.dialect.foreign
        return bool(suffix) and any(self.load(each.removesuffix(SUFFIX) + suffix) is not None for each in places)
