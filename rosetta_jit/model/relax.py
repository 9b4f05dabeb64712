"""Types that promise less than their IDL does, for peers who do not keep what it promises."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.model.types import Array, Map, Optional, String, Struct, Union

if TYPE_CHECKING:
    from rosetta_jit.model.types import Declaration, Schema, Type


def without_text(schema: Schema) -> Schema:
    """The schema with strings of octets in place of UTF-8."""
    return replace(schema, types={name: _declaration(each) for name, each in schema.types.items()})


def _declaration(declared: Declaration) -> Declaration:
    if not isinstance(declared, Struct):
        return declared
    return replace(declared, fields=tuple(replace(each, type=_type(each.type)) for each in declared.fields))


def _type(type_: Type) -> Type:
    match type_:
        case String("utf-8"):
            return replace(type_, encoding="octets")
        case Array(element):
            return replace(type_, element=_type(element))
        case Optional(value):
            return Optional(_type(value))
        case Map(key, value):
            return replace(type_, key=_type(key), value=_type(value))
        case Union(_, cases):
            return replace(type_, cases=tuple(replace(each, type=_type(each.type)) for each in cases))
        case _:
            return type_
