"""Between the rows of kernels and the fields of classes: one walk over a type, for both directions.

    fill(from, bytes, row, target)        a class gets what a decoder left in the rows
    share_WIRE(from, bytes, row, target)  it gets what a message of one of several wires fills
    collect(source, to, row)              the rows get what a class has, for an encoder

A lane is *direct* where a field of the message itself is a container of numbers or characters: kernels then work on the elements of that
container, and nothing is copied. Bytes that a decoder left in the message are copied once, from there. An encoder copies no numbers or
characters that a message has once: the lane shows the elements of their container.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from string import Template
from typing import TYPE_CHECKING, Literal

from rosetta_jit.backends.printing import Writer
from rosetta_jit.catalogue import generate as words
from rosetta_jit.errors import SchemaError
from rosetta_jit.generate.c.rows import Struct as RowStruct
from rosetta_jit.generate.c.rows import members_of
from rosetta_jit.generate.cpp.classes import names_of
from rosetta_jit.generate.cpp.names import member_names
from rosetta_jit.generate.cpp.spots import ListWithin, Spot
from rosetta_jit.generate.shares import WHOLE, Ways, within
from rosetta_jit.model.layout import Member, Number, Row, Span, Variant, map_entry
from rosetta_jit.model.types import Array, Bytes, Field, Map, Optional, Ref, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.c.lanes import Lanes
    from rosetta_jit.generate.cpp.manners import Manners
    from rosetta_jit.generate.unit import Unit

Direction = Literal["decode", "encode"]
IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


@dataclass(slots=True)
class Walk:
    """One of the functions being printed; ``in_rows`` is how many lists there are around a value, ``share`` what is set of it.

    ``within`` are the lists within lists that an encoder reads where they are, by their lanes, ``visited`` the lanes of messages that it
    reads so. ``takes``: it copies rows, whose lanes have memory of their own; ``shows`` are lanes that may show the elements of a container
    instead. ``taken`` are the lists that a decoder has put into the object already, where their elements lie in memory as rows do,
    ``straight`` the numbers, as rows would have them, ``opened`` lists and texts.
    """

    unit: Unit
    lanes: Lanes
    manners: Manners
    direction: Direction
    direct: frozenset[int] = frozenset()
    addressed: frozenset[int] = frozenset()
    within: Mapping[int, ListWithin] = field(default_factory=dict[int, ListWithin])
    visited: frozenset[int] = frozenset()
    taken: frozenset[int] = frozenset()
    straight: frozenset[str] = frozenset()
    opened: frozenset[int] = frozenset()
    takes: bool = False
    shows: set[int] = field(default_factory=set[int])
    writer: Writer = field(default_factory=Writer)
    depth: int = 0
    in_rows: int = 0
    share: Ways = WHOLE

    # --- names and templates ---------------------------------------------------------------------------------------------------------

    def text(self, kind: str, spot: Spot, **more: str) -> str:
        """A section, filled in."""
        sections = self.manners.sections()
        section = sections.get(f"{kind} {self.direction}", sections.get(kind))
        if section is None:
            raise SchemaError((words.no_manner(self.manners.name, kind, spot.field or spot.at),))
        return Template(section).substitute(at=spot.at, object=spot.owner, field=spot.field, **more)

    def lines(self, kind: str, spot: Spot, **more: str) -> None:
        for line in self.text(kind, spot, **more).splitlines():
            self.writer.line(line)

    def member_of(self, owner: str, name: str) -> Spot:
        """A field of a class."""
        return Spot(self.text("member", Spot("", owner, name)), owner, name)

    def names(self, struct: Struct) -> tuple[str, ...]:
        """The names of a struct's fields as the class has them."""
        if self.manners.type is None:
            return member_names(struct, self.unit.name, names_of(self.unit).values())
        unions = {each.name for each in struct.fields if isinstance(self.unit.schema.resolve(each.type), Union)}
        return tuple(self.named(each.name, struct.name, is_union=each.name in unions) for each in struct.fields)

    def named(self, name: str, struct: str = "", *, is_union: bool = False) -> str:
        """The name of a field of a framework's class."""
        known = dict(self.manners.renamed).get((struct, name), name)
        plain = known.lower() if self.manners.lower else known
        if not IDENTIFIER.fullmatch(plain):
            raise SchemaError((words.no_manner(self.manners.name, "member", plain),))
        return f"{plain}_" if plain in self.manners.reserved and not is_union else plain

    def local(self, what: str) -> str:
        return f"{what}_{self.depth}"

    # --- values ----------------------------------------------------------------------------------------------------------------------

    def value(self, type_: Type, slot: Number | Span | Row | Variant, element: RowStruct | str | object, row: str, spot: Spot) -> None:
        """A value and its row, whatever its type; ``element`` is what a row of it is in C."""
        resolved = self.unit.schema.resolve(type_)
        match resolved, slot:
            case _, Number():
                if row not in self.straight:
                    self.lines("number", spot, row=row)
            case Struct(), Row():
                self.struct(resolved, slot, element, row, spot)
            case Union(), Variant():
                self.union(resolved, slot, element, row, spot)
            case Struct(), Span():
                self.link(slot, row, spot)
            case Map(key, value), Span():
                with self.writer.indented("{"):
                    self.map(key, value, slot, row, spot)
                self.writer.line("}")
            case ((String() | Bytes() | Array()), Span()):
                self.sequence(resolved, slot, row, spot)
            case _:
                raise AssertionError(type_)

    def struct(self, struct: Struct, slot: Row, element: object, row: str, spot: Spot) -> None:
        """The fields of a class, one after the other."""
        assert isinstance(element, RowStruct)
        known, names, share = members_of(element), self.names(struct), self.share
        if slot.unknown is not None and () in share and "unknown decode" in self.manners.sections():
            lane, self.takes = self.lanes.rows(slot.unknown.lane), True
            self.lines("unknown", Spot(spot.at, spot.at), row=f"{row}.unknown", lane=lane)
        for each, name, member, own in zip(struct.fields, names, slot.members, known, strict=True):
            if inner := within(share, each.name):
                self.share = inner if isinstance(member.slot, Row) else WHOLE
                self.field_of(each, name, member, own.type, f"{row}.{own.identifier}", row, spot.at)
        self.share = share

    def field_of(self, each: Field, name: str, member: Member, element: object, row: str, around: str, owner: str) -> None:
        """A field, which may be absent."""
        type_, spot = each.type, self.member_of(owner, name)
        if member.presence is None:
            self.nested(type_, member, element, row, spot)
            return
        assert isinstance(type_, Optional)
        if isinstance(member.slot, Span) and isinstance(self.unit.schema.resolve(type_.value), Struct):
            self.link(member.slot, row, spot, f"rosetta_jit::detail::set_bit({around}.presence, {member.presence});")
            return
        there = f"rosetta_jit::detail::is_set({around}.presence, {member.presence})"
        if self.direction == "decode":
            with self.writer.indented(f"if ({there}) {{"):
                self.lines("optional make", spot)
                self.nested(type_.value, member, element, row, self.value_of("optional", spot))
            with self.writer.indented("} else {"):
                self.lines("optional clear", spot)
        else:
            with self.writer.indented(f"if ({self.text('optional is there', spot)}) {{"):
                self.writer.line(f"rosetta_jit::detail::set_bit({around}.presence, {member.presence});")
                self.nested(type_.value, member, element, row, self.value_of("optional", spot))
        self.writer.line("}")

    def value_of(self, kind: str, spot: Spot) -> Spot:
        """What an optional field or a pointer has."""
        return Spot(self.text(f"{kind} value", spot), spot.owner, spot.field)

    def nested(self, type_: Type, member: Member, element: object, row: str, spot: Spot) -> None:
        """A value; a class within a class gets a name, by which its fields are reached."""
        if not isinstance(member.slot, Row):
            self.value(type_, member.slot, element, row, spot)
            return
        self.depth += 1
        name = self.local("inner")
        if not member.slot.members and member.slot.unknown is None:
            self.writer.line(f"static_cast<void>({spot.at});")
        else:
            before = len(self.writer.lines)
            with self.writer.indented("{"):
                self.writer.line(f"{'' if self.direction == 'decode' else 'const '}auto &{name} = {spot.at};")
                self.value(type_, member.slot, element, row, Spot(name))
            self.writer.line("}")
            if len(self.writer.lines) == before + 3:  # all of it lies in lanes that are containers
                self.writer.lines[before:] = []
        self.depth -= 1

    def sequence(self, type_: String | Bytes | Array, slot: Span, row: str, spot: Spot) -> None:
        """Numbers, a text, bytes; or a list of anything else, element by element."""
        lane = self.lanes.rows(slot.lane)
        if slot.lane in self.direct or (self.direction == "decode" and slot.lane in self.opened):
            return
        if slot.lane in self.within or slot.lane in self.visited:
            self.lines("list within", spot, row=row)
            return
        if not isinstance(type_, Array) or isinstance(self.unit.layout.lanes[slot.lane].element, Number):
            if slot.lane in self.addressed:
                self.lines("address", spot, row=row, type=self.lanes.type(slot.lane))
                return
            if self.in_rows:
                self.takes = True
            else:
                self.shows.add(slot.lane)
            self.lines("sequence", spot, row=row, lane=lane, how="take" if self.in_rows else "show")
            return
        if slot.lane in self.taken:
            with self.writer.indented(f"if constexpr (!decltype(from.{lane})::LIES) {{"):
                self.elements(type_, slot, row, spot)
            self.writer.line("}")
            return
        self.elements(type_, slot, row, spot)

    def elements(self, type_: Array, slot: Span, row: str, spot: Spot) -> None:
        """The elements of a list, one by one. One of a fixed length may have fewer than a damaged row says."""
        lane, self.takes = self.lanes.rows(slot.lane), True
        if (texts := self._texts(type_, slot)) and self.direction == "decode":
            self.lines("texts", spot, row=row, lane=lane, texts=texts)
            return
        self.depth += 1
        if self.direction == "encode":
            with self.writer.indented("{"):
                start, count = self._take(row, slot.lane, spot)
                self._each(type_.element, slot.lane, start, count, spot)
            self.writer.line("}")
        else:
            self.lines("list", spot, row=row)
            count = f"std::min({row}.count, rosetta_jit::detail::count_of({spot.at}))"
            self._each(type_.element, slot.lane, f"{row}.start", count, spot)
        self.depth -= 1

    def _take(self, row: str, lane: int, spot: Spot) -> tuple[str, str]:
        """Rows for what a container has. They are taken before the span is set: where types contain themselves, its row may move.

        Rows of such types are emptied each by itself, when it is set.
        """
        start, count = self.local("start"), self.local("count")
        take = "take_empty" if self.unit.layout.lanes[lane].links is None else "take"
        self.lines("list", spot, row=row, lane=self.lanes.rows(lane), start=start, count=count, take=take)
        return start, count

    def _each(self, type_: Type, lane: int, start: str, count: str, spot: Spot) -> None:
        index = self.local("i")
        if self.direction == "encode":
            first = self.local("first")
            self.lines("begin", spot, first=first)
            spot = Spot(first)
        with self.writer.indented(f"for (std::int64_t {index} = 0; {index} < {count}; {index}++) {{"):
            self.row(type_, lane, f"{start} + {index}", Spot(self.text("element", spot, index=index)))
        self.writer.line("}")

    def _texts(self, type_: Array, slot: Span) -> str:
        """The lane of the texts or byte strings that a list has, if they are its elements."""
        element, is_text = self.unit.layout.lanes[slot.lane].element, isinstance(self.unit.schema.resolve(type_.element), String | Bytes)
        return self.lanes.rows(element.lane) if is_text and isinstance(element, Span) else ""

    def row(self, type_: Type, lane: int, index: str, spot: Spot) -> None:
        """One row of a lane, and the element that belongs to it."""
        self.in_rows += 1
        rows, inner, element = self.lanes.rows(lane), self.local("row"), self.lanes.all[lane].element
        slot = self.unit.layout.lanes[lane].element
        recursive = self.unit.layout.lanes[lane].links is not None
        if recursive:
            assert isinstance(element, RowStruct)
            element = element.members[0].type
        target, known = self.local("element"), inner
        if self.direction == "decode":
            self.writer.line(f"const auto &{inner} = from.{rows}.rows[{index}];")
            self.writer.line(f"auto &&{target} = {spot.at};")
        else:
            known = self._begin_row(lane, inner, index)
            self.writer.line(f"const auto &{target} = {spot.at};")
        if recursive and self.direction == "decode":
            self.writer.line(f"fill_{rows}(from, bytes, {inner}.value, {target});")
        elif recursive:
            self.writer.line(f"collect_{rows}({target}, to, {self.local('at')});")
        else:
            before = len(self.writer.lines)
            self.value(type_, slot, element, known, Spot(target))
            for unused in (known, target) if len(self.writer.lines) == before else ():
                self.writer.line(f"static_cast<void>({unused});")
        self.in_rows -= 1

    def _begin_row(self, lane: int, row: str, index: str) -> str:
        """What a row to be set is called. Where types contain themselves, what it contains may move it: it is reached by its number."""
        rows = f"to.{self.lanes.rows(lane)}.rows"
        if self.unit.layout.recursive and not self.visited:
            at = self.local("at")
            self.writer.line(f"const std::int64_t {at} = {index};")
            return f"{rows}[{at}]"
        self.writer.line(f"auto &{row} = {rows}[{index}];")
        return row

    def link(self, slot: Span, row: str, spot: Spot, present: str = "") -> None:
        """A field of a type that contains itself: no row, or one."""
        lane = slot.lane
        self.depth, self.takes = self.depth + 1, self.takes or lane not in self.visited
        type_ = Ref(next(name for number, name in self.unit.layout.recursive if number == lane))
        if self.direction == "decode":
            with self.writer.indented(f"if ({row}.count > 0) {{"):
                self.lines("link make", spot)
                self.row(type_, lane, f"{row}.start", self.value_of("link", spot))
            with self.writer.indented("} else {"):
                self.lines("link clear", spot)
        else:
            with self.writer.indented(f"if ({self.text('link is there', spot)}) {{"):
                if present:
                    self.writer.line(present)
                self._take_one(type_, lane, row, self.value_of("link", spot))
        self.writer.line("}")
        self.depth -= 1

    def _take_one(self, type_: Type, lane: int, row: str, spot: Spot) -> None:
        if lane in self.visited:
            self.lines("message within", spot, row=row)
            return
        start = self.local("start")
        self.writer.line(f"const std::int64_t {start} = rosetta_jit::detail::take(to.{self.lanes.rows(lane)}, 1);")
        self.writer.line(f"{row} = {{{start}, 1}};")
        self.row(type_, lane, start, spot)

    def map(self, key: Type, value: Type, slot: Span, row: str, spot: Spot) -> None:
        """Entries of a map: later ones of equal keys replace earlier ones."""
        self.depth, self.takes = self.depth + 1, True
        self.in_rows += 1
        lane = self.lanes.rows(slot.lane)
        entry, inner, index = map_entry(key, value), self.local("row"), self.local("i")
        element, layout = self.lanes.all[slot.lane].element, self.unit.layout.lanes[slot.lane].element
        assert isinstance(element, RowStruct)
        assert isinstance(layout, Row)
        members, (of_key, of_value) = members_of(element), layout.members
        parts = ((entry.fields[0].type, of_key, members[0], "key"), (entry.fields[1].type, of_value, members[1], "mapped"))
        if self.direction == "decode":
            self.lines("map clear", spot)
            with self.writer.indented(f"for (std::int64_t {index} = 0; {index} < {row}.count; {index}++) {{"):
                self.writer.line(f"const auto &{inner} = from.{lane}.rows[{row}.start + {index}];")
                self.writer.line(f"typename std::decay_t<decltype({spot.at})>::key_type {self.local('key')}{{}};")
                for number, (type_, member, own, what) in enumerate(parts):
                    if number:
                        self.writer.line(f"auto &{self.local('mapped')} = {self.text('map entry', spot, key=self.local('key'))};")
                    self._plain(type_, member, own.type, f"{inner}.{own.identifier}", self.local(what))
        else:
            start, _ = self._take(row, slot.lane, spot)
            self.writer.line(f"std::int64_t {index} = {start};")
            with self.writer.indented(f"for (const auto &each_{self.depth} : {spot.at}) {{"):
                known = self._begin_row(slot.lane, inner, f"{index}++")
                for (type_, member, own, _), at in zip(parts, ("first", "second"), strict=True):
                    self._plain(type_, member, own.type, f"{known}.{own.identifier}", f"each_{self.depth}.{at}")
        self.writer.line("}")
        self.in_rows -= 1
        self.depth -= 1

    def _plain(self, type_: Type, member: Member, element: object, row: str, at: str) -> None:
        """A key or value of a map: numbers are assigned, whatever setters the fields of classes have."""
        if isinstance(member.slot, Number):
            which = "set" if self.direction == "decode" else "put"
            self.writer.line(f"rosetta_jit::detail::{which}({f'{at}, {row}' if which == 'set' else f'{row}, {at}'});")
        elif isinstance(member.slot, Span) and isinstance(self.unit.schema.resolve(type_), Struct):
            self._mapped(type_, member.slot.lane, row, at)
        else:
            self.value(type_, member.slot, element, row, Spot(at))

    def _mapped(self, type_: Type, lane: int, row: str, at: str) -> None:
        """The value of an entry whose type contains the map: the entry has it itself, and no pointer to it."""
        self.depth += 1
        if self.direction == "decode":
            self.writer.line(f"{at} = std::decay_t<decltype({at})>{{}}; /* an earlier entry may have the same key */")
            with self.writer.indented(f"if ({row}.count > 0) {{"):
                self.row(type_, lane, f"{row}.start", Spot(at))
            self.writer.line("}")
        else:
            self._take_one(type_, lane, row, Spot(at))
        self.depth -= 1

    def union(self, union: Union, slot: Variant, element: object, row: str, spot: Spot) -> None:
        """The case that is set, or none."""
        assert isinstance(element, RowStruct)
        known, opened = members_of(element), False
        for number, (case, member, own) in enumerate(zip(union.cases, slot.members, known, strict=True), 1):
            more = {"case": self.named(case.name), "number": str(number)}
            there = f"{row}.which == {number}" if self.direction == "decode" else self.text("case is there", spot, **more)
            with self.writer.indented(f"{'} else ' if opened else ''}if ({there}) {{"):
                if self.direction == "decode":
                    self.lines("case make", spot, **more)
                else:
                    self.writer.line(f"{row}.which = {number};")
                self.nested(case.type, member, own.type, f"{row}.{own.identifier}", self.case(spot, more))
            opened = True
        if self.direction == "decode":
            with self.writer.indented("} else {" if opened else "{"):
                self.lines("union clear", spot)
        if opened or self.direction == "decode":
            self.writer.line("}")

    def case(self, spot: Spot, more: dict[str, str]) -> Spot:
        """The value of a union that has this case."""
        if f"case {self.direction}" in self.manners.sections():
            return Spot(self.text("case", spot, **more))
        return self.member_of(spot.owner, more["case"])
