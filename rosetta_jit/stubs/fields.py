"""Annotations of fields: what reading gives, and what can be assigned. The classes of arrays and maps are those that a holder shows."""

from __future__ import annotations

from typing import Any, assert_never

from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Bool, Enum, Float, Int
from rosetta_jit.runtime.cells import SCALARS
from rosetta_jit.runtime.holder.classes import HolderFamily
from rosetta_jit.runtime.holder.record import Blob, Child, Entry, Items, Node, Numbers, Pairs, Record, Scalar, ScalarType, Text
from rosetta_jit.startup.dataclass import dataclass, field

WORDS = ("bool_", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")
NUMBERS = {scalar: f"numpy.ndarray[typing.Any, numpy.dtype[numpy.{word}]]" for scalar, word in zip(SCALARS, WORDS, strict=True)}
BUILTINS = ("bool", "bytearray", "bytes", "float", "int", "list", "memoryview", "str", "type")
GRID = "numpy.ndarray[typing.Any, numpy.dtype[typing.Any]]"


@dataclass(slots=True)
class Shapes:
    """The classes that a stub needs besides those of structs: of arrays and maps, by what they are made of.

    Attributes
    ----------
    classes
        Identifiers of structs by their qualified names.
    sequences, mappings
        Identifiers by the class that a holder shows and the annotations of its parts.
    aliases
        Other names of classes that have a field of their own name in their way.
    """

    classes: dict[str, str]
    sequences: dict[tuple[type, str], str] = field(default_factory=dict[tuple[type, str], str])
    mappings: dict[tuple[type, str, str], str] = field(default_factory=dict[tuple[type, str, str], str])
    aliases: dict[str, str] = field(default_factory=dict[str, str])

    def beside(self, name: str) -> str:
        """What to write for a name of the module, or of Python, inside a class that has a field of that name."""
        if name in BUILTINS:
            return f"builtins.{name}"
        return self.aliases.setdefault(name, f"_the_{name}")

    @property
    def names(self) -> set[str]:
        """The names of the module, and of Python, that stand in annotations."""
        return {*BUILTINS, *self.classes.values(), *self.sequences.values(), *self.mappings.values()}


@dataclass(frozen=True, slots=True)
class Annotation:
    """What reading a field gives, and what it takes: the same where ``takes`` is None, nothing where it is empty."""

    gives: str
    takes: str | None = None


def annotation(entry: Entry, holder: Any, family: HolderFamily, shapes: Shapes) -> Annotation:
    """The annotation of a field; ``holder`` is an empty one, which shows its arrays and maps."""
    whole = "typing.Any" if family.assigns_whole else ""
    match entry.node:
        case Scalar() | Text():
            return Annotation(plain(entry.node, shapes))
        case Blob():
            return Annotation("bytes", "bytes | bytearray | memoryview")
        case Numbers():
            is_own = family.array_type.__module__ != "numpy"
            return Annotation(path(family.array_type) if is_own else plain(entry.node, shapes), whole)
        case Items(shape=shape) if shape:
            return Annotation(GRID, whole)
        case Items(element=element):
            return Annotation(_sequence(type(_shown(holder, entry)), plain(element, shapes), shapes), whole)
        case Pairs(key=key, value=value):
            parts = plain(key, shapes), plain(value.node, shapes)
            return Annotation(_mapping(type(_shown(holder, entry)), *parts, shapes), whole)
        case Record() | Child():
            return Annotation(plain(entry.node, shapes), whole)
        case _:
            assert_never(entry.node)


def plain(node: Node, shapes: Shapes) -> str:
    """What one value of a node is read as."""
    match node:
        case Scalar(type=type_):
            return _number(type_)
        case Text():
            return "str"
        case Blob():
            return "bytes"
        case Numbers(type=Bool()):
            return NUMBERS["bool"]
        case Numbers(type=type_):
            return NUMBERS[scalar_of(type_)]
        case Record(struct):
            return shapes.classes[struct]
        case Child(record=record):
            return shapes.classes[record.struct]
        case Items() | Pairs():
            return "typing.Any"
        case _:
            assert_never(node)


def _number(type_: ScalarType) -> str:
    match type_:
        case Bool():
            return "bool"
        case Int() | Enum():
            return "int"
        case Float():
            return "float"
        case _:
            assert_never(type_)


def path(class_: type) -> str:
    """Where a class is found."""
    return f"{class_.__module__}.{class_.__qualname__}"


def _shown(holder: Any, entry: Entry) -> object:
    return holder.access_.getters[entry.name](holder)


def _sequence(class_: type, element: str, shapes: Shapes) -> str:
    made = _public(class_)
    return shapes.sequences.setdefault((made, element), _named(made, element, len(shapes.sequences)))


def _mapping(class_: type, key: str, value: str, shapes: Shapes) -> str:
    made = _public(class_)
    return shapes.mappings.setdefault((made, key, value), _named(made, f"{key}_{value}", len(shapes.mappings)))


def _named(class_: type, parts: str, number: int) -> str:
    return f"_{class_.__name__}_{parts if parts.isidentifier() else number}"


def _public(class_: type) -> type:
    """The class as its module names it: compiled code has a subclass of the same name."""
    return next(each for each in class_.__mro__ if getattr(_module(each), each.__name__, None) is each)


def _module(class_: type) -> object:
    import sys

    return sys.modules.get(class_.__module__)
