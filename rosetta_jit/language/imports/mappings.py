"""The mappings that a mapping's rules use: read beforehand, with all that they import and use themselves."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import nested as words
from rosetta_jit.errors import ReportError
from rosetta_jit.language.both_ways.directions import in_each_direction
from rosetta_jit.language.parameters.bind import bind
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.model.mapping import Assign, For, When
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.language.imports.search import Reading, SearchPath
    from rosetta_jit.language.typed import Place
    from rosetta_jit.model import mapping as model
    from rosetta_jit.model.expr import Side
    from rosetta_jit.model.mapping import Rule, Via
    from rosetta_jit.source import Source, Span

MAPPING_SUFFIX = ".mapping"
"""Of an import that is a mapping."""

MAX_MAPPINGS = 64
"""Mappings that one mapping may use, those that they use included."""


class EnoughError(Exception):
    """What is wrong is so large that nothing more is looked at; never leaves `rosetta_jit.language.resolve.rules`."""


MAX_USES = 1000
"""How often mappings may be used in all: each use is a copy of its rules."""

MAX_COPIED = 10_000
"""Rules that all uses together copy."""


@dataclass(frozen=True, slots=True)
class Use:
    """That a rule is made by a mapping whose ``side`` is what the rule sets: at ``place``, from ``origin``."""

    mapping: model.Mapping
    side: Side
    place: Place
    origin: Place
    span: Span | None


@dataclass(frozen=True, slots=True)
class Others:
    """The mappings that can be used, by the file that names them and the name there; and what is being used at the moment.

    ``using`` are the files of the mappings around, from the outermost on; ``uses`` are all that were made.
    """

    found: Mapping[tuple[str, str], model.Mapping]
    imported: Mapping[str, tuple[str, ...]]
    using: tuple[str, ...]
    uses: list[Use] = field(default_factory=list["Use"])

    def named(self, via: Via) -> model.Mapping | None:
        """The mapping of a ``via``; None where it could not be read, which is reported."""
        return self.found.get((self.using[-1], via.mapping))

    def copied(self) -> int:
        """How many rules the uses so far have."""
        blocks = [use.mapping.unpack_rules if use.side == "holder" else use.mapping.pack_rules for use in self.uses]
        return sum(len(block or ()) for block in blocks)

    def mappings(self) -> list[model.Mapping]:
        """Each mapping once."""
        return list({each.source.name: each for each in self.found.values()}.values())

    def by_type(self) -> list[model.Mapping]:
        """The mappings that the file of the innermost one imports."""
        here = self.using[-1]
        return [self.found[here, name] for name in self.imported.get(here, ()) if (here, name) in self.found]


def read_others(
    mapping: model.Mapping, search: SearchPath, reading: Reading, problems: list[Diagnostic], parameters: Mapping[str, object] | None
) -> Others:
    """Read all mappings that a mapping uses, directly or through others. Of its ``parameters`` they have those that they declare."""
    found: dict[tuple[str, str], model.Mapping] = {}
    imported: dict[str, tuple[str, ...]] = {}
    read: dict[str, model.Mapping] = {mapping.source.name: mapping}
    pending = [mapping]
    while pending:
        user = pending.pop()
        imported[user.source.name] = tuple(each.path for each in user.imports if each.path.endswith(MAPPING_SUFFIX))
        for name, span in _named(user):
            if (user.source.name, name) in found:
                continue
            source = search.loader(reading, user.source)(name)
            if source is None:
                problems.append(words.no_such_mapping(span, name, map(str, search.folders)))
                continue
            if source.name not in read:
                if len(read) > MAX_MAPPINGS:
                    problems.append(words.many_mappings(span, MAX_MAPPINGS))
                    return Others(found, imported, (mapping.source.name,))
                other = _read(source, problems, parameters)
                if other is None:
                    continue
                read[source.name] = other
                pending.append(other)
            found[user.source.name, name] = read[source.name]
    return Others(found, imported, (mapping.source.name,))


def _read(source: Source, problems: list[Diagnostic], parameters: Mapping[str, object] | None) -> model.Mapping | None:
    try:
        mapping = parse(source)
        declared = {each.name for each in mapping.parameters}
        given = None if parameters is None else {name: value for name, value in parameters.items() if name in declared}
        return in_each_direction(bind(mapping, given, problems), problems)
    except ReportError as error:
        problems.extend(error.diagnostics)
        return None


def _named(mapping: model.Mapping) -> Iterator[tuple[str, Span | None]]:
    """The names of the mappings that one uses, and where."""
    yield from ((each.path, each.span) for each in mapping.imports if each.path.endswith(MAPPING_SUFFIX))
    for rules in (mapping.unpack_rules, mapping.pack_rules):
        yield from ((via.mapping, via.span) for via in _vias(rules or ()))


def _vias(rules: tuple[Rule, ...]) -> Iterator[Via]:
    for rule in rules:
        match rule:
            case Assign(via=via) if via is not None:
                yield via
            case For(body=body):
                yield from _vias(body)
            case When(_, then, otherwise):
                yield from _vias((*then, *otherwise))
            case _:
                pass
