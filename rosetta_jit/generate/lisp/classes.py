"""Classes for the types of a schema, and not classes: `defstruct` alone keeps numbers unboxed, so that setting one allocates nothing."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.generate.constants import constants_of, number_of, scalar_of_constant
from rosetta_jit.generate.inner_types import reached_types, said_of
from rosetta_jit.generate.lisp.expressions import constant as number
from rosetta_jit.generate.lisp.lines import Lines
from rosetta_jit.generate.lisp.texts import doc, literal
from rosetta_jit.generate.lisp.words import LISP_TYPES, Names, constants, hyphenated, runtime_names, symbols
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import (
    Array,
    Bool,
    Bytes,
    Declaration,
    Enum,
    Field,
    Float,
    Int,
    Map,
    NamedConstant,
    Optional,
    Ref,
    Schema,
    String,
    Struct,
    Type,
    Union,
)
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.generate.unit import Unit

KERNELS = frozenset({"decode-kernel", "encode-kernel", "size-kernel", "unknown-fields", "forget-rows", "writer"})
UNKNOWN = "unknown fields"
"""Of the slot with fields that the schema does not know: no schema has a name with a space."""
ABSENT_BOOL = ":absent"
"""An optional bool that is not there: nil is false."""
EMPTY = "(no-octets)"


@dataclass(slots=True)
class Classes:
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

    def accessor(self, struct: Struct, field: str) -> str:
        """The place of a field of an object."""
        return f"({self.types[struct.name]}-{self.slot(struct, field)} object)"

    def case(self, union: Union, name: str) -> str:
        """The keyword of a case."""
        scope = Names(frozenset())
        return next(f":{symbol}" for each in union.cases if (symbol := scope.symbol(each.name)) and each.name == name)

    def exported(self) -> list[list[str]]:
        """What who uses the package needs: for each type its symbols, in order."""
        return [self._exported(self.schema.types[name], symbol) for name, symbol in self.types.items()]

    def _exported(self, declared: Declaration, symbol: str) -> list[str]:
        if isinstance(declared, Enum):
            return [constant for constant, _ in self.values(declared)]
        slots = [f"{symbol}-{self.slot(declared, each)}" for each in _slots(declared)]
        return [symbol, f"make-{symbol}", *slots, *(constant for constant, _ in self.values(declared))]

    def values(self, declared: Declaration) -> list[tuple[str, str]]:
        """The constants of an enum or struct, and the forms of their values."""
        if isinstance(declared, Enum):
            named = [(name, str(value)) for name, value in declared.values]
        else:
            named = [(each.name, _value(each)) for each in constants_of(declared)]
        scope = Names(frozenset())
        return [(f"+{self.types[declared.name]}.{scope.symbol(name)}+", value) for name, value in named]

    def constants(self) -> list[str]:
        """Those of all types."""
        return [constant for name in self.types for constant, _ in self.values(self.schema.types[name])]


def _value(named: NamedConstant) -> str:
    """The form of a constant's value."""
    if isinstance(named.value, str):
        return literal(named.value)
    return number(scalar_of_constant(named), number_of(named))


def _slots(struct: Struct) -> list[str]:
    return [*(each.name for each in struct.fields), *([UNKNOWN] if struct.option("unknown") else [])]


def classes_of(unit: Unit) -> Classes:
    """The symbols of a unit: none is another's, or one of the language, whatever the schema says (`Time` is `time-message`)."""
    names, types = Names(symbols() | runtime_names() | KERNELS), dict[str, str]()
    for name in reached_types(unit):
        simple = hyphenated(re.split(r"[./:]+", name)[-1])
        known = {simple, f"make-{simple}"} & names.reserved
        types[name] = names.symbol(name, "{}", "make-{}", wanted=f"{simple}-message" if known else simple)
    made = Classes(unit, names, types, frozenset(struct for _, struct in unit.layout.recursive))
    made.exported()
    return made


def definitions(classes: Classes) -> str:
    """The classes, each behind those that it contains."""
    lines = Lines()
    for name, symbol in classes.types.items():
        declared = classes.schema.types[name]
        if lines.lines:
            lines.line("")
        for constant, value in classes.values(declared):
            define = "define-symbol-macro" if value.startswith(('"', "(text")) else "defconstant"  # a text is never the same one
            lines.line(f"({define} {constant} {value})")
        if isinstance(declared, Struct):
            _class(lines, classes, symbol, declared)
    return lines.text()


def _class(lines: Lines, classes: Classes, symbol: str, struct: Struct) -> None:
    slots = [_slot(classes, struct, each) for each in struct.fields]
    if struct.option("unknown"):
        slots.append(_options(classes.slot(struct, UNKNOWN), "octets", EMPTY, "Fields that the schema does not know, as they came."))
    with lines.form(f"(defclass {symbol} ()"):
        lines.slots(slots)
        lines.line("(:metaclass structure-class)")
    lines.line(f"(define-operators {symbol} {doc(f'{struct.name}. {struct.doc}'.rstrip('. ') + '.')})")


def _slot(classes: Classes, struct: Struct, each: Field) -> list[str]:
    said = said_of(each)
    return _options(classes.slot(struct, each.name), slot_type(classes, each.type), default(classes, each.type), said)


def _options(name: str, type_: str, value: str, said: str) -> list[str]:
    """A slot in parts, between which a line may end."""
    first = f"{name} :initarg :{name} :type {type_}"
    return [first, f":initform {value}", *([f":documentation {doc(said)}"] if said else [])]


def slot_type(classes: Classes, type_: Type) -> str:
    """The type of a slot."""
    schema = classes.schema
    match type_:
        case Bool() | Int() | Float():
            return LISP_TYPES[scalar_of(type_)]
        case String():
            return "string"
        case Bytes(_, length):
            return f"(simple-array u8 ({length if isinstance(length, int) else '*'}))"
        case Array(element, length):
            return vector_type(classes, element, length if isinstance(length, int) else None)
        case Map():
            return "hash-table"
        case Optional(value) if isinstance(schema.resolve(value), Bool):
            return f"(member t nil {ABSENT_BOOL})"
        case Optional(value):
            return f"(or null {slot_type(classes, value)})"
        case Union():
            return "(or null (cons keyword t))"
        case Ref(name):
            if isinstance(schema.types[name], Enum):
                return "i32"
            return "(or null structure-object)" if name in classes.recursive else classes.types[name]
        case Enum() | Struct():
            raise AssertionError(type_)
        case _:
            assert_never(type_)


def vector_type(classes: Classes, element: Type, length: int | None) -> str:
    """Of an array: numbers lie in it unboxed."""
    resolved, many = classes.schema.resolve(element), "*" if length is None else length
    if isinstance(resolved, Int | Float | Enum):
        return f"(simple-array {LISP_TYPES[scalar_of(resolved)]} ({many}))"
    return "simple-vector" if length is None else f"(simple-vector {length})"


def default(classes: Classes, type_: Type) -> str:
    """The first value of a slot."""
    match classes.schema.resolve(type_):
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
            return _vector(classes, element, length if isinstance(length, int) else 0)
        case Map():
            return "(make-hash-table :test 'equal)"
        case Optional(value):
            return ABSENT_BOOL if isinstance(classes.schema.resolve(value), Bool) else "nil"
        case Struct(name):
            return "nil" if name in classes.recursive else f"(make-{classes.types[name]})"
        case Ref():
            raise AssertionError(type_)


def _vector(classes: Classes, element: Type, length: int) -> str:
    resolved = classes.schema.resolve(element)
    if isinstance(resolved, Int | Float | Enum):
        return f"(make-array {length} :element-type '{LISP_TYPES[scalar_of(resolved)]})"
    if isinstance(resolved, Bool) or not length:
        return f"(make-array {length} :initial-element nil)"
    return f"(map-into (make-array {length}) (lambda () {_element(classes, element)}))"


def _element(classes: Classes, element: Type) -> str:
    """What is in an array of a fixed length at first: objects, of recursive types too."""
    resolved = classes.schema.resolve(element)
    return f"(make-{classes.types[resolved.name]})" if isinstance(resolved, Struct) else default(classes, element)


def wire_symbols(classes: Classes, wires: Iterable[str]) -> dict[str, str]:
    """What stands for wires in the symbols of their functions, as `decode-WIRE`."""
    taken = ("decode-{}", "age-{}", "decode-{}-kernel")
    return {each: classes.names.symbol(f"wire {each}", *taken, wanted=each) for each in wires}


def function_symbols(classes: Classes, functions: Iterable[str]) -> dict[str, str]:
    """The symbols of the mapping's functions."""
    return {each: classes.names.symbol(f"function {each}", wanted=each) for each in functions}
