"""The definitions of a text and of every message that they need, those that others need first."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.ros import diagnostics as say
from rosetta_jit.frameworks.ros.dialect import Dialect, Interface
from rosetta_jit.frameworks.ros.limits import MAX_DEPTH, MAX_MESSAGES, MAX_PROBLEMS
from rosetta_jit.frameworks.ros.names import SUFFIX, Declared, declared_in, places, split
from rosetta_jit.frameworks.ros.reading import read
from rosetta_jit.frameworks.ros.sections import Section, sections
from rosetta_jit.frameworks.ros.tree import Definition, Field, TypeName
from rosetta_jit.model.limits import MAX_SLOTS
from rosetta_jit.parsing.idl import Load
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass, field, replace


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
        """The definitions in the text of one message, service or action."""
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
        candidates = tuple(places(type_.base, user.source.name, self.dialect))
        sources = (self.load(place) for place in candidates)
        source = next(
            (each for each in sources if each is not None and declared_in(each.name, self.dialect).package in ("", package)), None
        )
        usual = self.usual(type_)
        if type_.base + self.dialect.foreign in self.files or (source is None and self.declared_elsewhere(candidates)):
            self.foreign.add(type_.base)
        elif source is None and usual is not None:
            self.waiting.append((usual, user))
        elif source is None:
            self.missing.add(type_.base)
            self.problems.append(say.unknown_message(type_.span, type_.base, type_.written, candidates, tuple(self.dialect.scalars)))
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


def parts(whole: Section, dialect: Dialect, problems: list[Diagnostic]) -> list[Section]:
    """The definitions of a service or an action, which may not have another number of parts than its kind has."""
    interface, source = dialect.interfaces[whole.kind], whole.source
    dashes = list(dialect.dashes.finditer(source.text, whole.start, whole.end))
    if len(dashes) != len(interface.parts) - 1:
        place = dashes[len(interface.parts) - 1] if len(dashes) >= len(interface.parts) else None
        span = Span(source, place.start(), place.end()) if place else Span(source, whole.start, whole.start)
        problems.append(say.wrong_parts(span, whole.kind, len(dashes), len(interface.parts) - 1))
        return []
    starts, ends = [whole.start, *(each.end() for each in dashes)], [*(each.start() for each in dashes), whole.end]
    names = [each.format(whole.short) for each in interface.parts]
    written = [replace(whole, short=name, start=start, end=end, kind="msg") for name, start, end in zip(names, starts, ends, strict=True)]
    return [*written, *_added(whole, interface, _local(whole, interface, dialect))]


def _added(whole: Section, interface: Interface, local: Mapping[str, str]) -> Iterator[Section]:
    """What stands in no file: texts of their own, which a report about them shows."""
    for name, text in interface.added.items():
        own = Source(whole.source.name, text.format(whole.short))
        short, span = name.format(whole.short), Span(own, 0, 0)
        yield replace(whole, source=own, short=short, start=0, end=len(own.text), named=span, kind="msg", local=local)


def _local(whole: Section, interface: Interface, dialect: Dialect) -> Mapping[str, str]:
    names = [each.format(whole.short) for each in (*interface.parts, *interface.added)]
    return {name: dialect.message(whole.package, name, whole.folder) for name in names}


def dependencies_first(found: Mapping[str, Definition], problems: list[Diagnostic]) -> tuple[Definition, ...]:
    """The definitions in an order in which each comes after those of its fields, as far as these are found."""
    needs = {name: {each.type.base for each in _nested(definition)} & found.keys() for name, definition in found.items()}
    users: dict[str, list[str]] = {name: [] for name in found}
    for name, needed in needs.items():
        for each in needed:
            users[each].append(name)
    open_ = {name: len(needed) for name, needed in needs.items()}
    ready = [name for name, count in open_.items() if not count]
    for name in ready:  # grows while it is read
        for user in users[name]:
            open_[user] -= 1
            if not open_[user]:
                ready.append(user)
    if len(ready) < len(found):
        problems.append(_cycle(found, {name for name, count in open_.items() if count}))
        return ()
    ordered = tuple(found[name] for name in ready)
    _measure(ordered, problems)
    return ordered


def _nested(definition: Definition) -> list[Field]:
    return [each for each in definition.fields if not each.type.builtin]


def _cycle(found: Mapping[str, Definition], among: set[str]) -> Diagnostic:
    """The report of one cycle: every one of those messages has a field of another one of them."""
    name, path = next(each for each in found if each in among), list[str]()
    field = None
    while name not in path:
        path.append(name)
        field = next(each for each in _nested(found[name]) if each.type.base in among)
        name = field.type.base
    assert field is not None
    return say.cycle(field.type.span, [*path[path.index(name) :], name])


def _measure(ordered: tuple[Definition, ...], problems: list[Diagnostic]) -> None:
    depths: dict[str, int] = {}
    sizes: dict[str, int] = {}
    for each in ordered:
        inner = [field.type.base for field in _nested(each) if field.type.base in depths]
        depths[each.name] = 1 + max((depths[name] for name in inner), default=0)
        sizes[each.name] = len(each.fields) - len(inner) + sum(sizes[name] for name in inner)
        if depths[each.name] > MAX_DEPTH or sizes[each.name] > MAX_SLOTS:
            problems.append(say.too_deep(each.span, each.name, MAX_DEPTH, MAX_SLOTS))
            return
