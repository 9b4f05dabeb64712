"""The types within a message, each of which a language has to call something, and what their schema says of their fields.

Also those that a schema declares within a field, without a name, as YARP's bottles within lists.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from typing import TYPE_CHECKING

from rosetta_jit.generate.constants import modules_around
from rosetta_jit.model.types import Array, Declaration, Enum, Field, Map, Optional, Ref, Schema, Struct, Type, Union
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.generate.unit import Unit


def with_inner_types(schema: Schema, name: str) -> Schema:
    """A schema in which what is within the type of that name, and those in it, has a name, too: fields refer to it.

    Modules around them that have constants are structs.
    """
    found = _Names(schema)
    found.declared(name)
    named = replace(schema, types=found.types)
    return replace(named, types={**modules_around(named, _reached(named, name)), **found.types})


class _Names:
    """Gives names; ``seen`` are the declared types that are done."""

    def __init__(self, schema: Schema) -> None:
        self.types: dict[str, Declaration] = dict(schema.types)
        self.seen = set[str]()

    def declared(self, name: str) -> None:
        if name in self.seen:
            return
        self.seen.add(name)
        declared = self.types[name]
        if isinstance(declared, Struct):
            self.types[name] = replace(declared, fields=tuple(map(self._field, declared.fields)))

    def _field(self, field: Field) -> Field:
        type_ = self._type(field.type)
        return field if type_ is field.type else replace(field, type=type_)

    def _type(self, type_: Type) -> Type:
        match type_:
            case Struct() | Enum():
                name = self._free(type_)
                self.types[name] = replace(type_, name=name)
                self.declared(name)
                return Ref(name)
            case Ref(name):
                self.declared(name)
                return type_
            case Array(element):
                inner = self._type(element)
                return type_ if inner is element else replace(type_, element=inner)
            case Optional(value):
                inner = self._type(value)
                return type_ if inner is value else replace(type_, value=inner)
            case Map(key, value):
                inner = self._type(value)
                return type_ if inner is value else replace(type_, key=key, value=inner)
            case Union():
                cases = tuple(map(self._field, type_.cases))
                return type_ if all(new is old for new, old in zip(cases, type_.cases, strict=True)) else replace(type_, cases=cases)
            case _:
                return type_

    def _free(self, type_: Struct | Enum) -> str:
        """Its own name, if nothing else has it."""
        if type_.name and self.types.get(type_.name, type_) == type_:
            return type_.name
        return next(name for number in count(2) if (name := f"{type_.name}_{number}") not in self.types)


def reached_types(unit: Unit) -> dict[str, None]:
    """The declared types that the message contains, each behind those that it contains itself, and the modules around them."""
    found = _reached(unit.schema, unit.type)
    return {**found, **dict.fromkeys(modules_around(unit.schema, found))}


def _reached(schema: Schema, type_: str) -> dict[str, None]:
    found: dict[str, None] = {}
    pending: list[tuple[str, bool]] = [(type_, False)]
    seen: set[str] = set()
    while pending:
        name, done = pending.pop()
        if done:
            found[name] = None
            continue
        if name in seen:
            continue
        seen.add(name)
        pending.append((name, True))
        declared = schema.types[name]
        inner = [each for field in declared.fields for each in _refs(field.type)] if isinstance(declared, Struct) else []
        pending += [(each, False) for each in reversed(inner)]
    return found


def said_of(field: Field) -> str:
    """A field's comment and its unit, as far as the schema has these."""
    return " ".join(part for part in (field.doc, f"[{field.unit}]" if field.unit else "") if part)


def said_of_fields(unit: Unit) -> dict[tuple[str, str], str]:
    """The same of all fields within the message, by the names of struct and field; of those of which there is something to say."""
    structs = (unit.schema.types[name] for name in reached_types(unit))
    fields = ((struct.name, field) for struct in structs if isinstance(struct, Struct) for field in struct.fields)
    return {(name, field.name): said for name, field in fields if (said := said_of(field))}


def _refs(type_: Type) -> Iterator[str]:
    match type_:
        case Ref(name):
            yield name
        case Array(element) | Optional(element):
            yield from _refs(element)
        case Map(key, value):
            yield from _refs(key)
            yield from _refs(value)
        case Union(_, cases) | Struct(_, cases):
            for each in cases:
                yield from _refs(each.type)
        case _:
            return
