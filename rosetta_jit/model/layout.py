"""Where the values of a type lie in a holder: lanes of rows. A pure function of the type.

    Layout = Lane+                          lane 0 has one row a message
    Lane   = name, stride, Slot             an array of elements
    Slot   = Number | Span | Row | Variant  at an offset in its row
    Row    = presence words, Span?, Member* a struct, in place; Member = name, Slot, presence bit
    Variant = case, Member*                 a union: 0 for none, else 1 + the index of the case

Everything of variable length (string, bytes, array, map) is a `Span`: the start and the count, two int64, of its elements in a lane of
their own. There is a lane for each such field *path*, so that the elements of one array lie together however the wire orders fields. Paths
to recursive structs would have no end, so they start anew at each recursive struct: all its rows below the message that are reached through
the same field share a lane, whatever their depth. A field that refers to a recursive struct is a Span of at most one row there. All rows of
such a lane end with hidden words (`LINK_WORDS`) in which kernels keep their work list instead of a stack.
"""

from __future__ import annotations

from functools import cached_property
from typing import assert_never

from rosetta_jit.model import types
from rosetta_jit.model.limits import MAX_ROW_BYTES, MAX_SLOTS
from rosetta_jit.startup.dataclass import dataclass, field, replace

SPAN_BYTES = 16
LINK_WORDS = 6
UNKNOWN = "(unknown)"
"""The name of the lane of unknown fields; no IDL can give it to a field."""
WIDTH = {"bool": 1, "i8": 1, "u8": 1, "i16": 2, "u16": 2, "i32": 4, "u32": 4, "i64": 8, "u64": 8, "f32": 4, "f64": 8}
"""Bytes of a scalar in a row."""


@dataclass(frozen=True, slots=True)
class Number:
    """A scalar; ``scalar`` is a name of `kernel.nodes.Scalar`."""

    offset: int
    scalar: str


@dataclass(frozen=True, slots=True)
class Span:
    """Start and count of elements of a lane."""

    offset: int
    lane: int


@dataclass(frozen=True, slots=True)
class Member:
    """A field of a row; ``presence`` is the number of its bit in the row's presence words, None where it is always there."""

    name: str
    slot: Slot
    presence: int | None = None


class Members(tuple["Member", ...]):  # noqa: SLOT001 - its names are made when they are first asked for
    """The fields of a row or the cases of a union, in order and by name."""

    @cached_property
    def named(self) -> dict[str, Member]:
        """Each by its name: of thousands, all are looked for."""
        return {member.name: member for member in self}


@dataclass(frozen=True, slots=True)
class Row:
    """A struct. Its presence words (64 bits each) lie at its start. Offsets of members count from the start of the lane's row.

    ``unknown`` are the bytes of fields that the schema does not know, where the struct keeps them (its option ``unknown``).
    """

    offset: int
    struct: str
    presence_words: int
    members: Members
    unknown: Span | None = None

    @property
    def head_bytes(self) -> int:
        """Bytes before the members."""
        return 8 * self.presence_words + (SPAN_BYTES if self.unknown is not None else 0)

    def member(self, name: str) -> Member:
        """The member of that name."""
        return self.members.named[name]


@dataclass(frozen=True, slots=True)
class Variant:
    """A union: its case (i64) at the offset, then room for every case."""

    offset: int
    members: Members


Slot = Number | Span | Row | Variant


@dataclass(frozen=True, slots=True)
class Lane:
    """Elements of one array, or bytes of one string field. ``links`` is the offset of a recursive row's hidden words.

    ``within`` is how many elements arrays of fixed length around them, and they themselves, make of one.
    """

    name: str
    stride: int
    element: Slot
    links: int | None = None
    within: int = 1


@dataclass(frozen=True, slots=True)
class Layout:
    """The lanes of a type; ``recursive`` are those of recursive structs, with the struct's name."""

    lanes: tuple[Lane, ...]
    recursive: tuple[tuple[int, str], ...] = ()

    @property
    def root(self) -> Slot:
        """The slot of lane 0: the message."""
        return self.lanes[0].element


def layout(type_: types.Type, schema: types.Schema, *, padded: bool = False) -> Layout:
    """The layout of a type.

    Parameters
    ----------
    padded
        Structs within structs take whole words, eight bytes at least, as a compiler of C lays them out.

    Raises
    ------
    ValueError
        If a row would be larger than `MAX_ROW_BYTES`, or the type unfolds to more than `MAX_SLOTS` fields.
    """
    from rosetta_jit.model.recursive_structs import recursive_structs  # a warm start lays nothing out

    building = _Building(schema, recursive_structs(type_, schema), padded)
    building.lane(type_, "", "")
    return Layout(tuple(lane for lane in building.lanes if lane is not None), tuple(building.linked))


def behind(lanes: tuple[Lane, ...], layout: Layout) -> Layout:
    """The lanes of a layout behind others: its message is no longer lane 0, but lane ``len(lanes)``."""
    by = len(lanes)
    moved = (replace(lane, element=_moved(lane.element, by)) for lane in layout.lanes)
    return Layout((*lanes, *moved), tuple((lane + by, struct) for lane, struct in layout.recursive))


def _moved(slot: Slot, by: int) -> Slot:
    """A slot whose spans refer to lanes so many further on."""
    match slot:
        case Number():
            return slot
        case Span(_, lane):
            return replace(slot, lane=lane + by)
        case Row(members=members, unknown=unknown):
            kept = None if unknown is None else replace(unknown, lane=unknown.lane + by)
            return replace(slot, members=Members(replace(each, slot=_moved(each.slot, by)) for each in members), unknown=kept)
        case Variant(members=members):
            return replace(slot, members=Members(replace(each, slot=_moved(each.slot, by)) for each in members))
        case _:
            assert_never(slot)


def scalar_of(type_: types.Bool | types.Int | types.Float | types.Enum) -> str:
    """The scalar that holds a value of the type."""
    match type_:
        case types.Bool():
            return "bool"
        case types.Int(bits, signed, _):
            return f"{'i' if signed else 'u'}{bits}"
        case types.Float(bits, _):
            return f"f{bits}"
        case types.Enum():
            return "i32"


@dataclass(slots=True)
class _Building:
    """Lanes in the order in which their fields come; None while a lane's element is being laid out."""

    schema: types.Schema
    recursive: frozenset[str]
    padded: bool = False
    lanes: list[Lane | None] = field(default_factory=list[Lane | None])
    slots: int = 0
    by_key: dict[str, int] = field(default_factory=dict[str, int])
    linked: list[tuple[int, str]] = field(default_factory=list[tuple[int, str]])
    within: int = 1

    def lane(self, element: types.Type, name: str, key: str) -> int:
        """The lane for elements of a type: a new one, or that of a recursive struct which is reached through the same field.

        ``name`` is the path from the message, ``key`` that from the innermost recursive struct.
        """
        struct = element.name if isinstance(element, types.Ref) and element.name in self.recursive and self.lanes else None
        if struct is not None and key in self.by_key:
            return self.by_key[key]
        index = len(self.lanes)
        self.lanes.append(None)
        if struct is not None:
            self.by_key[key] = index
            self.linked.append((index, struct))
        slot, size = self.element(element, name, key)
        links = None
        if struct is not None:
            links = _align(size, 8)
            size = links + 8 * LINK_WORDS
        stride = _align(size, _alignment(slot))
        if stride > MAX_ROW_BYTES:
            raise ValueError(f"a row of {name or 'the message'} would take {stride} bytes")
        self.lanes[index] = Lane(name, max(stride, 1), slot, links, self.within)
        return index

    def element(self, type_: types.Type, name: str, key: str) -> tuple[Slot, int]:
        """The slot of a lane's element, and its size."""
        resolved = self.schema.resolve(type_)
        if isinstance(resolved, types.Struct):
            return self.row(resolved, 0, name, key)
        return self.slot(resolved, 0, name, key)

    def slot(self, type_: types.Type, offset: int, name: str, key: str) -> tuple[Slot, int]:
        """The slot of a type at the next suitable offset, and the offset behind it."""
        self.slots += 1
        if self.slots > MAX_SLOTS or offset > MAX_ROW_BYTES:
            raise ValueError(f"{name or 'the message'} unfolds to too many fields")
        match type_:
            case types.Bool() | types.Int() | types.Float() | types.Enum():
                scalar = scalar_of(type_)
                at = _align(offset, WIDTH[scalar])
                return Number(at, scalar), at + WIDTH[scalar]
            case types.String(encoding):
                return self.span(types.Int(16 if encoding == "utf-16" else 8, signed=False), offset, name, key)
            case types.Bytes(_, length):
                return self.span(types.Int(8, signed=False), offset, name, key, length)
            case types.Array(element, length):
                return self.span(element, offset, name, key, length)
            case types.Map(of, value):
                return self.span(map_entry(of, value), offset, name, key)
            case types.Struct():
                return self.row(type_, offset, name, key)
            case types.Union(_, cases):
                return self.variant(cases, offset, name, key)
            case types.Optional(value):
                return self.slot(value, offset, name, key)
            case types.Ref(target):
                if target in self.recursive:
                    return self.span(type_, offset, name, key)
                return self.slot(self.schema.types[target], offset, name, key)
            case _:
                assert_never(type_)

    def span(self, element: types.Type, offset: int, name: str, key: str, length: object = None) -> tuple[Span, int]:
        at, around = _align(offset, 8), self.within
        self.within *= max(length, 1) if isinstance(length, int) else 1
        lane = self.lane(element, name, key)
        self.within = around
        return Span(at, lane), at + SPAN_BYTES

    def row(self, struct: types.Struct, offset: int, name: str, key: str) -> tuple[Row, int]:
        bits = sum(isinstance(each.type, types.Optional) for each in struct.fields)
        words = (bits + 63) // 64
        start = _align(offset, 8) if struct.fields or self.padded else offset
        behind = start + 8 * words
        unknown = None
        if struct.option("unknown"):
            unknown, behind = self.span(types.Int(8, signed=False), _align(behind, 8), _join(name, UNKNOWN), _join(key, UNKNOWN))
            start = unknown.offset - 8 * words
        members: list[Member] = []
        presence = 0
        start_of_key = struct.name if struct.name in self.recursive else key
        for each in struct.fields:
            slot, behind = self.slot(each.type, behind, _join(name, each.name), _join(start_of_key, each.name))
            members.append(Member(each.name, slot, presence if isinstance(each.type, types.Optional) else None))
            presence += isinstance(each.type, types.Optional)
        if self.padded:
            behind = max(_align(behind, 8), start + 8)
        return Row(start, struct.name, words, Members(members), unknown), behind

    def variant(self, cases: tuple[types.Field, ...], offset: int, name: str, key: str) -> tuple[Variant, int]:
        start = _align(offset, 8)
        behind = start + 8
        members: list[Member] = []
        for case in cases:
            slot, behind = self.slot(case.type, behind, _join(name, case.name), _join(key, case.name))
            members.append(Member(case.name, slot))
        return Variant(start, Members(members)), _align(behind, 8) if self.padded else behind


def map_entry(key: types.Type, value: types.Type) -> types.Struct:
    """A map is an array of these."""
    return types.Struct("", (types.Field("key", key), types.Field("value", value)))


def _alignment(slot: Slot) -> int:
    return WIDTH[slot.scalar] if isinstance(slot, Number) else 8


def _align(offset: int, alignment: int) -> int:
    return -(-offset // alignment) * alignment


def _join(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name
