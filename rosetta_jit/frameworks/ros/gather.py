"""The definitions of a text and of every message that they need, those that others need first."""

from __future__ import annotations

from collections import deque
from dataclasses import field
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import ros as say
from rosetta_jit.dataclass import dataclass
from rosetta_jit.frameworks.ros.interfaces import parts
from rosetta_jit.frameworks.ros.names import SUFFIX, Declared, declared_in, places, split
from rosetta_jit.frameworks.ros.order import dependencies_first
from rosetta_jit.frameworks.ros.reading import MAX_PROBLEMS, read
from rosetta_jit.frameworks.ros.sections import sections

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.ros.dialect import Dialect
    from rosetta_jit.frameworks.ros.tree import Definition, TypeName
    from rosetta_jit.frontend.idl import Load
    from rosetta_jit.source import Source

MAX_MESSAGES = 4096
"""Messages that one may need, directly or not."""


@dataclass(frozen=True, slots=True)
class Gathered:
    """Definitions, those that others need first, and the names of messages that another IDL declares."""

    definitions: tuple[Definition, ...]
    foreign: frozenset[str] = frozenset()


def gather(source: Source, load: Load, dialect: Dialect, problems: list[Diagnostic]) -> Gathered:
    """Read a source and the messages that it needs; those that the text itself defines come before any on the search path."""
    gathering = _Gathering(source, load, dialect, problems)
    gathering.add(source, declared_in(source.name, dialect))
    while gathering.waiting and len(problems) < MAX_PROBLEMS:
        gathering.find(*gathering.waiting.popleft())
    return Gathered(() if problems else dependencies_first(gathering.found, problems), frozenset(gathering.foreign))


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

    def add(self, source: Source, declared: Declared) -> None:
        """The definitions of a text, whose first one is that of the named message, or of the file of a service or an action."""
        several = source.name.endswith(f".{declared.folder}") and declared.folder in self.dialect.interfaces
        for section in (parts if several else sections)(source, declared, self.dialect, self.problems):
            if section.local and self.problems:
                return  # what peers add to a file that is wrong says nothing new
            definition = read(section, self.dialect, self.problems)
            known = self.found.setdefault(definition.name, definition)
            if known is definition:
                self.waiting += [(each.type, definition) for each in definition.fields if not each.type.builtin]
            elif known.source is source and known.text.strip() != definition.text.strip():
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
        if source is None and self.declared_elsewhere(asked):
            self.foreign.add(type_.base)
        elif source is None:
            self.missing.add(type_.base)
            self.problems.append(say.unknown_message(type_.span, type_.base, type_.written, asked, tuple(self.dialect.scalars)))
        elif len(self.found) >= MAX_MESSAGES:
            self.problems.append(say.too_many(type_.span, MAX_MESSAGES))
            self.waiting.clear()
        else:
            self.add(source, Declared(package, "msg", short))

    def declared_elsewhere(self, places: tuple[str, ...]) -> bool:
        """Whether there is a file of the other IDL in which the message can be declared."""
        suffix = self.dialect.foreign
        return bool(suffix) and any(self.load(each.removesuffix(SUFFIX) + suffix) is not None for each in places)
