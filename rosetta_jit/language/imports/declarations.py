"""What the imports of a mapping declare: types of all frameworks, and units for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import mapping as words
from rosetta_jit.catalogue import suggestions
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import MappingError, ReportError
from rosetta_jit.language.imports.mappings import MAPPING_SUFFIX
from rosetta_jit.model.mapping import Import, Mapping
from rosetta_jit.model.types import Array, Declaration, Enum, Map, NamedConstant, Optional, Ref, Schema, Struct, Type, Union
from rosetta_jit.parsing.idl import FrontEnds
from rosetta_jit.parsing.search import UNITS_SUFFIX, Reading, SearchPath, refusal
from rosetta_jit.source import Source
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language.parse import unit_file
    from rosetta_jit.language.parse.unit_file import UnitFile
else:
    unit_file = Late("rosetta_jit.language.parse.unit_file")


@dataclass(frozen=True, slots=True)
class Imported:
    """What one import declares, or says of units."""

    statement: Import
    schema: Schema
    units: tuple[UnitFile, ...] = ()


@dataclass(frozen=True, slots=True)
class Imports:
    """How the imports of one source are read."""

    importer: Source
    front_ends: FrontEnds
    search: SearchPath
    reading: Reading

    def has(self, type_: str) -> bool:
        """Whether there is a file that a type of this name is likely declared in."""
        return self.home(type_) is not None

    def home(self, type_: str) -> str | None:
        """That file, as an import names it."""
        names = (name for name in self.front_ends.homes(type_) if not refusal(name))
        return next((name for name in names if self.search.find(name, self.importer) is not None), None)

    def file(self, name: str) -> str:
        """The file that is imported by a name: its own, or that of a type which it declares."""
        is_file = self.front_ends.find(name) is not None or name.endswith(UNITS_SUFFIX)
        if is_file or (not refusal(name) and self.search.find(name, self.importer) is not None):
            return name
        return self.home(name) or name

    def read(self, statement: Import) -> Imported | Diagnostic:
        source = self.search.loader(self.reading, self.importer)(self.file(statement.path))
        if source is None:
            near = suggestions.closest(statement.path, self.search.alike(statement.path))
            return words.import_not_found(statement.span, statement.path, map(str, self.search.folders), near)
        if source.name.endswith(UNITS_SUFFIX):
            problems: list[Diagnostic] = []
            units = unit_file.parse(source, problems)
            if problems:
                raise MappingError(tuple(problems))
            return Imported(statement, Schema({}), (units,))
        front_end = self.front_ends.find(source.name)
        if front_end is None:
            return words.import_suffix(statement.span, statement.path, self.front_ends.suffixes)
        return Imported(statement, front_end(source, self.search.loader(self.reading, source)))


def read_imports(mapping: Mapping, imports: Imports, problems: list[Diagnostic]) -> list[Imported]:
    """All that could be read; what could not is reported at the statement."""
    imported: list[Imported] = []
    seen: set[str] = set()
    for statement in mapping.imports:
        if statement.path.endswith(MAPPING_SUFFIX):
            continue
        if statement.path in seen:
            problems.append(words.import_repeated(statement.span, statement.path))
            continue
        seen.add(statement.path)
        try:
            found = imports.read(statement)
        except ReportError as error:
            problems.extend(words.placed(problem, statement.span) for problem in error.diagnostics)
            continue
        if isinstance(found, Imported):
            imported.append(found)
        else:
            problems.append(found)
    return imported


def merge(imported: list[Imported], problems: list[Diagnostic]) -> Schema:
    """The types and constants of all imports; two of one name are reported."""
    types: dict[str, Declaration] = {}
    constants: dict[str, NamedConstant] = {}
    owners: dict[str, str] = {}
    for one in imported:
        differing = [name for name, each in one.schema.types.items() if types.setdefault(name, each) != each]
        differing += [name for name, each in one.schema.constants.items() if constants.setdefault(name, each) != each]
        problems += [words.conflicting_type(one.statement.span, name, owners[name], one.statement.path) for name in differing]
        for name in (*one.schema.types, *one.schema.constants):
            owners.setdefault(name, one.statement.path)
    return Schema(types, tuple(dict.fromkeys(source for one in imported for source in one.schema.sources)), constants)


def reached(root: Struct, schema: Schema) -> set[str]:
    """The names of a message's type and of all types within it."""
    names: set[str] = set()
    pending: list[Type] = [root]
    while pending:
        match pending.pop():
            case Struct(name, fields) | Union(name, fields) if name not in names:
                names.add(name)
                pending += [field.type for field in fields]
            case Enum(name):
                names.add(name)
            case Ref(name) if name not in names:
                pending.append(schema.types[name])
            case Array(inner) | Optional(inner):
                pending.append(inner)
            case Map(key, value):
                pending += [key, value]
            case _:
                pass
    return names
