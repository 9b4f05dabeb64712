"""Constants that mappings can name: those of enums, of messages and of modules.

A constant has a full name, within what declares it, and other ones:

    lab.Command.Mode.IDLE    lab.Command.IDLE              of an enum: also beside it, as protobuf and OMG IDL scope it
    lab/msg/Goal.ACTIVE      lab/Goal.ACTIVE, Goal.ACTIVE  of a message: by any name of the type, and by its last part
    RTC::MAX_SPEED                                         of a module

A name that is not full is ambiguous where it stands for constants of several values.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping

from rosetta_jit.language.conversions import FLOAT64, holds, in_single, is_single
from rosetta_jit.language.typed import INT64, Const
from rosetta_jit.model.types import Bool, Constant, Enum, Float, Int, Schema, String, Struct, Type, name_parts
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass

LAST = r"(?:\.|::)(?=\w+$)"
"""What stands before the last part of a constant's name."""


@dataclass(frozen=True, slots=True)
class Named:
    """A constant: its full name, its type and value, and the name of the declaration that it came with."""

    name: str
    type: Type
    value: bool | int | float | str
    home: str

    def typed(self, span: Span | None) -> Const:
        """The constant as an expression: as if its value stood there, with the type that it is declared with."""
        return Const(self.value, self.type, span) if isinstance(self.type, Enum) else constant_of(self.value, self.type, span)


@dataclass(frozen=True, slots=True)
class Constants:
    """All constants by full name, and by the parts of their other names."""

    full: Mapping[str, Named]
    other: Mapping[tuple[str, ...], tuple[Named, ...]]

    def find(self, name: str) -> tuple[Named, ...]:
        """The constant of a name: several where it is ambiguous, none where there is none."""
        if name in self.full:
            return (self.full[name],)
        *owner, last = re.split(LAST, name)
        return self.other.get((*name_parts("".join(owner)), last), ())


def constant_of(value: bool | int | float | str, declared: Type | None, span: Span | None) -> Const:
    """A value that is written down, or that is given with the type ``declared`` for it."""
    match value:
        case bool():
            return Const(value, Bool(), span)
        case int():
            return Const(value, Int(64, signed=holds(INT64, value)), span, declared=declared is not None)
        case float() if declared is not None and is_single(declared):
            single = Const(value, Float(32), span, declared=True)
            return in_single(single) or single
        case float():
            return Const(value, FLOAT64, span, declared=declared is not None)
        case str():
            return Const(value, String(), span)


def constants_of(*schemas: Schema) -> Constants:
    """The constants that schemas declare."""
    enums = [each for schema in schemas for each in schema.types.values() if isinstance(each, Enum)]
    declared = {each.name: each for schema in schemas for each in _declared(schema)}
    other: dict[tuple[str, ...], dict[tuple[Type, Constant], Named]] = defaultdict(dict)
    for each in declared.values():
        *owner, last = re.split(LAST, each.name)
        parts = (*name_parts("".join(owner)), last)
        for names in {parts, parts[-2:]}:
            other[names].setdefault((each.type, each.value), each)
    found = {names: tuple(several.values()) for names, several in other.items()}
    return Constants({**_of_enums(enums), **declared}, found)


def _of_enums(enums: list[Enum]) -> dict[str, Named]:
    """The constants of enums: within their enum and, as protobuf and OMG IDL scope them, beside it."""
    beside: dict[str, Named] = {}
    within: dict[str, Named] = {}
    for enum in enums:
        around = enum.name[: len(enum.name) - len(re.split(LAST, enum.name)[-1])]
        for value, number in enum.values:
            known = Named(f"{enum.name}.{value}", enum, number, enum.name)
            beside[around + value] = within[known.name] = known
            if "::" in enum.name:
                within[f"{enum.name}::{value}"] = known
    return beside | within


def _declared(schema: Schema) -> Iterator[Named]:
    """The constants of messages and of modules; bytes have no form in a mapping."""
    for struct in schema.types.values():
        if isinstance(struct, Struct):
            mark = "::" if "::" in struct.name else "."
            for each in struct.constants:
                if not isinstance(each.value, bytes):
                    yield Named(f"{struct.name}{mark}{each.name}", schema.resolve(each.type), each.value, struct.name)
    for name, each in schema.constants.items():
        if not isinstance(each.value, bytes):
            yield Named(name, schema.resolve(each.type), each.value, name)
