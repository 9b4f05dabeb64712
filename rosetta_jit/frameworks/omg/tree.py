"""What a file of OMG IDL says, before any name in it is looked up.

    Definition = Module | Aggregate | Enum | Typedef | Constant | Interface | Opaque
    TypeSpec   = Basic | Text | Sequence | MapOf | Unsupported | ScopedName | Aggregate | Enum

An `Aggregate` is a struct, a union or an exception; a declaration may stand where a type is wanted.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from rosetta_jit.frameworks.omg.expressions import Expr, ScopedName
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.source import Span


@dataclass(frozen=True, slots=True)
class Name:
    """The name of a declaration. In a module of rosidl it may be any word, `String` and `map` included."""

    text: str
    span: Span
    free: bool = False


@dataclass(frozen=True, slots=True)
class Annotation:
    """``@name(arguments)``; an argument without a name has the empty one."""

    name: str
    arguments: tuple[tuple[str, Expr], ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Basic:
    """A type that is one or a few words."""

    word: str
    span: Span


@dataclass(frozen=True, slots=True)
class Text:
    """``string`` or ``wstring``."""

    word: Literal["string", "wstring"]
    bound: Expr | None
    span: Span


@dataclass(frozen=True, slots=True)
class Sequence:
    """``sequence<element, bound>``"""

    element: TypeSpec
    bound: Expr | None
    span: Span


@dataclass(frozen=True, slots=True)
class MapOf:
    """``map<key, value, bound>``"""

    key: TypeSpec
    value: TypeSpec
    bound: Expr | None
    span: Span


@dataclass(frozen=True, slots=True)
class Unsupported:
    """A type that the meta-model has nothing for: ``any``, ``Object``, ``fixed``, ``long double``."""

    word: str
    span: Span


@dataclass(frozen=True, slots=True)
class Declarator:
    """A name with the dimensions of an array behind it."""

    name: Name
    dimensions: tuple[Expr, ...] = ()


@dataclass(frozen=True, slots=True)
class Member:
    """One or several members of one type; ``labels`` are those of a case of a union, None for ``default``."""

    type: TypeSpec
    declarators: tuple[Declarator, ...]
    annotations: tuple[Annotation, ...] = ()
    labels: tuple[Expr | None, ...] = ()


@dataclass(frozen=True, slots=True)
class Aggregate:
    """A struct, union or exception; without ``members`` it is declared and not yet defined."""

    kind: Literal["struct", "union", "exception"]
    name: Name
    members: tuple[Member, ...] | None
    base: ScopedName | None = None
    switch: TypeSpec | None = None
    switch_annotations: tuple[Annotation, ...] = ()
    annotations: tuple[Annotation, ...] = ()


@dataclass(frozen=True, slots=True)
class Enumerator:
    """A value of an enum."""

    name: Name
    annotations: tuple[Annotation, ...] = ()


@dataclass(frozen=True, slots=True)
class Enum:
    """``enum name { enumerators }``"""

    name: Name
    enumerators: tuple[Enumerator, ...]
    annotations: tuple[Annotation, ...] = ()


@dataclass(frozen=True, slots=True)
class Typedef:
    """``typedef type declarators``"""

    type: TypeSpec
    declarators: tuple[Declarator, ...]


@dataclass(frozen=True, slots=True)
class Constant:
    """``const type name = value``"""

    type: TypeSpec
    name: Name
    value: Expr
    annotations: tuple[Annotation, ...] = ()


@dataclass(frozen=True, slots=True)
class Module:
    """``module name { definitions }``"""

    name: Name
    definitions: tuple[Definition, ...]
    annotations: tuple[Annotation, ...] = ()


@dataclass(frozen=True, slots=True)
class Interface:
    """An interface or valuetype, of which only the types that it declares count; None of them where it is declared ahead."""

    word: Literal["interface", "valuetype"]
    name: Name
    bases: tuple[ScopedName, ...]
    definitions: tuple[Definition, ...] | None


@dataclass(frozen=True, slots=True)
class Opaque:
    """A declaration of which only the name counts: ``native``, ``bitmask``, ``bitset``, ``component``."""

    word: str
    name: Name


TypeSpec = Basic | Text | Sequence | MapOf | Unsupported | ScopedName | Aggregate | Enum
Definition = Module | Aggregate | Enum | Typedef | Constant | Interface | Opaque
