"""Structures for the types of a schema, and not classes: `defstruct` alone keeps numbers unboxed, so that setting one allocates nothing."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.generate.cpp.classes import reached_types
from rosetta_jit.generate.lisp.lines import Lines
from rosetta_jit.generate.lisp.texts import doc
from rosetta_jit.generate.lisp.words import LISP_TYPES, Names, constants, hyphenated, runtime_names, symbols
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Map, Optional, Ref, String, Struct, Union
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rosetta_jit.generate.unit import Unit
    from rosetta_jit.model.types import Schema, Type

KERNELS = frozenset({"decode-kernel", "encode-kernel", "size-kernel", "unknown-fields", "forget-rows", "writer"})
UNKNOWN = "unknown fields"
"""Of the slot with fields that the schema does not know: no schema has a name with a space."""
ABSENT_BOOL = ":absent"
"""An optional bool that is not there: nil is false."""
EMPTY = "(no-octets)"


@dataclass(slots=True)
class Structures:
    """The symbols for the types of a unit, of their slots and enums, and of functions."""

    unit: Unit
    names: Names
    types: dict[str, str]
    recursive: frozenset[str]

    @property
    def schema(self) -> Schema:
        return self.unit.schema

    def slot(self, struct: Struct, field: str) -> str:
        """The slot of a field; its accessor is `TYPE-SLOT`."""
        name = self.types[struct.name]
        wanted = hyphenated(field)
        wanted = f"{wanted}-field" if wanted in constants() else wanted
        return self.names.symbol(f"{struct.name}\0{field}", f"{name}-{{}}", wanted=wanted)

    def accessor(self, struct: Struct, field: str, at: str = "object") -> str:
        """The place of a field of an object."""
        return f"({self.types[struct.name]}-{self.slot(struct, field)} {at})"

    def case(self, union: Union, name: str) -> str:
        """The keyword of a case."""
        scope = Names(frozenset())
        return next(f":{symbol}" for each in union.cases if (symbol := scope.symbol(each.name)) and each.name == name)

    def exported(self) -> list[str]:
        """What who uses the package needs, in order."""
        found: list[str] = []
        for name, symbol in self.types.items():
            declared = self.schema.types[name]
            if isinstance(declared, Enum):
                found += [constant for constant, _ in self.values(declared)]
                continue
            assert isinstance(declared, Struct)
            found += [symbol, f"make-{symbol}", *(f"{symbol}-{self.slot(declared, each)}" for each in _slots(declared))]
        return found

    def values(self, enum: Enum) -> list[tuple[str, int]]:
        """The constants of an enum."""
        scope = Names(frozenset())
        return [(f"+{self.types[enum.name]}.{scope.symbol(name)}+", value) for name, value in enum.values]


def _slots(struct: Struct) -> list[str]:
    return [*(each.name for each in struct.fields), *([UNKNOWN] if struct.option("unknown") else [])]


def structures_of(unit: Unit) -> Structures:
    """The symbols of a unit: none is another's, or one of the language, whatever the schema says (`Time` is `time-message`)."""
    names, types = Names(symbols() | runtime_names() | KERNELS), dict[str, str]()
    for name in reached_types(unit):
        simple = hyphenated(re.split(r"[./:]+", name)[-1])
        known = {simple, f"make-{simple}"} & names.reserved
        types[name] = names.symbol(name, "{}", "make-{}", wanted=f"{simple}-message" if known else simple)
    made = Structures(unit, names, types, frozenset(struct for _, struct in unit.layout.recursive))
    made.exported()
    return made


def definitions(structures: Structures) -> str:
    """The structures, each behind those that it contains."""
    lines = Lines()
    for name, symbol in structures.types.items():
        declared = structures.schema.types[name]
        if lines.lines:
            lines.line("")
        if isinstance(declared, Enum):
            for constant, value in structures.values(declared):
                lines.line(f"(defconstant {constant} {value})")
        else:
            assert isinstance(declared, Struct)
            _structure(lines, structures, symbol, declared)
    return lines.text()


def _structure(lines: Lines, structures: Structures, symbol: str, struct: Struct) -> None:
    with lines.form(f"(defstruct ({symbol} (:copier nil) (:predicate nil))"):
        lines.line(doc(f"{struct.name}. {struct.doc}".rstrip(". ") + "."))
        for each in struct.fields:
            said = " ".join(part for part in (each.doc, f"[{each.unit}]" if each.unit else "") if part)
            type_, value = slot_type(structures, each.type), default(structures, each.type)
            lines.line(f"({structures.slot(struct, each.name)} {value} :type {type_})", said)
        if struct.option("unknown"):
            lines.line(f"({structures.slot(struct, UNKNOWN)} {EMPTY} :type octets)", "fields that the schema does not know, as they came")


def slot_type(structures: Structures, type_: Type) -> str:
    """The type of a slot."""
    schema = structures.schema
    match type_:
        case Bool() | Int() | Float():
            return LISP_TYPES[scalar_of(type_)]
        case String():
            return "string"
        case Bytes(_, length):
            return f"(simple-array u8 ({length if isinstance(length, int) else '*'}))"
        case Array(element, length):
            return vector_type(structures, element, length if isinstance(length, int) else None)
        case Map():
            return "hash-table"
        case Optional(value) if isinstance(schema.resolve(value), Bool):
            return f"(member t nil {ABSENT_BOOL})"
        case Optional(value):
            return f"(or null {slot_type(structures, value)})"
        case Union():
            return "(or null (cons keyword t))"
        case Ref(name):
            if isinstance(schema.types[name], Enum):
                return "i32"
            return "(or null structure-object)" if name in structures.recursive else structures.types[name]
        case Enum() | Struct():
            raise AssertionError(type_)
        case _:
            assert_never(type_)


def vector_type(structures: Structures, element: Type, length: int | None) -> str:
    """Of an array: numbers lie in it unboxed."""
    resolved, many = structures.schema.resolve(element), "*" if length is None else length
    if isinstance(resolved, Int | Float | Enum):
        return f"(simple-array {LISP_TYPES[scalar_of(resolved)]} ({many}))"
    return "simple-vector" if length is None else f"(simple-vector {length})"


def default(structures: Structures, type_: Type) -> str:
    """The first value of a slot."""
    match structures.schema.resolve(type_):
        case Bool() | Union():
            return "nil"
        case Int() | Enum():
            return "0"
        case Float(bits):
            return "0d0" if bits == 64 else "0f0"
        case String():
            return '""'
        case Bytes(_, int(length)):
            return f"(make-array {length} :element-type 'u8)"
        case Bytes():
            return EMPTY
        case Array(element, length):
            return _vector(structures, element, length if isinstance(length, int) else 0)
        case Map():
            return "(make-hash-table :test 'equal)"
        case Optional(value):
            return ABSENT_BOOL if isinstance(structures.schema.resolve(value), Bool) else "nil"
        case Struct(name):
            return "nil" if name in structures.recursive else f"(make-{structures.types[name]})"
        case Ref():
            raise AssertionError(type_)


def _vector(structures: Structures, element: Type, length: int) -> str:
    resolved = structures.schema.resolve(element)
    if isinstance(resolved, Int | Float | Enum):
        return f"(make-array {length} :element-type '{LISP_TYPES[scalar_of(resolved)]})"
    if isinstance(resolved, Bool) or not length:
        return f"(make-array {length} :initial-element nil)"
    return f"(map-into (make-array {length}) (lambda () {_element(structures, element)}))"


def _element(structures: Structures, element: Type) -> str:
    """What is in an array of a fixed length at first: objects, of recursive types too."""
    resolved = structures.schema.resolve(element)
    return f"(make-{structures.types[resolved.name]})" if isinstance(resolved, Struct) else default(structures, element)


def wire_symbols(structures: Structures, wires: Iterable[str]) -> dict[str, str]:
    """What stands for wires in the symbols of their functions, as `decode-WIRE`."""
    taken = ("decode-{}", "age-{}", "decode-{}-kernel")
    return {each: structures.names.symbol(f"wire {each}", *taken, wanted=each) for each in wires}


def function_symbols(structures: Structures, functions: Iterable[str]) -> dict[str, str]:
    """The symbols of the mapping's functions."""
    return {each: structures.names.symbol(f"function {each}", wanted=each) for each in functions}
