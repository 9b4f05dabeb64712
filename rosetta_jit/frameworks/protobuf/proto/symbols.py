"""What every name of a set of files stands for, and how a name is looked up from a place.

Protobuf's rule is that of C++: the innermost scope first, and the first part of `a.b.c` decides.
https://protobuf.dev/programming-guides/proto2/#name-resolution
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Literal, assert_never, get_args

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import diagnostics as say
from rosetta_jit.frameworks.protobuf import file_diagnostics as of_file
from rosetta_jit.frameworks.protobuf.limits import MAX_NAME, MAX_REPORTED
from rosetta_jit.frameworks.protobuf.proto.tree import Enum, Extend, Field, File, MapType, Message, Name, Oneof
from rosetta_jit.parsing.idl import refuse
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.frameworks.protobuf.proto.file_set import FileSet

Kind = Literal["package", "message", "enum", "value", "field", "oneof", "extension", "service", "method"]

TYPES: frozenset[Kind] = frozenset(("message", "enum"))
ALL_KINDS: frozenset[Kind] = frozenset(get_args(Kind))
SCOPES: frozenset[Kind] = frozenset(("package", "message", "enum", "service"))


@dataclass(frozen=True, slots=True)
class Symbol:
    """One thing that has a name. A package belongs to every file that names it."""

    kind: Kind
    files: frozenset[str]
    name: Name


@dataclass(frozen=True, slots=True)
class Symbols:
    """All names, absolute and without a leading dot, and the files that each file can see, and can see in its options."""

    table: Mapping[str, Symbol]
    visible: Mapping[str, frozenset[str]]
    visible_in_options: Mapping[str, frozenset[str]]

    def seen(self, files: frozenset[str], full: str) -> Symbol | None:
        """The symbol of an absolute name, where one of some files has it."""
        symbol = self.table.get(full)
        return symbol if symbol and not symbol.files.isdisjoint(files) else None

    def find(self, files: frozenset[str], scope: str, name: str, kinds: frozenset[Kind]) -> str | None:
        """The absolute name that ``name`` means in a scope; of what has a simple name, only ``kinds`` count."""
        if name.startswith("."):
            return name[1:] if self.seen(files, name[1:]) else None
        outer = self.scope_of(files, scope, name, kinds)
        full = join(outer, name) if outer is not None else ""
        return full if self.seen(files, full) else None

    def scope_of(self, files: frozenset[str], scope: str, name: str, kinds: frozenset[Kind]) -> str | None:
        """The innermost scope that knows the first part of a name: there the name is looked up, and nowhere else."""
        first, dot, _ = name.partition(".")
        wanted = SCOPES if dot else kinds
        while True:
            symbol = self.seen(files, join(scope, first))
            if symbol and symbol.kind in wanted:
                return scope
            if not scope:
                return None
            scope = scope.rpartition(".")[0]


def declare(files: FileSet, problems: list[Diagnostic]) -> Symbols:
    """Collect the names of all files; what has the name of something else is a problem.

    Raises
    ------
    SchemaError
        At the first name that is too long: many of those could fill the memory.
    """
    table: dict[str, Symbol] = {}
    for file in files.files:
        for full, symbol in _symbols(file):
            if len(full) > MAX_NAME:
                refuse([*problems, of_file.name_too_long(symbol.name.span, MAX_NAME)], MAX_REPORTED)
            old = table.get(full)
            if old is None:
                table[full] = symbol
            elif old.kind == symbol.kind == "package":
                table[full] = Symbol("package", old.files | symbol.files, old.name)
            elif len(problems) < MAX_REPORTED:
                problems.append(say.repeated_name(symbol.name, full, old.kind, old.name.span))
    names = [file.name for file in files.files]
    return Symbols(
        table, {name: files.visible_from(name) for name in names}, {name: files.visible_from(name, in_options=True) for name in names}
    )


def join(scope: str, name: str) -> str:
    """A name within a scope; the scope of everything is empty."""
    return f"{scope}.{name}" if scope else name


def package_of(file: File) -> str:
    """The scope of what stands at the top of a file."""
    return file.package.text if file.package else ""


def messages_of(file: File) -> Iterator[tuple[str, Message]]:
    """Every message of a file with its absolute name, outer ones first."""
    for message in file.messages:
        yield from _nested(package_of(file), message)


def enums_of(file: File) -> Iterator[tuple[str, Enum]]:
    """Every enum of a file with its absolute name."""
    for enum in file.enums:
        yield join(package_of(file), enum.name.text), enum
    for full, message in messages_of(file):
        for enum in message.enums:
            yield join(full, enum.name.text), enum


def extends_of(file: File) -> Iterator[tuple[str, Extend]]:
    """Every extend block of a file with the scope that it stands in."""
    for extend in file.extends:
        yield package_of(file), extend
    for full, message in messages_of(file):
        for extend in message.extends:
            yield full, extend


def fields_of(message: Message) -> Iterator[Field]:
    """The fields of a message, those in oneofs included."""
    for member in message.members:
        match member:
            case Oneof():
                yield from member.fields
            case Field():
                yield member


def entry_name(field: str) -> str:
    """The name of the message that stands for the entries of a map field: `word_count` has `WordCountEntry`."""
    return "".join(part[:1].upper() + part[1:] for part in field.split("_")) + "Entry"


def _nested(scope: str, message: Message) -> Iterator[tuple[str, Message]]:
    full = join(scope, message.name.text)
    yield full, message
    for inner in message.messages:
        yield from _nested(full, inner)


def _symbols(file: File) -> Iterator[tuple[str, Symbol]]:
    files = frozenset((file.name,))
    package = package_of(file)
    parts = package.split(".") if package else []
    for count in range(len(parts)):
        yield ".".join(parts[: count + 1]), Symbol("package", files, file.package or Name(""))
    for full, message in messages_of(file):
        yield full, Symbol("message", files, message.name)
        yield from _members(full, message, files)
    for full, enum in enums_of(file):
        # The values of an enum stand beside it, not in it: so it is in C++.
        scope = full.rpartition(".")[0]
        yield full, Symbol("enum", files, enum.name)
        for value in enum.values:
            yield join(scope, value.name.text), Symbol("value", files, value.name)
    for scope, extend in extends_of(file):
        for field in extend.fields:
            yield join(scope, field.name.text), Symbol("extension", files, field.name)
    for service in file.services:
        full = join(package, service.name.text)
        yield full, Symbol("service", files, service.name)
        for method in service.methods:
            yield join(full, method.name.text), Symbol("method", files, method.name)


def _members(scope: str, message: Message, files: frozenset[str]) -> Iterator[tuple[str, Symbol]]:
    for member in message.members:
        match member:
            case Oneof(name, fields):
                yield join(scope, name.text), Symbol("oneof", files, name)
            case Field():
                fields = (member,)
            case _:
                assert_never(member)
        for field in fields:
            yield join(scope, field.name.text), Symbol("field", files, field.name)
            if isinstance(field.type, MapType):
                entry = entry_name(field.name.text)
                yield join(scope, entry), Symbol("field", files, Name(entry, field.name.span))
