"""Dataclasses for the types of a schema."""

from __future__ import annotations

import builtins
import keyword
import math
import re
import sys
from collections.abc import Collection, Mapping
from typing import assert_never

from rosetta_jit.backends.printing import Namespace, class_name
from rosetta_jit.generate.constants import constants_of
from rosetta_jit.generate.inner_types import reached_types, said_of
from rosetta_jit.generate.unit import Unit, wire_of
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Array, Bool, Bytes, Constant, Enum, Float, Int, Map, Optional, Ref, String, Struct, Type, Union

WORDS = frozenset(
    (
        *keyword.kwlist,
        *dir(builtins),
        "data",
        "end",
        "most",
        "sites",
        "indices",
        "index",
        "math",
        "array",
        "self",
        "target",
        "parts",
        "functions",
        "now",
        "copy",
        "np",
        "made",
        "each",
        "lacks",
    )
) | {f"call_{what}" for what in ("now", "number", "registers", "end", "copy", "into")}
"""What no class and no variable may be called: what functions are given, and what they need."""

OWN = """dataclass field Struct Any Callable c_float decode encode size reset Refused MessageError DecodeError EncodeError npt"""
TAKEN = WORDS.union(OWN.split())
"""What no class may be called: what the module defines and imports besides."""
MEMBERS = frozenset((*keyword.kwlist, "unknown_fields", "field", "_builtins"))
TYPES = frozenset(("bool", "int", "float", "str", "bytes", "list", "dict", "tuple"))
"""Python's own names that classes use for types and values, where a field may have such a name."""
MAX_DOC = 200
NOT_MODULES = frozenset((*keyword.kwlist, *sys.stdlib_module_names))
"""What no unit may be called: it could not be imported, or others could not."""


NUMPY = {
    "bool": ("bool_", "u1"),
    "i8": ("int8", "i1"),
    "u8": ("uint8", "u1"),
    "i16": ("int16", "i2"),
    "u16": ("uint16", "u2"),
    "i32": ("int32", "i4"),
    "u32": ("uint32", "u4"),
    "i64": ("int64", "i8"),
    "u64": ("uint64", "u8"),
    "f32": ("float32", "f4"),
    "f64": ("float64", "f8"),
}
"""What numpy calls scalars, and how it abbreviates them on the wire."""


def names_of(unit: Unit) -> dict[str, str]:
    """The classes by the types' names in the schema."""
    of_wires = (f"{verb}_{wire_of(role)}" for role in unit.kernels if wire_of(role) for verb in ("decode", "age"))
    scope, found = Namespace(TAKEN.union(of_wires)), dict[str, str]()
    for name in reached_types(unit):
        found[name] = class_name(scope, name)
    return found


def member_names(struct: Struct) -> tuple[str, ...]:
    """The attributes of a struct's fields, in order."""
    scope = Namespace(MEMBERS)
    return tuple(scope.identifier(each.name) for each in struct.fields)


def classes(unit: Unit) -> str:
    """Their definitions, each before those that contain it."""
    names = names_of(unit)
    texts: list[str] = []
    for number, (name, identifier) in enumerate(names.items()):
        declared, before = unit.schema.types[name], frozenset([*names.values()][:number])
        texts.append(_enum(identifier, declared) if isinstance(declared, Enum) else _class(identifier, declared, names, unit, before))
    return "\n\n".join(texts)


def numpy_scalar(element: Type, unit: Unit) -> str | None:
    """What numpy calls the elements of an array, where arrays of such are numpy's."""
    if not unit.numpy:
        return None
    match unit.schema.resolve(element):
        case Bool() | Int() | Float() | Enum() as number:
            return NUMPY[scalar_of(number)][0]
        case _:
            return None


def _enum(identifier: str, enum: Enum) -> str:
    scope = Namespace(frozenset(keyword.kwlist))
    values = [f"    {scope.identifier(name)} = {value}" for name, value in enum.values] or ["    pass"]
    return "\n".join([f"class {identifier}:", f"    {_doc(f'Values of {enum.name}.')}", "", *values, ""])


def _doc(text: str) -> str:
    """A docstring of one line, whatever a schema says."""
    plain = ascii(" ".join(text.split())[:MAX_DOC])[1:-1].replace("\\'", "'").replace("\\", "/").replace('"', "'")
    return f'"""{plain}"""'


def _class(identifier: str, struct: Struct, names: dict[str, str], unit: Unit, before: frozenset[str]) -> str:
    """The dataclass of a struct; ``before`` are the classes that stand before it."""
    head = ["@dataclass(slots=True)", f"class {identifier}:"]
    head = ["@dataclass(slots=True, eq=False)", f"class {identifier}(_Comparable):"] if unit.numpy else head
    lines = [*head, f"    {_doc(f'{struct.name}. {struct.doc}'.rstrip('. ') + '.')}", ""]
    members = member_names(struct)
    scope = Namespace(MEMBERS.union(members))
    constants = {scope.identifier(each.name): each for each in constants_of(struct)}
    for name, constant in constants.items():
        lines.append(f"    {name} = {_literal(constant.value)}")
        lines += [f"    {_doc(constant.doc)}"] if constant.doc else []
    seen = before.difference(members, constants)
    for each, member in zip(struct.fields, members, strict=True):
        default = _default(each.type, names, unit, seen)
        lines.append(f"    {member}: {_beside(members, f'{_type(each.type, names, unit)} = {default}')}")
        said = said_of(each)
        lines += [f"    {_doc(said)}"] if said else []
    if struct.option("unknown"):
        declared = _beside(members, 'bytes = b""')
        lines += [f"    unknown_fields: {declared}", '    """Fields that the schema does not know, as they came."""']
    return "\n".join([*lines, ""])


def _literal(value: Constant) -> str:
    """Whatever a schema says; a text as ASCII."""
    if isinstance(value, float) and not math.isfinite(value):
        return "math.nan" if math.isnan(value) else "math.inf" if value > 0 else "-math.inf"
    return ascii(value)


def _beside(members: Collection[str], text: str) -> str:
    """What a field is declared as, in a class of which some fields may have the names of Python's types."""
    hidden = "|".join(sorted(TYPES.intersection(members)))
    return re.sub(rf"(?<![\w.])(?:{hidden})\b", r"_builtins.\g<0>", text) if hidden else text


def _type(type_: Type, names: dict[str, str], unit: Unit, *, inside: bool = False) -> str:
    match type_:
        case Bool():
            return "bool"
        case Int():
            return "int"
        case Float():
            return "float"
        case String():
            return "str"
        case Bytes():
            return "bytes"
        case Array(element) if (scalar := numpy_scalar(element, unit)) is not None:
            return f"npt.NDArray[np.{scalar}]"
        case Array(element):
            return f"list[{_type(element, names, unit, inside=True)}]"
        case Map(key, value):
            return f"dict[{_type(key, names, unit)}, {_type(value, names, unit, inside=True)}]"
        case Optional(value):
            return f"{_type(value, names, unit, inside=True)} | None"
        case Ref(name):
            if isinstance(unit.schema.types[name], Enum):
                return "int"
            return f"{names[name]} | None" if name in {struct for _, struct in unit.layout.recursive} and not inside else names[name]
        case Union():
            return "tuple[str, Any] | None"
        case Enum() | Struct():
            raise AssertionError(type_)
        case _:
            assert_never(type_)


def _default(type_: Type, names: dict[str, str], unit: Unit, seen: Collection[str]) -> str:
    """What the field of a dataclass says of its first value: objects that can change are made for each.

    It makes an object of a class that can be ``seen`` there without a function in between.
    """
    value = first_value(type_, names, unit)
    if value in FACTORIES:
        return f"field(default_factory={FACTORIES[value]})"
    if isinstance(type_, Ref) and value == f"{names[type_.name]}()" and names[type_.name] in seen:
        return f"field(default_factory={names[type_.name]})"
    return value if _is_shared(type_, value) else f"field(default_factory=lambda: {value})"


def _is_shared(type_: Type, value: str) -> bool:
    """Whether a first value may be one object for all: it cannot change."""
    return value in ("0", "None") or not isinstance(type_, Array | Map | Ref)


FACTORIES = {"[]": "list", "{}": "dict"}


def first_value(type_: Type, names: Mapping[str, str], unit: Unit, *, inside: bool = False) -> str:
    """An expression for the value that a field has before anything sets it, or that an element ``inside`` a first value has."""
    match type_:
        case Bool():
            return "False"
        case Int():
            return "0"
        case Float():
            return "0.0"
        case String():
            return '""'
        case Bytes(_, int(length)):
            return f"bytes({length})"
        case Bytes():
            return 'b""'
        case Array(element, length) if (scalar := numpy_scalar(element, unit)) is not None:
            return f"np.zeros({length if isinstance(length, int) else 0}, np.{scalar})"
        case Array(element, int(length)) if length:
            first = first_value(element, names, unit, inside=True)
            return f"[{first}] * {length}" if _is_shared(element, first) else f"[{first} for _ in range({length})]"
        case Array():
            return "[]"
        case Map():
            return "{}"
        case Optional() | Union():
            return "None"
        case Ref(name):
            if isinstance(unit.schema.types[name], Enum):
                return "0"
            return "None" if not inside and name in {struct for _, struct in unit.layout.recursive} else f"{names[name]}()"
        case Enum() | Struct():
            raise AssertionError(type_)
        case _:
            assert_never(type_)
