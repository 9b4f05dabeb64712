"""The model of definitions. Defaults of an array are its field's option ``default``, a list in JSON; those of bytes are bytes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.ros import tree
from rosetta_jit.frameworks.ros.dialect import Dialect
from rosetta_jit.frameworks.ros.gather import Gathered, gather
from rosetta_jit.frameworks.ros.limits import MAX_PROBLEMS
from rosetta_jit.frameworks.ros.names import declared_in
from rosetta_jit.frameworks.ros.reading import read, unit_in
from rosetta_jit.frameworks.ros.sections import sections
from rosetta_jit.model.types import Array, Bytes, Constant, Field, NamedConstant, Optional, Ref, Schema, String, Struct, Type
from rosetta_jit.parsing.idl import Load, refuse
from rosetta_jit.source import Source
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    Options = tuple[tuple[str, Constant], ...]


def gathered(source: Source, load: Load, dialect: Dialect) -> Gathered:
    """The definitions of a source and of all that it needs; raises SchemaError with everything that is wrong in any of the texts."""
    problems: list[Diagnostic] = []
    found = gather(source, load, dialect, problems)
    refuse(problems, MAX_PROBLEMS)
    return found


def definition_of(source: Source, dialect: Dialect) -> tree.Definition:
    """The first definition of a message's file, by itself; raises SchemaError with everything that is wrong in it."""
    problems: list[Diagnostic] = []
    found = sections(source, declared_in(source.name, dialect), dialect, problems)
    definitions = [read(each, dialect, problems) for each in found[:1]]
    refuse(problems, MAX_PROBLEMS)
    return definitions[0]


def schema_of(
    definitions: Iterable[tree.Definition], dialect: Dialect, options: Callable[[tree.Definition], Options] = lambda _: ()
) -> Schema:
    """The schema of definitions, each with the options that are computed from it."""
    definitions = tuple(definitions)
    words = {each.type.base for definition in definitions for each in definition.fields}
    structs = {name: struct for name, struct in dialect.structs.items() if name in words}
    messages = {each.name: _struct(each, dialect, options(each)) for each in reversed(definitions)}
    sources = dict.fromkeys(each.source.name for each in reversed(definitions))
    return Schema(MappingProxyType(messages | structs), tuple(sources))


def _struct(definition: tree.Definition, dialect: Dialect, options: Options) -> Struct:
    fields = tuple(_field(each, dialect) for each in definition.fields) or dialect.empty
    constants = tuple(NamedConstant(each.name.text, dialect.scalars[each.type.base], each.value, each.doc) for each in definition.constants)
    return Struct(definition.name, fields, definition.doc, span=definition.span, constants=constants, options=options)


def _field(field: tree.Field, dialect: Dialect) -> Field:
    type_ = _type(field.type, dialect)
    default, options = _default(field.default, type_)
    wrapped = Optional(type_) if field.optional else type_
    unit = unit_in(field.doc) if dialect.extended else None
    return Field(field.name.text, wrapped, unit=unit, default=default, options=options, doc=field.doc, span=field.name.span)


def _default(default: Constant | tree.Values | None, type_: Type) -> tuple[Constant | None, Options]:
    if not isinstance(default, tuple):
        return default, ()
    if isinstance(type_, Bytes):
        return bytes(int(each) for each in default), ()
    import json  # few fields have defaults of several values

    return None, (("default", json.dumps(default)),)


def _type(name: tree.TypeName, dialect: Dialect) -> Type:
    element = _element(name, dialect.scalars)
    if not name.array:
        return element
    if name.base in dialect.octets:
        return Bytes(name.base, name.length, name.maximum)
    return Array(element, name.length, name.maximum)


def _element(name: tree.TypeName, scalars: Mapping[str, Type]) -> Type:
    scalar = scalars.get(name.base)
    if scalar is None:
        return Ref(name.base, name.span)
    return replace(scalar, maximum=name.text_maximum) if isinstance(scalar, String) else scalar
