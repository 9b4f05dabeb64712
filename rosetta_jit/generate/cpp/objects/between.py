"""Between the rows of kernels and the fields of classes: functions that fill the ones from the others, for both directions.

    fill(from, bytes, row, target)        a class gets what a decoder left in the rows
    share_WIRE(from, bytes, row, target)  it gets what a message of one of several wires fills
    collect(source, to, row)              the rows get what a class has, for an encoder

Bytes that a decoder left in the message are copied once, from there. An encoder copies no numbers or characters that a message has once:
the lane shows the elements of their container.
"""

from __future__ import annotations

from rosetta_jit.generate.c.holder.rows import Struct as RowStruct
from rosetta_jit.generate.c.holder.rows import members_of
from rosetta_jit.generate.cpp.objects.spots import Spot
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.generate.shares import WHOLE, within
from rosetta_jit.model.layout import Member, Number, Row, Span, Variant, map_entry
from rosetta_jit.model.types import Array, Bytes, Field, Map, Optional, Ref, String, Struct, Type, Union


def between(walk: Walk, type_: Type, slot: Number | Span | Row | Variant, element: RowStruct | str | object, row: str, spot: Spot) -> None:
    """A value and its row, whatever its type; ``element`` is what a row of it is in C."""
    resolved = walk.unit.schema.resolve(type_)
    match resolved, slot:
        case _, Number():
            if row not in walk.straight:
                walk.lines("number", spot, row=row)
        case Struct(), Row():
            _of_struct(walk, resolved, slot, element, row, spot)
        case Union(), Variant():
            _of_union(walk, resolved, slot, element, row, spot)
        case Struct(), Span():
            _link(walk, slot, row, spot)
        case Map(key, value), Span():
            with walk.writer.indented("{"):
                _entries(walk, key, value, slot, row, spot)
            walk.writer.line("}")
        case ((String() | Bytes() | Array()), Span()):
            _sequence(walk, resolved, slot, row, spot)
        case _:
            raise AssertionError(type_)


def _of_struct(walk: Walk, struct: Struct, slot: Row, element: object, row: str, spot: Spot) -> None:
    """The fields of a class, one after the other."""
    assert isinstance(element, RowStruct)
    known, names, share = members_of(element), walk.names(struct), walk.share
    if slot.unknown is not None and () in share and "unknown decode" in walk.manners.sections():
        lane, walk.takes = walk.lanes.rows(slot.unknown.lane), True
        walk.lines("unknown", Spot(spot.at, spot.at), row=f"{row}.unknown", lane=lane)
    for each, name, member, own in zip(struct.fields, names, slot.members, known, strict=True):
        if inner := within(share, each.name):
            walk.share = inner if isinstance(member.slot, Row) else WHOLE
            _of_field(walk, each, name, member, own.type, f"{row}.{own.identifier}", row, spot.at)
    walk.share = share


def _of_field(walk: Walk, each: Field, name: str, member: Member, element: object, row: str, around: str, owner: str) -> None:
    """A field, which may be absent."""
    type_, spot = each.type, walk.member_of(owner, name)
    if member.presence is None:
        _nested(walk, type_, member, element, row, spot)
        return
    assert isinstance(type_, Optional)
    if isinstance(member.slot, Span) and isinstance(walk.unit.schema.resolve(type_.value), Struct):
        walk.demand("optional clear", spot)
        _link(walk, member.slot, row, spot, f"rosetta_jit::detail::set_bit({around}.presence, {member.presence});")
        return
    there = f"rosetta_jit::detail::is_set({around}.presence, {member.presence})"
    if walk.direction == "decode":
        with walk.writer.indented(f"if ({there}) {{"):
            walk.lines("optional make", spot)
            _nested(walk, type_.value, member, element, row, walk.value_of("optional", spot))
        with walk.writer.indented("} else {"):
            walk.lines("optional clear", spot)
    else:
        with walk.writer.indented(f"if ({walk.text('optional is there', spot)}) {{"):
            walk.writer.line(f"rosetta_jit::detail::set_bit({around}.presence, {member.presence});")
            _nested(walk, type_.value, member, element, row, walk.value_of("optional", spot))
    walk.writer.line("}")


def _nested(walk: Walk, type_: Type, member: Member, element: object, row: str, spot: Spot) -> None:
    """A value; a class within a class gets a name, by which its fields are reached."""
    if not isinstance(member.slot, Row):
        between(walk, type_, member.slot, element, row, spot)
        return
    walk.depth += 1
    name = walk.local("inner")
    if not member.slot.members and member.slot.unknown is None:
        walk.writer.line(f"static_cast<void>({spot.at});")
    else:
        before = len(walk.writer.lines)
        with walk.writer.indented("{"):
            walk.writer.line(f"{'' if walk.direction == 'decode' else 'const '}auto &{name} = {spot.at};")
            between(walk, type_, member.slot, element, row, Spot(name))
        walk.writer.line("}")
        if len(walk.writer.lines) == before + 3:  # all of it lies in lanes that are containers
            walk.writer.lines[before:] = []
    walk.depth -= 1


def _sequence(walk: Walk, type_: String | Bytes | Array, slot: Span, row: str, spot: Spot) -> None:
    """Numbers, a text, bytes; or a list of anything else, element by element."""
    lane = walk.lanes.rows(slot.lane)
    if slot.lane in walk.direct or (walk.direction == "decode" and slot.lane in walk.opened | walk.visited):
        return
    if slot.lane in walk.within or slot.lane in walk.visited:
        walk.lines("list within", spot, row=row)
        return
    if not isinstance(type_, Array) or isinstance(walk.unit.layout.lanes[slot.lane].element, Number):
        if slot.lane in walk.addressed:
            walk.lines("address", spot, row=row, type=walk.lanes.type(slot.lane))
            return
        if walk.in_rows:
            walk.takes = True
        else:
            walk.shows.add(slot.lane)
        walk.lines("sequence", spot, row=row, lane=lane, how="take" if walk.in_rows else "show")
        return
    if slot.lane in walk.taken:
        with walk.writer.indented(f"if constexpr (!decltype(from.{lane})::LIES) {{"):
            _elements(walk, type_, slot, row, spot)
        walk.writer.line("}")
        return
    _elements(walk, type_, slot, row, spot)


def _elements(walk: Walk, type_: Array, slot: Span, row: str, spot: Spot) -> None:
    """The elements of a list, one by one. One of a fixed length may have fewer than a damaged row says."""
    lane, walk.takes = walk.lanes.rows(slot.lane), True
    if (texts := _texts(walk, type_, slot)) and walk.direction == "decode":
        walk.lines("texts", spot, row=row, lane=lane, texts=texts)
        return
    walk.depth += 1
    if walk.direction == "encode":
        with walk.writer.indented("{"):
            start, count = _take_rows(walk, row, slot.lane, spot)
            _each(walk, type_.element, slot.lane, start, count, spot)
        walk.writer.line("}")
    else:
        walk.lines("list", spot, row=row)
        count = f"std::min({row}.count, rosetta_jit::detail::count_of({spot.at}))"
        _each(walk, type_.element, slot.lane, f"{row}.start", count, spot)
    walk.depth -= 1


def _take_rows(walk: Walk, row: str, lane: int, spot: Spot) -> tuple[str, str]:
    """Rows for what a container has. They are taken before the span is set: where types contain themselves, its row may move.

    Rows of such types are emptied each by itself, when it is set.
    """
    start, count = walk.local("start"), walk.local("count")
    take = "take_empty" if walk.unit.layout.lanes[lane].links is None else "take"
    walk.lines("list", spot, row=row, lane=walk.lanes.rows(lane), start=start, count=count, take=take)
    return start, count


def _each(walk: Walk, type_: Type, lane: int, start: str, count: str, spot: Spot) -> None:
    """Rows from ``start`` on, and the elements that belong to them."""
    index, begin = walk.local("i"), "0"
    if walk.direction == "encode":
        first = walk.local("first")
        walk.lines("begin", spot, first=first)
        spot = Spot(first)
    else:
        begin, count = f"0, {walk.local('count')} = {count}", walk.local("count")
    with walk.writer.indented(f"for (std::int64_t {index} = {begin}; {index} < {count}; {index}++) {{"):
        _of_row(walk, type_, lane, f"{start} + {index}", Spot(walk.text("element", spot, index=index)))
    walk.writer.line("}")


def _texts(walk: Walk, type_: Array, slot: Span) -> str:
    """The lane of the texts or byte strings that a list has, if they are its elements."""
    element, is_text = walk.unit.layout.lanes[slot.lane].element, isinstance(walk.unit.schema.resolve(type_.element), String | Bytes)
    return walk.lanes.rows(element.lane) if is_text and isinstance(element, Span) else ""


def _of_row(walk: Walk, type_: Type, lane: int, index: str, spot: Spot) -> None:
    """One row of a lane, and the element that belongs to it."""
    walk.in_rows += 1
    rows, inner, element = walk.lanes.rows(lane), walk.local("row"), walk.lanes.all[lane].element
    slot = walk.unit.layout.lanes[lane].element
    recursive = walk.unit.layout.lanes[lane].links is not None
    if recursive:
        assert isinstance(element, RowStruct)
        element = element.members[0].type
    target, known = walk.local("element"), inner
    if walk.direction == "decode":
        walk.writer.line(f"const auto &{inner} = from.{rows}.rows[{index}];")
        walk.writer.line(f"auto &&{target} = {spot.at};")
    else:
        known = _begin_row(walk, lane, inner, index)
        walk.writer.line(f"const auto &{target} = {spot.at};")
    if recursive and walk.direction == "decode":
        walk.writer.line(f"fill_{rows}(from, bytes, {inner}.value, {target});")
    elif recursive:
        walk.writer.line(f"collect_{rows}({target}, to, {walk.local('at')});")
    else:
        before = len(walk.writer.lines)
        between(walk, type_, slot, element, known, Spot(target))
        for unused in (known, target) if len(walk.writer.lines) == before else ():
            walk.writer.line(f"static_cast<void>({unused});")
    walk.in_rows -= 1


def _begin_row(walk: Walk, lane: int, row: str, index: str) -> str:
    """What a row to be set is called. Where types contain themselves, what it contains may move it: it is reached by its number."""
    rows = f"to.{walk.lanes.rows(lane)}.rows"
    if walk.unit.layout.recursive and not walk.visited:
        at = walk.local("at")
        walk.writer.line(f"const std::int64_t {at} = {index};")
        return f"{rows}[{at}]"
    walk.writer.line(f"auto &{row} = {rows}[{index}];")
    return row


def _link(walk: Walk, slot: Span, row: str, spot: Spot, present: str = "") -> None:
    """A field of a type that contains itself: no row, or one."""
    lane = slot.lane
    walk.depth, walk.takes = walk.depth + 1, walk.takes or lane not in walk.visited
    type_ = Ref(next(name for number, name in walk.unit.layout.recursive if number == lane))
    if walk.direction == "decode":
        with walk.writer.indented(f"if ({row}.count > 0) {{"):
            walk.lines("link make", spot)
            _of_row(walk, type_, lane, f"{row}.start", walk.value_of("link", spot))
        with walk.writer.indented("} else {"):
            walk.lines("link clear", spot)
    else:
        with walk.writer.indented(f"if ({walk.text('link is there', spot)}) {{"):
            if present:
                walk.writer.line(present)
            _take_one(walk, type_, lane, row, walk.value_of("link", spot))
    walk.writer.line("}")
    walk.depth -= 1


def _take_one(walk: Walk, type_: Type, lane: int, row: str, spot: Spot) -> None:
    """The row of a message within another, or its address."""
    if lane in walk.visited:
        walk.lines("message within", spot, row=row)
        return
    start = walk.local("start")
    walk.writer.line(f"const std::int64_t {start} = rosetta_jit::detail::take(to.{walk.lanes.rows(lane)}, 1);")
    walk.writer.line(f"{row} = {{{start}, 1}};")
    _of_row(walk, type_, lane, start, spot)


def _entries(walk: Walk, key: Type, value: Type, slot: Span, row: str, spot: Spot) -> None:
    """Entries of a map: later ones of equal keys replace earlier ones."""
    walk.depth, walk.takes = walk.depth + 1, True
    walk.in_rows += 1
    lane = walk.lanes.rows(slot.lane)
    entry, inner, index = map_entry(key, value), walk.local("row"), walk.local("i")
    element, layout = walk.lanes.all[slot.lane].element, walk.unit.layout.lanes[slot.lane].element
    assert isinstance(element, RowStruct)
    assert isinstance(layout, Row)
    members, (of_key, of_value) = members_of(element), layout.members
    parts = ((entry.fields[0].type, of_key, members[0], "key"), (entry.fields[1].type, of_value, members[1], "mapped"))
    if walk.direction == "decode":
        walk.lines("map clear", spot)
        with walk.writer.indented(f"for (std::int64_t {index} = 0; {index} < {row}.count; {index}++) {{"):
            walk.writer.line(f"const auto &{inner} = from.{lane}.rows[{row}.start + {index}];")
            walk.writer.line(f"typename std::decay_t<decltype({spot.at})>::key_type {walk.local('key')}{{}};")
            for number, (type_, member, own, what) in enumerate(parts):
                if number:
                    found = walk.text("map entry", spot, key=f"std::move({walk.local('key')})")
                    walk.writer.line(f"auto &{walk.local('mapped')} = {found};")
                _plain(walk, type_, member, own.type, f"{inner}.{own.identifier}", walk.local(what))
    else:
        start, _ = _take_rows(walk, row, slot.lane, spot)
        walk.writer.line(f"std::int64_t {index} = {start};")
        with walk.writer.indented(f"for (const auto &each_{walk.depth} : {spot.at}) {{"):
            known = _begin_row(walk, slot.lane, inner, f"{index}++")
            for (type_, member, own, _), at in zip(parts, ("first", "second"), strict=True):
                _plain(walk, type_, member, own.type, f"{known}.{own.identifier}", f"each_{walk.depth}.{at}")
    walk.writer.line("}")
    walk.in_rows -= 1
    walk.depth -= 1


def _plain(walk: Walk, type_: Type, member: Member, element: object, row: str, at: str) -> None:
    """A key or value of a map: numbers are assigned, whatever setters the fields of classes have."""
    if isinstance(member.slot, Number):
        which = "set" if walk.direction == "decode" else "put"
        walk.writer.line(f"rosetta_jit::detail::{which}({f'{at}, {row}' if which == 'set' else f'{row}, {at}'});")
    elif isinstance(member.slot, Span) and isinstance(walk.unit.schema.resolve(type_), Struct):
        _mapped(walk, type_, member.slot.lane, row, at)
    else:
        between(walk, type_, member.slot, element, row, Spot(at))


def _mapped(walk: Walk, type_: Type, lane: int, row: str, at: str) -> None:
    """The value of an entry whose type contains the map: the entry has it itself, and no pointer to it."""
    walk.depth += 1
    if walk.direction == "decode":
        with walk.writer.indented(f"if ({row}.count > 0) {{"):
            _of_row(walk, type_, lane, f"{row}.start", Spot(at))
        with walk.writer.indented("} else { /* an earlier entry may have the same key */"):
            walk.writer.line(f"{at} = std::decay_t<decltype({at})>{{}};")
        walk.writer.line("}")
    else:
        _take_one(walk, type_, lane, row, Spot(at))
    walk.depth -= 1


def _of_union(walk: Walk, union: Union, slot: Variant, element: object, row: str, spot: Spot) -> None:
    """The case that is set, or none."""
    assert isinstance(element, RowStruct)
    known, opened = members_of(element), False
    for number, (case, member, own) in enumerate(zip(union.cases, slot.members, known, strict=True), 1):
        more = {"case": walk.named(case.name), "number": str(number)}
        there = f"{row}.which == {number}" if walk.direction == "decode" else walk.text("case is there", spot, **more)
        with walk.writer.indented(f"{'} else ' if opened else ''}if ({there}) {{"):
            if walk.direction == "decode":
                walk.lines("case make", spot, **more)
            else:
                walk.writer.line(f"{row}.which = {number};")
            _nested(walk, case.type, member, own.type, f"{row}.{own.identifier}", walk.case(spot, more))
        opened = True
    if walk.direction == "decode":
        with walk.writer.indented("} else {" if opened else "{"):
            walk.lines("union clear", spot)
    if opened or walk.direction == "decode":
        walk.writer.line("}")
