"""The fields of a message, one a row, those of nested messages below theirs."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from rosetta_jit.explain.limits import MAX_FIELD_DEPTH, MAX_FIELDS
from rosetta_jit.language.places import shown_names
from rosetta_jit.language.scope import Message
from rosetta_jit.model.printer import show_expr, show_type, show_way
from rosetta_jit.model.types import Array, Field, Optional, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Row:
    """A field: its names from the message on, how mappings name it, its type, and what else its schema says."""

    names: tuple[str, ...]
    path: str
    type: str
    unit: str | None
    notes: tuple[str, ...]


def rows(message: Message) -> tuple[tuple[Row, ...], bool]:
    """The fields of a message, and whether there are more than are shown."""
    found = tuple(islice(_rows(message, message.root, (), (message.root.name,)), MAX_FIELDS + 1))
    return found[:MAX_FIELDS], len(found) > MAX_FIELDS


def _rows(message: Message, struct: Struct | Union, names: tuple[str, ...], around: tuple[str, ...]) -> Iterator[Row]:
    """Depth first; a type within itself is not opened again."""
    for field in struct.fields if isinstance(struct, Struct) else struct.cases:
        here = (*names, field.name)
        yield Row(here, shown_names(here, message), show_type(message.value_type(field.type)), field.unit, tuple(_notes(field, message)))
        inner = _inner(message, field.type)
        if isinstance(inner, Struct | Union) and inner.name not in around and len(here) < MAX_FIELD_DEPTH:
            yield from _rows(message, inner, here, (*around, inner.name))


def _inner(message: Message, type_: Type) -> Type:
    value = message.value_type(type_)
    return _inner(message, value.element) if isinstance(value, Array) else value


def _notes(field: Field, message: Message) -> Iterator[str]:
    if field.constant is not None:
        yield f"always {show_expr(field.constant)}"
    if field.length is not None:
        yield f"length {show_expr(field.length)}"
    if isinstance(message.schema.resolve(field.type), Optional):
        yield "required" if field.required else "may be absent"
    yield from (f"{show_way(path)} in {unit}" for path, unit in field.part_units)
    if field.default is not None:
        yield f"else {field.default!r}"
