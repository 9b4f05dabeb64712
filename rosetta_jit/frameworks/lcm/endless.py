"""Structs that contain themselves in every value, so that none ends: the way back leads through no array that could be empty."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.frameworks.lcm import diagnostics as say
from rosetta_jit.model.types import Array, Ref, Struct

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.model.types import Field, Schema, Type


def check_endless(schema: Schema, problems: list[Diagnostic]) -> None:
    """Report every field that closes such a circle."""
    done: set[str] = set()
    for name in schema.types:
        if name not in done:
            _visit(name, schema, done, problems)


def _visit(start: str, schema: Schema, done: set[str], problems: list[Diagnostic]) -> None:
    """Depth first; a field that leads to a struct which is still open closes a circle."""
    open_ = {start: _always(schema, start)}
    while open_:
        name, fields = next(reversed(open_.items()))
        each = next(fields, None)
        if each is None:
            done.add(name)
            del open_[name]
            continue
        field, target = each
        if target in open_:
            problems.append(say.endless(field.name, field.span, target))
        elif target not in done:
            open_[target] = _always(schema, target)


def _always(schema: Schema, name: str) -> Iterator[tuple[Field, str]]:
    """The structs that are in every value of a struct, and the fields which they are in."""
    declared = schema.types.get(name)
    fields = declared.fields if isinstance(declared, Struct) else ()
    return ((field, target) for field in fields if (target := _inside(field.type)) is not None)


def _inside(type_: Type) -> str | None:
    while isinstance(type_, Array) and isinstance(type_.length, int) and type_.length:
        type_ = type_.element
    return type_.name if isinstance(type_, Ref) else None
