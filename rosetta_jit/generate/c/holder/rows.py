"""Rows of lanes as structs of C: the same fields at the same bytes, whatever the compiler.

    Struct = identifier, Member*            Member = identifier, offset, Scalar [many] | SPAN | Struct

All gaps are members of their own. Numbers lie at multiples of their size, so that no compiler adds any. A bool is a byte: what comes from
a message may have other values than 0 and 1, which a C `bool` must not.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from itertools import count
from typing import assert_never

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.generate.c.words import RESERVED, of_unit
from rosetta_jit.kernel.nodes import WIDTH
from rosetta_jit.model.layout import LINK_WORDS, SPAN_BYTES, Lane, Layout, Members, Number, Row, Slot, Span, Variant
from rosetta_jit.startup.dataclass import dataclass, field, replace

OWN_WORDS = frozenset({"presence", "which", "unknown", "links", "nothing", "value"})
PADDING = re.compile(r"padding_?\d*")
NOT_FIELDS = frozenset({"presence", "unknown", "which", "nothing", "links"})
"""Members of structs that stand for no field, besides padding."""


@dataclass(frozen=True, slots=True)
class SpanType:
    """Start and count of the elements of an array."""


SPAN = SpanType()


@dataclass(frozen=True, slots=True)
class Member:
    """A member of a struct; ``many`` is how many scalars an array has, ``presence`` the bit that says whether it is there.

    The elements of a span are in one of ``lanes``: a struct that stands in several places has a lane for each of these.
    """

    identifier: str
    offset: int
    type: str | SpanType | Struct
    many: int | None = None
    comment: str = ""
    presence: int | None = None
    lanes: tuple[int, ...] = field(default=(), compare=False)

    @property
    def size(self) -> int:
        """Bytes that it takes."""
        match self.type:
            case str():
                return WIDTH[self.type] * (self.many or 1)
            case SpanType():
                return SPAN_BYTES
            case Struct():
                return self.type.size


@dataclass(frozen=True, slots=True)
class Struct:
    """A struct; ``shown`` is its name in the schema, ``cases`` are those of a union."""

    identifier: str
    shown: str
    size: int
    members: tuple[Member, ...]
    cases: tuple[str, ...] = ()


Element = str | SpanType | Struct
"""What a row of a lane is: a scalar, a span, or a struct."""


def members_of(struct: Struct) -> list[Member]:
    """Those of a row's struct that stand for fields, in order."""
    return [each for each in struct.members if each.identifier not in NOT_FIELDS and not (PADDING.fullmatch(each.identifier) and each.many)]


@dataclass(slots=True)
class Structs:
    """The structs of a layout, each before those that contain it; ``said`` is what the schema says of fields, by struct and name."""

    prefix: str
    names: Namespace
    said: Mapping[tuple[str, str], str]
    made: dict[tuple[object, ...], Struct] = field(default_factory=dict[tuple[object, ...], "Struct"])

    def element(self, lane: Lane, path: str) -> Element:
        """The type of a lane's rows."""
        element = self._type(lane.element, path)
        if lane.links is None:
            return element
        assert isinstance(element, Struct)
        value = Member("value", 0, element)
        links = Member("links", lane.links, "i64", LINK_WORDS, "for the functions of this file alone")
        return self._struct(f"{path}_row", f"a row of {lane.name}", [value, links], lane.stride)

    def _type(self, slot: Slot, path: str) -> Element:
        match slot:
            case Number(_, scalar):
                return scalar
            case Span():
                return SPAN
            case Row():
                return self._row(slot, path)
            case Variant():
                return self._variant(slot, path)
            case _:
                assert_never(slot)

    def _row(self, row: Row, path: str) -> Struct:
        names = self._scope(row.members)
        members: list[Member] = []
        if row.presence_words:
            members.append(Member("presence", 0, "u64", row.presence_words, "a bit for each field that may be absent"))
        if row.unknown is not None:
            comment = "fields that the schema does not know, as they came"
            members.append(Member("unknown", row.unknown.offset - row.offset, SPAN, comment=comment, lanes=(row.unknown.lane,)))
        for each in row.members:
            identifier = _own(names.identifier(each.name))
            member = self._member(identifier, each.slot, row.offset, f"{path}_{each.name}", each.presence)
            members.append(replace(member, comment=self.said.get((row.struct, each.name), "")))
        if not members:
            members.append(Member("nothing", 0, "u8", 8, "C has no empty struct"))
        simple = re.split(r"[./:]+", row.struct)[-1]
        return self._struct(simple or path, row.struct, members, None)

    def _variant(self, variant: Variant, path: str) -> Struct:
        names = self._scope(variant.members)
        members = [Member("which", 0, "i64", comment="0, or 1 + the number of the case")]
        members += [
            self._member(_own(names.identifier(each.name)), each.slot, variant.offset, f"{path}_{each.name}", None)
            for each in variant.members
        ]
        cases = tuple(member.identifier for member in members[1:])
        return self._struct(f"{path}_union", f"one of the cases of {path}", members, None, cases)

    def _scope(self, fields: Members) -> Namespace:
        """Where a struct's members get their names."""
        return Namespace(RESERVED | OWN_WORDS | of_unit(self.prefix, (each.name for each in fields)))

    def _member(self, identifier: str, slot: Slot, base: int, path: str, presence: int | None) -> Member:
        lanes = (slot.lane,) if isinstance(slot, Span) else ()
        return Member(identifier, slot.offset - base, self._type(slot, path), presence=presence, lanes=lanes)

    def _struct(self, name: str, shown: str, members: list[Member], size: int | None, cases: tuple[str, ...] = ()) -> Struct:
        """The struct of such members, which is made once, whichever lanes they refer to."""
        complete = _without_gaps(members, size)
        key = (shown, tuple((each.identifier, each.offset, each.type, each.many, each.presence) for each in complete), cases)
        if (found := self.made.get(key)) is None:
            end = complete[-1].offset + complete[-1].size
            self.made[key] = Struct(self._named(f"{self.prefix}_{name}"), shown, end, complete, cases)
        else:
            self.made[key] = replace(found, members=tuple(map(_in_all_lanes, found.members, complete)))
        return self.made[key]

    def _named(self, wanted: str) -> str:
        """An identifier that no other struct has: types of one name may differ, as in several packages."""
        taken = {struct.identifier for struct in self.made.values()}
        candidates = (self.names.identifier(wanted if number == 1 else f"{wanted}_{number}") for number in count(1))
        return next(each for each in candidates if each not in taken)


def _in_all_lanes(member: Member, other: Member) -> Member:
    """A member with its own lanes and those of the same one in another place."""
    lanes = tuple(dict.fromkeys((*member.lanes, *other.lanes)))
    return member if lanes == member.lanes else replace(member, lanes=lanes)


def _own(identifier: str) -> str:
    """A member whose name no padding has."""
    return f"{identifier}_" if PADDING.fullmatch(identifier) else identifier


def _without_gaps(members: list[Member], size: int | None) -> tuple[Member, ...]:
    """The members with padding between them, up to a whole number of words."""
    found: list[Member] = []
    at = 0
    for each in members:
        if each.offset > at:
            found.append(Member(f"padding_{len(found)}", at, "u8", each.offset - at))
        found.append(each)
        at = each.offset + each.size
    end = -(-at // 8) * 8 if size is None else size
    if end > at:
        found.append(Member(f"padding_{len(found)}", at, "u8", end - at))
    return tuple(found)


def path_to(element: Element, offset: int, scalar: str) -> str | None:
    """How a scalar at a byte of a row is written behind the row, None if the row has no such member."""
    match element:
        case str():
            return "" if offset == 0 and element == scalar else None
        case SpanType():
            return {(0, "i64"): ".start", (8, "i64"): ".count"}.get((offset, scalar))
        case Struct():
            member = next((each for each in element.members if each.offset <= offset < each.offset + each.size), None)
            return None if member is None else _through(member, offset - member.offset, scalar)
        case _:
            assert_never(element)


def _through(member: Member, offset: int, scalar: str) -> str | None:
    if member.many is not None:
        index, rest = divmod(offset, WIDTH[scalar])
        return f".{member.identifier}[{index}]" if rest == 0 and member.type == scalar else None
    inner = path_to(member.type, offset, scalar)
    return None if inner is None else f".{member.identifier}{inner}"


def paths_of(element: Element | None, offset: int = 0) -> Iterator[tuple[int, str]]:
    """The scalars of a row: where each lies, and how it is written behind the row."""
    match element:
        case None:
            return
        case str():
            yield offset, ""
        case SpanType():
            yield from ((offset, ".start"), (offset + 8, ".count"))
        case Struct():
            for member in element.members:
                at, name = offset + member.offset, f".{member.identifier}"
                if member.many is None:
                    yield from ((inner, name + path) for inner, path in paths_of(member.type, at))
                else:
                    step = member.size // member.many
                    yield from ((at + index * step, f"{name}[{index}]") for index in range(member.many))
        case _:
            assert_never(element)


def elements_of(layout: Layout, structs: Structs, names: tuple[str, ...]) -> tuple[Element, ...]:
    """The types of all lanes' rows."""
    return tuple(structs.element(lane, name) for lane, name in zip(layout.lanes, names, strict=True))
