"""Type and layout joined: what lies where in the lanes, in the form that accessors are made from.

    Node   = Scalar | Text | Blob | Numbers | Items | Pairs | Record | Child
    Record = Entry*          Entry = name, Node, Presence | None, field, default
    Presence = Bit | Case

A union is not a node: its cases are entries of the record around it, present where the union's case word says so. A `Child` is a field
that refers to a recursive struct: at most one row of that struct's lane. Absent values are zero in memory.

Nodes are never changed, and not frozen only because every process pays for the methods of a frozen dataclass when it starts.
"""

from __future__ import annotations

from typing import ClassVar, assert_never

from rosetta_jit.model import layout as slots
from rosetta_jit.model.initial_values import InitialValue, selected
from rosetta_jit.model.types import Bool, Constant, Enum, Field, Float, Int, String, Type, Union
from rosetta_jit.runtime.cells import SCALARS
from rosetta_jit.startup.dataclass import dataclass, field

ScalarType = Bool | Int | Float | Enum
SIZE = dict(zip(SCALARS, (1, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8), strict=True))
"""Bytes of a scalar."""


@dataclass(slots=True, eq=False, repr=False)
class Cell:
    """One scalar of each row of a lane: ``cells[key][row * step + index]``. A span is two of them, one after the other."""

    key: int
    step: int
    index: int

    @property
    def lane(self) -> int:
        """The lane that the cell lies in."""
        return self.key >> 4


@dataclass(slots=True, eq=False, repr=False)
class Bit:
    """Present when a bit of the record's presence words is set. The field has the values ``initial`` then."""

    cell: Cell
    mask: int
    initial: tuple[InitialValue, ...] = ()


@dataclass(slots=True, eq=False, repr=False)
class Case:
    """Present when the union's case is this one. Bytes ``start`` to ``end`` of the row are shared by no other field than the cases.

    Where a discriminator tells the case, ``choice`` knows it, and ``label`` is the value that selects this one.
    """

    cell: Cell
    number: int
    start: int
    end: int
    initial: tuple[InitialValue, ...] = ()
    choice: Choice | None = None
    label: int = 0

    @property
    def siblings(self) -> list[Case]:
        """All cases of the union, where a discriminator tells them."""
        return self.choice.cases if self.choice is not None else []


@dataclass(slots=True, eq=False, repr=False)
class Choice:
    """A union whose case a discriminator tells: the cell and the type of that, and the cases of the union."""

    tag: Cell
    type: Type
    union: Union
    cases: list[Case] = field(default_factory=list["Case"])

    def selected(self, value: int) -> int:
        """The number of the case that a value selects, 0 for none."""
        return selected(self.union, value)


Presence = Bit | Case


@dataclass(slots=True, eq=False, repr=False)
class Scalar:
    """A number, a boolean, or an enum's number; where it is the discriminator of a union, with its ``choice``."""

    cell: Cell
    type: ScalarType
    choice: Choice | None = None


@dataclass(slots=True, eq=False, repr=False)
class Text:
    """A string in a lane of bytes, or of UTF-16's code units."""

    initial: ClassVar[tuple[InitialValue, ...]] = ()
    span: Cell
    lane: int
    type: String


@dataclass(slots=True, eq=False, repr=False)
class Blob:
    """Bytes in a lane, or borrowed from the message. ``length`` where the type fixes it, ``maximum`` where it bounds it."""

    initial: ClassVar[tuple[InitialValue, ...]] = ()
    span: Cell
    lane: int
    length: int | None = None
    maximum: int | None = None


@dataclass(slots=True, eq=False, repr=False)
class Numbers:
    """An array of scalars: a numpy array. ``length`` where the type fixes it, ``maximum`` where it bounds it."""

    initial: ClassVar[tuple[InitialValue, ...]] = ()
    span: Cell
    lane: int
    type: ScalarType
    length: int | None
    maximum: int | None = None


@dataclass(slots=True, eq=False, repr=False)
class Items:
    """An array of anything else; ``element`` is what lies in each row of the lane, at first ``initial``.

    ``shape`` is that of an array of several dimensions, all fixed, of numbers; it is empty for all others.
    """

    span: Cell
    lane: int
    element: Node
    length: int | None
    maximum: int | None = None
    initial: tuple[InitialValue, ...] = ()
    shape: tuple[int, ...] = ()


@dataclass(slots=True, eq=False, repr=False)
class Pairs:
    """A map: rows of key and value, each a ``record``."""

    span: Cell
    lane: int
    record: Record
    key: Scalar | Text
    value: Entry
    initial: tuple[InitialValue, ...] = ()


@dataclass(slots=True, eq=False, repr=False)
class Child:
    """At most one row of a recursive struct's lane."""

    span: Cell
    lane: int
    record: Record
    initial: tuple[InitialValue, ...] = ()


@dataclass(slots=True, eq=False, repr=False)
class Record:
    """A struct in place: bytes ``start`` to ``end`` of each row of a lane.

    Attributes
    ----------
    struct : str
        Its name in the schema.
    entries : dict
        Its fields and the cases of its unions by name, in the order of the IDL.
    unions : dict
        Names of the cases of each union; one with a discriminator is named as its field.
    touch : tuple of Presence
        What must be set when something in it is written: its own presence, and that of the records around it in the same row.
    unknown : Blob or None
        Fields that were read and that the schema does not know.
    """

    struct: str
    lane: int
    start: int
    end: int
    touch: tuple[Presence, ...]
    entries: dict[str, Entry] = field(default_factory=dict[str, "Entry"])
    unions: dict[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])
    unknown: Blob | None = None


Spanned = Text | Blob | Numbers | Items | Pairs | Child
"""Nodes of variable length, or of a length that the type fixes: start and count of elements in a lane."""
Node = Scalar | Spanned | Record


@dataclass(slots=True, eq=False, repr=False)
class Entry:
    """A field of a record, or a case of one of its unions.

    ``default`` is what reading gives while it is absent, ``initial`` what a field that cannot be absent has besides zeros.
    """

    name: str
    node: Node
    presence: Presence | None
    field: Field
    default: Constant | None = None
    initial: tuple[InitialValue, ...] = ()


def extent(node: Node) -> tuple[int, int, int]:
    """Lane, first byte and last (exclusive) of a node in each row: what is zero while it is absent."""
    match node:
        case Record():
            return node.lane, node.start, node.end
        case Scalar(cell, _):
            size = SIZE[SCALARS[cell.key & 15]]
            return cell.lane, cell.index * size, (cell.index + 1) * size
        case Text(span) | Blob(span) | Numbers(span) | Items(span) | Pairs(span) | Child(span):
            return span.lane, span.index * 8, span.index * 8 + slots.SPAN_BYTES
        case _:
            assert_never(node)
