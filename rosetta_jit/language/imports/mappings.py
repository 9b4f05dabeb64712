"""The mappings that a mapping's rules use: read beforehand, with all that they import and use themselves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rosetta_jit.catalogue import nested as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import ReportError
from rosetta_jit.language.limits import MAX_MAPPINGS
from rosetta_jit.language.parameters.bind import bind
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.language.uses import UsableMappings
from rosetta_jit.model import mapping as model
from rosetta_jit.model.mapping import Assign, Relation, Rule, Via
from rosetta_jit.model.walk import every_rule
from rosetta_jit.parsing.search import Reading, SearchPath
from rosetta_jit.source import Source, Span

MAPPING_SUFFIX = ".mapping"
"""Of an import that is a mapping."""


def read_usable(
    mapping: model.Mapping, search: SearchPath, reading: Reading, problems: list[Diagnostic], parameters: Mapping[str, object] | None
) -> UsableMappings:
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
                    return UsableMappings(found, imported, (mapping.source.name,))
                other = _read(source, problems, parameters)
                if other is None:
                    continue
                read[source.name] = other
                pending.append(other)
            found[user.source.name, name] = read[source.name]
    return UsableMappings(found, imported, (mapping.source.name,))


def _read(source: Source, problems: list[Diagnostic], parameters: Mapping[str, object] | None) -> model.Mapping | None:
    try:
        mapping = parse(source)
        declared = {each.name for each in mapping.parameters}
        arguments = None if parameters is None else {name: value for name, value in parameters.items() if name in declared}
        return bind(mapping, arguments, problems)
    except ReportError as error:
        problems.extend(error.diagnostics)
        return None


def _named(mapping: model.Mapping) -> Iterator[tuple[str, Span | None]]:
    """The names of the mappings that one uses, and where."""
    yield from ((each.path, each.span) for each in mapping.imports if each.path.endswith(MAPPING_SUFFIX))
    for rules in (mapping.rules, mapping.unpack_rules, mapping.pack_rules):
        yield from ((via.mapping, via.span) for via in _vias(rules or ()))


def _vias(rules: tuple[Rule, ...]) -> Iterator[Via]:
    for rule in every_rule(rules):
        match rule:
            case Assign(by=Via() as via) | Relation(via=Via() as via):
                yield via
            case _:
                pass
