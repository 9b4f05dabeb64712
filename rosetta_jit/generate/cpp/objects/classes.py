"""Classes of our own for the types of a schema, each before those that contain it."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.backends.printing import Namespace, class_name
from rosetta_jit.generate.c.constants import value_of
from rosetta_jit.generate.c.texts import comment
from rosetta_jit.generate.c.words import RESERVED, of_unit
from rosetta_jit.generate.constants import constants_of, number_of
from rosetta_jit.generate.cpp.objects.names import OWN_WORDS, member_names
from rosetta_jit.generate.inner_types import reached_types, said_of
from rosetta_jit.model.recursive_structs import recursive_structs
from rosetta_jit.model.types import (
    Array,
    Bool,
    Bytes,
    Enum,
    Field,
    Float,
    Int,
    Map,
    NamedConstant,
    Optional,
    Ref,
    String,
    Struct,
    Type,
    Union,
)

if TYPE_CHECKING:
    from rosetta_jit.generate.unit import Unit

_OF_KERNELS = {f"{role}_{what}" for role in ("decode", "encode", "size", "borrow") for what in ("message", "sites")}
_OF_SOURCES = {"failure", "fill", "gather", "measured", "reach", "report", "source", "state", "written"}
NOT_CLASSES = frozenset({"codec", "holder", "unknown_fields", "std", "rosetta_jit", "memory", *_OF_SOURCES, *_OF_KERNELS})
"""What no class may be called: what the header has besides, and the source, whose names stand in the same namespace."""


def names_of(unit: Unit) -> dict[str, str]:
    """The classes and enums of a unit by their names in the schema."""
    names = [*reached_types(unit)]
    simple = (re.split(r"[./:]+", name)[-1] for name in names)
    scope = Namespace(RESERVED | NOT_CLASSES | of_unit(unit.name, simple))
    return {name: class_name(scope, name) for name in names}


def classes(unit: Unit) -> str:
    """The definitions of all of them."""
    names, recursive = names_of(unit), recursive_structs(Ref(unit.type), unit.schema)
    ahead = [f"struct {names[name]};" for name in sorted(recursive)]
    texts: list[str] = ["\n".join(ahead) + "\n"] if ahead else []
    for name, identifier in names.items():
        declared = unit.schema.types[name]
        if isinstance(declared, Enum):
            texts.append(_enum(identifier, declared, unit.name))
        else:
            texts.append(_class(identifier, declared, names, recursive, unit.name))
    return "\n".join(texts)


def _enum(identifier: str, enum: Enum, unit: str) -> str:
    scope = Namespace(RESERVED | of_unit(unit, (name for name, _ in enum.values)))
    values = [f"    {scope.identifier(name)} = {value if value > -(2**31) else 'INT32_MIN'}," for name, value in enum.values]
    return "\n".join([comment(enum.name), f"enum class {identifier} : std::int32_t {{", *values, "};", ""])


def _class(identifier: str, struct: Struct, names: dict[str, str], recursive: frozenset[str], unit: str) -> str:
    members = member_names(struct, unit, identifier)
    scope = Namespace(RESERVED | OWN_WORDS | {identifier, *members} | of_unit(unit, (each.name for each in struct.constants)))
    constants = [(scope.identifier(each.name), each) for each in constants_of(struct)]
    cases = [
        [scope.identifier(f"{member}_is_{case.name}") for case in _cases(field.type)]
        for field, member in zip(struct.fields, members, strict=True)
    ]
    hidden = {*members, *(name for name, _ in constants), *(name for some in cases for name in some)}
    named = {name: f"::{unit}::{each}" if each in hidden else each for name, each in names.items()}
    lines = [comment(struct.name), f"struct {identifier} {{", *(_constant(*each) for each in constants)]
    for field, member, some in zip(struct.fields, members, cases, strict=True):
        lines += [f"    static constexpr std::size_t {name} = {number};" for number, name in enumerate(some, 1)]
        lines.append(f"    {_field(field, member, _type(field.type, named, recursive))}")
    if struct.option("unknown"):
        lines.append("    std::string unknown_fields; /* fields that the schema does not know, as they came */")
    return "\n".join([*lines, "};", ""])


def _field(field: Field, member: str, kind: str) -> str:
    is_bare = isinstance(field.type, Bool | Int | Float | Ref) or kind.startswith("std::array")
    zero = "{}" if is_bare and not kind.startswith("std::unique") else ""
    said = said_of(field)
    return f"{kind} {member}{zero};{f' {comment(said)}' if said else ''}"


def _cases(type_: Type) -> tuple[Field, ...]:
    """Those of a union, or of the unions that an array has; what index each has in its variant is a constant of the class."""
    match type_:
        case Union(_, cases):
            return cases
        case Array(inner) | Optional(inner):
            return _cases(inner)
        case _:
            return ()


def _constant(identifier: str, constant: NamedConstant) -> str:
    kind = "const char *" if isinstance(constant.type, String) else f"{_type(constant.type, {}, frozenset())} "
    value = value_of(constant) or _not_finite(kind.strip(), number_of(constant))
    return f"    static constexpr {kind}{identifier} = {value};{f' {comment(constant.doc)}' if constant.doc else ''}"


def _not_finite(type_: str, value: float) -> str:
    return f"{'-' if value < 0 else ''}std::numeric_limits<{type_}>::{'quiet_NaN' if math.isnan(value) else 'infinity'}()"


def _type(type_: Type, names: dict[str, str], recursive: frozenset[str]) -> str:
    """A type in C++."""
    match type_:
        case Bool():
            return "bool"
        case Int(bits, signed, _):
            return f"std::{'' if signed else 'u'}int{bits}_t"
        case Float(bits, _):
            return "float" if bits == 32 else "double"
        case String(encoding):
            return "std::u16string" if encoding == "utf-16" else "std::string"
        case Bytes(_, int(length)):
            return f"std::array<std::uint8_t, {length}>"
        case Bytes():
            return "std::vector<std::uint8_t>"
        case Array(element, int(length)):
            return f"std::array<{_type(element, names, frozenset())}, {length}>"
        case Array(element):
            return f"std::vector<{_type(element, names, frozenset())}>"
        case Map(key, value):
            return f"std::map<{_type(key, names, frozenset())}, {_type(value, names, frozenset())}>"
        case Optional(Ref(name)) | Ref(name) if name in recursive:
            return f"std::unique_ptr<{names[name]}>"
        case Optional(value):
            return f"std::optional<{_type(value, names, recursive)}>"
        case Ref(name):
            return names[name]
        case Union(_, cases):
            return f"std::variant<{', '.join(['std::monostate', *(_type(each.type, names, recursive) for each in cases)])}>"
        case Enum() | Struct():
            raise AssertionError(type_)
        case _:
            assert_never(type_)
