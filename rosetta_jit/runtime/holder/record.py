"""Type and layout joined: what lies where in the lanes, in the form that accessors are made from.

    Node   = Scalar | Text | Blob | Numbers | Items | Pairs | Record | Child
    Record = Entry*          Entry = name, Node, Presence | None, field, default
    Presence = Bit | Case

A union is not a node: its cases are entries of the record around it, present where the union's case word says so. A `Child` is a field
that refers to a recursive struct: at most one row of that struct's lane. Absent values are zero in memory.

Nodes are never changed, and not frozen only because every process pays for the methods of a frozen dataclass when it starts.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, assert_never, cast

from rosetta_jit.model import layout as slots
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Map, Optional, Ref, String, Struct, Type, Union
from rosetta_jit.runtime.lanes import SCALARS, cell_key

if TYPE_CHECKING:
    from rosetta_jit.model.layout import Layout, Slot
    from rosetta_jit.model.types import Constant, Schema

ScalarType = Bool | Int | Float | Enum
_SIZE = dict(zip(SCALARS, (1, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8), strict=True))


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
    """Present when a bit of the record's presence words is set."""

    cell: Cell
    mask: int


@dataclass(slots=True, eq=False, repr=False)
class Case:
    """Present when the union's case is this one. Bytes ``start`` to ``end`` of the row are shared by no other field than the cases."""

    cell: Cell
    number: int
    start: int
    end: int


Presence = Bit | Case


@dataclass(slots=True, eq=False, repr=False)
class Scalar:
    """A number, a boolean, or an enum's number."""

    cell: Cell
    type: ScalarType


@dataclass(slots=True, eq=False, repr=False)
class Text:
    """A string in a lane of bytes."""

    span: Cell
    lane: int
    type: String


@dataclass(slots=True, eq=False, repr=False)
class Blob:
    """Bytes in a lane, or borrowed from the message."""

    span: Cell
    lane: int


@dataclass(slots=True, eq=False, repr=False)
class Numbers:
    """An array of scalars: a numpy array. Where the type fixes its ``length`` it is empty until it is set."""

    span: Cell
    lane: int
    type: ScalarType
    length: int | None


@dataclass(slots=True, eq=False, repr=False)
class Items:
    """An array of anything else; ``element`` is what lies in each row of the lane."""

    span: Cell
    lane: int
    element: Node
    length: int | None


@dataclass(slots=True, eq=False, repr=False)
class Pairs:
    """A map: rows of key and value, each a ``record``."""

    span: Cell
    lane: int
    record: Record
    key: Scalar | Text
    value: Entry


@dataclass(slots=True, eq=False, repr=False)
class Child:
    """At most one row of a recursive struct's lane."""

    span: Cell
    lane: int
    record: Record


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
        Names of the cases of each union.
    touch : tuple of Presence
        What must be set when something in it is written: its own presence, and that of the records around it in the same row.
    """

    struct: str
    lane: int
    start: int
    end: int
    touch: tuple[Presence, ...]
    entries: dict[str, Entry] = field(default_factory=dict[str, "Entry"])
    unions: dict[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])


Node = Scalar | Text | Blob | Numbers | Items | Pairs | Record | Child


@dataclass(slots=True, eq=False, repr=False)
class Entry:
    """A field of a record, or a case of one of its unions. ``default`` is what reading gives while it is absent."""

    name: str
    node: Node
    presence: Presence | None
    field: Field
    default: Constant | None = None


class Tree:
    """The nodes of a layout. ``root`` is the message; ``recursive`` has the record of each recursive lane.

    Raises
    ------
    ValueError
        If the type is not a struct, or holds a union elsewhere than as a field.
    """

    def __init__(self, type_: Type, schema: Schema, layout: Layout) -> None:
        self.schema = schema
        self.layout = layout
        self.recursive: dict[int, Record] = {}
        root = self._element(type_, 0)
        if not isinstance(root, Record):
            raise ValueError("a message is a struct")  # noqa: TRY004  the type is the user's data, not a mistaken call
        self.root = root

    def _cell(self, lane: int, offset: int, scalar: str) -> Cell:
        size = _SIZE[scalar]
        return Cell(cell_key(lane, scalar), self.layout.lanes[lane].stride // size, offset // size)

    def _element(self, type_: Type, lane: int) -> Node:
        """The node of the rows of a lane."""
        if lane in self.recursive:
            return self.recursive[lane]
        slot = self.layout.lanes[lane].element
        resolved = self.schema.resolve(type_)
        if isinstance(resolved, Struct):
            return self._record(resolved, slot, lane, (), recursive=self.layout.lanes[lane].links is not None)
        return self._node(resolved, slot, lane, ())

    def _node(self, type_: Type, slot: Slot, lane: int, touch: tuple[Presence, ...]) -> Node:
        match type_, slot:
            case Bool() | Int() | Float() | Enum(), slots.Number(offset, scalar):
                return Scalar(self._cell(lane, offset, scalar), type_)
            case String(), slots.Span(offset, target):
                return Text(self._cell(lane, offset, "i64"), target, type_)
            case Bytes(), slots.Span(offset, target):
                return Blob(self._cell(lane, offset, "i64"), target)
            case Array(element), slots.Span(offset, target):
                return self._array(self.schema.resolve(element), element, self._cell(lane, offset, "i64"), target, type_.fixed)
            case Map(key, value), slots.Span(offset, target):
                return self._pairs(key, value, self._cell(lane, offset, "i64"), target)
            case Ref(), slots.Span(offset, target):
                return Child(self._cell(lane, offset, "i64"), target, cast("Record", self._element(type_, target)))
            case ((Ref() | Optional()), _):
                value = type_.value if isinstance(type_, Optional) else self.schema.types[type_.name]
                return self._node(value, slot, lane, touch)
            case Struct(), slots.Row():
                return self._record(type_, slot, lane, touch, recursive=False)
            case _:
                raise ValueError(f"{type(type_).__name__} cannot be held there")

    def _array(self, resolved: Type, element: Type, span: Cell, target: int, length: int | None) -> Node:
        if isinstance(resolved, Bool | Int | Float | Enum):
            return Numbers(span, target, resolved, length)
        return Items(span, target, self._element(element, target), length)

    def _pairs(self, key: Type, value: Type, span: Cell, target: int) -> Pairs:
        entry = self._element(slots.map_entry(key, value), target)
        assert isinstance(entry, Record)
        return Pairs(span, target, entry, cast("Scalar | Text", entry.entries["key"].node), entry.entries["value"])

    def _record(self, struct: Struct, slot: Slot, lane: int, touch: tuple[Presence, ...], *, recursive: bool) -> Record:
        assert isinstance(slot, slots.Row)
        record = Record(struct.name, lane, slot.offset, _end(slot), touch)
        if recursive:
            self.recursive[lane] = record
        for each, member in zip(struct.fields, slot.members, strict=True):
            if isinstance(each.type, Union) and isinstance(member.slot, slots.Variant):
                self._cases(record, each.type, member.slot, touch)
                continue
            presence = None
            if member.presence is not None:
                word, bit = divmod(member.presence, 64)
                presence = Bit(self._cell(lane, slot.offset + 8 * word, "u64"), 1 << bit)
            self._entry(record, each, member.slot, touch, presence)
        return record

    def _cases(self, record: Record, union: Union, slot: slots.Variant, touch: tuple[Presence, ...]) -> None:
        cell = self._cell(record.lane, slot.offset, "i64")
        record.unions[union.name.rpartition(".")[2]] = tuple(case.name for case in union.cases)
        for number, (case, member) in enumerate(zip(union.cases, slot.members, strict=True), 1):
            self._entry(record, case, member.slot, touch, Case(cell, number, slot.offset + 8, _end(slot)))

    def _entry(self, record: Record, each: Field, slot: Slot, touch: tuple[Presence, ...], presence: Presence | None) -> None:
        inner = touch if presence is None else (*touch, presence)
        node = self._node(each.type, slot, record.lane, inner)
        record.entries[each.name] = Entry(each.name, node, presence, each, _default(each, node))


def _default(each: Field, node: Node) -> Constant | None:
    if each.default is not None and not isinstance(node, Record | Child):
        return each.default
    match node:
        case Scalar(_, Enum(_, values, closed)):
            return values[0][1] if closed and values else 0
        case Scalar(_, type_):
            return False if isinstance(type_, Bool) else 0.0 if isinstance(type_, Float) else 0
        case Text():
            return ""
        case Blob():
            return b""
        case Numbers() | Items() | Pairs() | Record() | Child():
            return None
        case _:
            assert_never(node)


def _end(slot: Slot) -> int:
    """The offset behind a slot."""
    match slot:
        case slots.Number(offset, scalar):
            return offset + _SIZE[scalar]
        case slots.Span(offset, _):
            return offset + slots.SPAN_BYTES
        case slots.Row(offset, _, words, members):
            return max([offset + 8 * words, *(_end(member.slot) for member in members)])
        case slots.Variant(offset, members):
            return max([offset + 8, *(_end(member.slot) for member in members)])
        case _:
            assert_never(slot)


def extent(node: Node) -> tuple[int, int, int]:
    """Lane, first byte and last (exclusive) of a node in each row: what is zero while it is absent."""
    match node:
        case Record():
            return node.lane, node.start, node.end
        case Scalar(cell, _):
            size = _SIZE[SCALARS[cell.key & 15]]
            return cell.lane, cell.index * size, (cell.index + 1) * size
        case Text(span) | Blob(span) | Numbers(span) | Items(span) | Pairs(span) | Child(span):
            return span.lane, span.index * 8, span.index * 8 + slots.SPAN_BYTES
        case _:
            assert_never(node)
