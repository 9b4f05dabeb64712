"""A draft of a mapping between two types: proposed, then checked, until all that it decides is right for the checker."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rosetta_jit.catalogue import draft as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.draft.leaves import leaves_of, with_units
from rosetta_jit.draft.limits import MAX_ROUNDS
from rosetta_jit.draft.rules import decisions
from rosetta_jit.draft.text import Sides, draft_text
from rosetta_jit.errors import MappingError
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.language.check.mapping import check
from rosetta_jit.language.imports.declarations import Imports, merge, read_imports
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.language.parse.unit_file import UnitFile
from rosetta_jit.language.parse.unit_file import parse as parse_units
from rosetta_jit.language.scope import Message
from rosetta_jit.language.units.side_files import annotated
from rosetta_jit.model.mapping import Mapping
from rosetta_jit.model.types import Schema, Struct, same_name
from rosetta_jit.parsing.search import Reading, SearchPath
from rosetta_jit.pipeline.similar_types import similar_types
from rosetta_jit.source import Source

NAME = "draft.mapping"

UNITS = ("ros/sensor_msgs.units", "ros/geometry_msgs.units", "ros/nav_msgs.units", "rst/rst.units")
"""Side files that say in what the shipped types measure."""


def draft(
    holder: str, wire: str, *, imports: Iterable[str] = (), folders: Iterable[str] = (), encoding: str | None = None
) -> tuple[str, tuple[Diagnostic, ...]]:
    """A draft of the mapping between two types, and what the checker still says of it.

    Parameters
    ----------
    holder, wire
        Names of types.
    imports
        The files that declare them, as a mapping names them; by default those that the names suggest.
    encoding
        Of the wire, which tells frameworks apart that have types of one name.

    Raises
    ------
    MappingError
        A type or a file that there is not.
    """
    search, readers = SearchPath.of(folders), Readers(installed(), None, encoding)
    sides = _sides(holder, wire, tuple(imports), search, readers)
    found = decisions(sides.holder, sides.wire)
    refused: dict[str, str] = {}
    text = draft_text(sides, found, refused)
    problems = _problems(text, search, readers)
    for _ in range(MAX_ROUNDS):
        wrong = {line: problem for problem in problems if problem.severity == "error" and (line := _relation(problem, text)) is not None}
        if not wrong:
            break
        refused |= {line: problem.message for line, problem in wrong.items()}
        text = draft_text(sides, found, refused)
        problems = _problems(text, search, readers)
    return text, problems


def _sides(holder: str, wire: str, imports: tuple[str, ...], search: SearchPath, readers: Readers) -> Sides:
    """The leaves of both types, with the units that are known of them."""
    stub = parse(Source(NAME, f"data-holder: {_quoted(holder)}\nwire-schema: {_quoted(wire)}\nrules:\n"))
    reading = Imports(stub.source, readers, search, Reading())
    homes = imports or tuple(dict.fromkeys(home for type_ in (holder, wire) if (home := _home(reading, type_, readers)) is not None))
    mapping = parse(Source(NAME, "".join(f'import "{each}"\n' for each in homes) + stub.source.text))
    problems: list[Diagnostic] = []
    imported = read_imports(mapping, reading, problems)
    declared = annotated(merge(imported, problems), [file for each in imported for file in each.units], reading.has, problems)
    if problems:
        raise MappingError(tuple(problems))
    known = annotated(declared, _units(search), reading.has, [])
    sides = (
        with_units(*(leaves_of(_message(schema, name, (search, readers))) for schema in (declared, known)))
        for name in (mapping.holder_type, mapping.wire_type)
    )
    return Sides(_quoted(holder), _quoted(wire), homes, *sides)


def _home(reading: Imports, type_: str, readers: Readers) -> str | None:
    """The file that a type is declared in: of the wire's framework, if that is known, else of any."""
    likely = (each for each in readers.guesses(type_) if readers.encoding is not None and reading.search.find(each) is not None)
    return next(likely, None) or reading.home(type_)


def _quoted(name: str) -> str:
    return name if all(part.isidentifier() for part in name.replace("::", ".").replace("/", ".").split(".")) else f'"{name}"'


def _message(schema: Schema, name: str, where: tuple[SearchPath, Readers]) -> Message:
    alike = {known: each for known, each in schema.types.items() if isinstance(each, Struct) and same_name(known, name)}
    if not alike:
        search, readers = where
        raise MappingError((words.unknown_type(name, similar_types(name, readers, search) or tuple(schema.types)),))
    return Message(alike.get(name) or next(iter(alike.values())), schema)


def _units(search: SearchPath) -> list[UnitFile]:
    sources = [search.find(name) for name in UNITS]
    return [parse_units(each, []) for each in sources if each is not None]


def _problems(text: str, search: SearchPath, readers: Readers) -> tuple[Diagnostic, ...]:
    try:
        return check(_parsed(text), readers, search).warnings
    except MappingError as error:
        return error.diagnostics


def _parsed(text: str) -> Mapping:
    return parse(Source(NAME, text))


def _relation(problem: Diagnostic, text: str) -> str | None:
    """The relation that a report is about; None where it is about none of the draft's own."""
    if problem.span is None or problem.span.source.name != NAME:
        return None
    number, _ = problem.span.source.line_column(problem.span.start)
    line = text.splitlines()[number - 1].partition("   #")[0].strip()
    return line if "<->" in line else None


def worth_telling(problems: Sequence[Diagnostic]) -> tuple[Diagnostic, ...]:
    """What the checker says of a draft besides that it leaves something out."""
    return tuple(each for each in problems if each.severity == "error")
