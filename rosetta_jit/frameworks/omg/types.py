"""Types as they are written, to types of the model.

What the model has nothing for becomes a reference to a type that is declared nowhere; whatever needs it is left out at the end.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.frameworks.omg import diagnostics as say
from rosetta_jit.frameworks.omg.constants import Value, evaluate, fit
from rosetta_jit.frameworks.omg.expressions import Expr, ScopedName
from rosetta_jit.frameworks.omg.limits import MAX_TYPE_DEPTH
from rosetta_jit.frameworks.omg.problems import LookupProblem
from rosetta_jit.frameworks.omg.tree import Aggregate, Basic, Declarator, Enum, MapOf, Sequence, Text, TypeSpec, Unsupported
from rosetta_jit.model.types import Array, Bool, Bytes, Float, Int, Map, Ref, String, Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.frameworks.omg.scopes import Entry, Scope

SCALARS: dict[str, Type] = {
    "boolean": Bool("boolean"),
    "char": Int(8, signed=False, spelling="char"),
    "wchar": Int(16, signed=False, spelling="wchar"),
    "octet": Int(8, signed=False, spelling="octet"),
    "short": Int(16, spelling="short"),
    "unsigned short": Int(16, signed=False, spelling="unsigned short"),
    "long": Int(32, spelling="long"),
    "unsigned long": Int(32, signed=False, spelling="unsigned long"),
    "long long": Int(64, spelling="long long"),
    "unsigned long long": Int(64, signed=False, spelling="unsigned long long"),
    "float": Float(32, "float"),
    "double": Float(64, "double"),
}
SIZED: dict[str, Type] = {
    "int8": Int(8, spelling="int8"),
    "uint8": Int(8, signed=False, spelling="uint8"),
    "int16": Int(16, spelling="int16"),
    "uint16": Int(16, signed=False, spelling="uint16"),
    "int32": Int(32, spelling="int32"),
    "uint32": Int(32, signed=False, spelling="uint32"),
    "int64": Int(64, spelling="int64"),
    "uint64": Int(64, signed=False, spelling="uint64"),
}
"""Words of IDL 4.2; before it they could be names, and a declaration still hides them."""

OCTETS = frozenset(("octet", "uint8"))
SIZE = Int(32, signed=False, spelling="unsigned long")


@dataclass(frozen=True, slots=True)
class TypeMaker:
    """Makes types of the model in a scope; ``declare`` is called for those that are declared on the spot."""

    declare: Callable[[Scope, Aggregate | Enum], Type]

    def type(self, scope: Scope, spec: TypeSpec, *, free: bool, in_sequence: bool = False) -> Type:
        """The type that some words mean; raises LookupProblem where they mean none."""
        match spec:
            case Basic(word):
                return SCALARS[word]
            case Text("string", bound):
                return String("utf-8", "string", self.bound(scope, bound, free=free))
            case Text(_, bound):
                return String("utf-16", "wstring", self.bound(scope, bound, free=free))
            case Sequence(element, bound, span):
                inner = self.type(scope, element, free=free, in_sequence=True)
                return shallow(sequence(inner, self.bound(scope, bound, free=free)), span)
            case MapOf(key, value, bound, span):
                inner = self.type(scope, value, free=free, in_sequence=True)
                made = Map(self.key(scope, key, free=free), inner, self.bound(scope, bound, free=free))
                return shallow(made, span)
            case Unsupported(word, span):
                return Ref(word, span)
            case ScopedName():
                return self.named(scope, spec, free=free, in_sequence=in_sequence)
            case Aggregate() | Enum():
                return self.declare(scope, spec)
            case _:
                assert_never(spec)

    def named(self, scope: Scope, name: ScopedName, *, free: bool, in_sequence: bool) -> Type:
        word = name.parts[0]
        if word in SIZED and len(name.parts) == 1 and not name.absolute and not known(scope, word):
            return SIZED[word]
        entry = scope.find(name, free=free)
        match entry.kind:
            case "struct" | "union":
                if entry.state != "whole" and not in_sequence:
                    raise LookupProblem(say.incomplete(name.span, entry.full, entry.state))
                return Ref(entry.full, name.span)
            case "enum" | "interface" | "valuetype" | "native":
                return Ref(entry.full, name.span)
            case "typedef" if entry.type is not None:
                return Ref(entry.type.name, name.span) if isinstance(entry.type, Ref) else entry.type
            case _:
                raise LookupProblem(say.wrong_kind(name.span, entry.full, entry.kind, "type"))

    def key(self, scope: Scope, spec: TypeSpec, *, free: bool) -> Type:
        type_ = self.type(scope, spec, free=free)
        if not isinstance(type_, Bool | Int | String) and not (isinstance(type_, Ref) and is_enum(scope, spec)):
            raise LookupProblem(say.map_key(spec.span if not isinstance(spec, Aggregate | Enum) else spec.name.span, _word(type_)))
        return type_

    def declared(self, scope: Scope, type_: Type, declarator: Declarator) -> Type:
        """The type of a name with dimensions behind it."""
        free = declarator.name.free
        for dimension in reversed(declarator.dimensions):
            type_ = array(type_, self.size(scope, dimension, free=free))
        return shallow(type_, declarator.name.span)

    def bound(self, scope: Scope, expr: Expr | None, *, free: bool) -> int | None:
        return None if expr is None else self.size(scope, expr, free=free)

    def size(self, scope: Scope, expr: Expr, *, free: bool) -> int:
        value = evaluate(expr, lambda name: value_of(scope, name, free=free))
        if value.sort == "integer" and isinstance(value.value, int) and not 1 <= value.value < 1 << 32:
            raise LookupProblem(say.bound(expr.span, value.value))
        return int(fit(value, SIZE, expr.span))


def value_of(scope: Scope, name: ScopedName, *, free: bool) -> Value:
    """The value of a constant or an enumerator."""
    entry = scope.find(name, free=free)
    if entry.value is None:
        raise LookupProblem(say.wrong_kind(name.span, entry.full, entry.kind, "constant"))
    return entry.value


def sequence(element: Type, maximum: int | None) -> Type:
    """A sequence; one of octets is bytes."""
    if isinstance(element, Int) and element.spelling in OCTETS:
        return Bytes(element.spelling, maximum=maximum)
    return Array(element, maximum=maximum)


def array(element: Type, length: int) -> Type:
    """An array; one of octets is bytes."""
    if isinstance(element, Int) and element.spelling in OCTETS:
        return Bytes(element.spelling, length=length)
    return Array(element, length)


def shallow(type_: Type, span: Span) -> Type:
    """The type itself; raises LookupProblem where it is too deep."""
    depth, inner = 0, type_
    while isinstance(inner, Array | Map):
        inner = inner.element if isinstance(inner, Array) else inner.value
        depth += 1
        if depth > MAX_TYPE_DEPTH:
            raise LookupProblem(say.nesting(span, MAX_TYPE_DEPTH, "arrays and sequences"))
    return type_


def known(scope: Scope, word: str) -> bool:
    """Whether a word that may be a type of the language is declared around here."""
    around: Scope | None = scope
    while around is not None:
        entry = around.entries.get(word.lower())
        if entry is not None and entry.name == word:
            return True
        around = around.outer
    return False


def is_enum(scope: Scope, spec: TypeSpec) -> bool:
    """Whether a type is an enum, perhaps by another name."""
    return isinstance(spec, Enum) or (isinstance(spec, ScopedName) and enum_entry(scope.find(spec, free=True)) is not None)


def enum_entry(entry: Entry) -> Entry | None:
    """The enum that a name stands for."""
    while entry.kind == "typedef" and entry.target is not None:
        entry = entry.target
    return entry if entry.kind == "enum" else None


def _word(type_: Type) -> str:
    return getattr(type_, "spelling", "") or getattr(type_, "name", "") or "sequence"
