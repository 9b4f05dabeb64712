"""Objects made of the rows of kernels: an expression for each."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from rosetta_jit.generate.python.passes.slots import lanes_within
from rosetta_jit.generate.python.printing.classes import first_value
from rosetta_jit.generate.python.printing.scope import CODES, Scope, view_name
from rosetta_jit.generate.unit import Unit
from rosetta_jit.model.layout import WIDTH, Member, Number, Row, Slot, Span, Variant, map_entry
from rosetta_jit.model.types import Array, Bytes, Field, Map, Optional, Ref, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass, replace

_HOW = {"utf-8": "", "octets": '"utf-8", "surrogateescape"'}
"""How texts are decoded: those that were checked, and others."""


MANY_NUMBERS = 6
"""Numbers of a row from which on one call that reads all of them takes less time than as many that read one."""


@dataclass(slots=True)
class Make:
    """Expressions for objects; ``names`` are the classes, ``reserved`` the lanes of which the kernel takes rows: others stay empty.

    ``functions`` are those that make lists and maps of the message out of rows, by their text: a comprehension within the decoder would
    make its locals slower. Without them these stand where they are used.

    ``absent`` are lists of rows that have no element, by lane and offset.
    """

    unit: Unit
    scope: Scope
    names: Mapping[str, str]
    reserved: frozenset[int]
    functions: dict[str, str] | None = None
    depth: int = 0
    absent: frozenset[tuple[int, int]] = frozenset()

    def value(self, type_: Type, slot: Slot, lane: int, row: str) -> str:
        """The value at a slot of a row."""
        resolved = self.unit.schema.resolve(type_)
        match resolved, slot:
            case _, Number(offset, scalar):
                text = self.scope.field(lane, row, offset, scalar)
                return f"{text} != 0" if scalar == "bool" and not self._is_bool(lane, text) else text
            case Struct(), Row():
                return self.struct(resolved, slot, lane, row)
            case Union(), Variant():
                return self.union(resolved, slot, lane, row)
            case Struct(name), Span():
                return self.linked(type_, slot, lane, row, f"{self.names[name]}()")
            case ((String() | Bytes() | Array() | Map()), Span()):
                return self.sequence(resolved, slot, lane, row)
            case _:
                raise AssertionError(type_)

    def _is_bool(self, lane: int, text: str) -> bool:
        """Whether the field of a row is a local that has a bool."""
        return text in self.scope.bools or lane in self.scope.direct.appended

    def linked(self, type_: Type, slot: Span, lane: int, row: str, instead: str) -> str:
        """A message of a type that contains itself; ``instead`` where it has no row: as the value of a map's entry that gives none."""
        return f"{self.row(type_, slot.lane, self.start_of(slot, lane, row))} if {self.count_of(slot, lane, row)} else {instead}"

    def start_of(self, slot: Span, lane: int, row: str) -> str:
        if self.scope.direct.late_at(slot) is not None:
            return "0"
        return self.scope.field(lane, row, slot.offset, "i64")

    def count_of(self, slot: Span, lane: int, row: str) -> str:
        if self.scope.direct.late_at(slot) is not None:
            return self.scope.used(slot.lane)
        return self.scope.field(lane, row, slot.offset + 8, "i64")

    def count(self, slot: Span) -> str:
        """What is true where a sequence of the message has elements; nothing where it is an object already."""
        direct = self.scope.direct
        if (late := direct.late_at(slot)) is not None:
            return self.scope.has_field(late.name)
        known = {*direct.whole, *direct.appended, *direct.elements, *direct.rows}
        places = {*direct.pieces, *direct.texts}
        is_known = slot.lane in known or (0, slot.offset) in places or direct.visit_at(0, slot.offset) is not None
        return "" if is_known else self.count_of(slot, 0, "0")

    def unknown(self, slot: Span, lane: int, row: str) -> str:
        """The fields that the schema does not know."""
        if (lane, slot.offset) in self.absent:
            return 'b""'
        late, count = self.scope.direct.late_at(slot), self.count_of(slot, lane, row)
        there = count if late is None else self.scope.has_field(late.name)
        return f'{self._text("_bytes", slot, self.start_of(slot, lane, row), count)} if {there} else b""'

    def first(self, each: Field) -> str:
        """The value of a field that nothing has set."""
        return first_value(each.type, self.names, self.unit)

    def struct(self, struct: Struct, slot: Row, lane: int, row: str) -> str:
        arguments = [self.member(each, member, slot, lane, row) for each, member in zip(struct.fields, slot.members, strict=True)]
        if slot.unknown is not None:
            arguments.append(self.unknown(slot.unknown, lane, row))
        return f"{self.names[struct.name]}({', '.join(arguments)})"

    def member(self, each: Field, member: Member, slot: Row, lane: int, row: str) -> str:
        """The value of a field of the struct at a slot; it may be absent."""
        if member.presence is None:
            match self.unit.schema.resolve(each.type), member.slot:
                case Struct(), Span() as link:
                    return self.linked(each.type, link, lane, row, "None")
                case _, Span() as span if (late := self.scope.direct.late_at(span)) is not None:
                    value = self.value(each.type, span, lane, row)
                    return f"{value} if {self.scope.has_field(late.name)} else {self._nothing(each.type, span)}"
                case _:
                    return self.value(each.type, member.slot, lane, row)
        assert isinstance(each.type, Optional)
        there = self.is_there(member, slot, lane, row)
        return f"({self.value(each.type.value, member.slot, lane, row)}) if {there} else None"

    def _nothing(self, type_: Type, slot: Span) -> str:
        """A list or a map without elements."""
        element = self.unit.layout.lanes[slot.lane].element
        if isinstance(element, Number) and self.unit.numpy:
            return self.scope.no_numbers(element.scalar)
        return "{}" if isinstance(self.unit.schema.resolve(type_), Map) else "[]"

    def is_there(self, member: Member, slot: Row, lane: int, row: str) -> str:
        """Whether a row has a field that may be absent."""
        assert member.presence is not None
        if (late := self.scope.direct.late_at(member.slot)) is not None and late.is_presence:
            return self.scope.has_field(late.name)
        word, bit = divmod(member.presence, 64)
        return f"{self.scope.field(lane, row, slot.offset + 8 * word, 'u64')} & {1 << bit}"

    def union(self, union: Union, slot: Variant, lane: int, row: str) -> str:
        which = self.scope.field(lane, row, slot.offset, "i64")
        cases = [
            f'("{each.name}", {self.value(each.type, member.slot, lane, row)}) if {which} == {number} else '
            for number, (each, member) in enumerate(zip(union.cases, slot.members, strict=True), 1)
        ]
        return f"({''.join(cases)}None)"

    def _text(self, function: str, slot: Span, start: str, count: str) -> str:
        return f"{function}({self.scope.view(slot.lane, '')}, data, {start}, {count})"

    def sequence(self, type_: String | Bytes | Array | Map, slot: Span, lane: int, row: str) -> str:
        if (lane, slot.offset) in self.absent:
            return self._nothing(type_, slot)
        known = self._direct(type_, slot, lane, row)
        if known is not None:
            return known
        start, count = self.start_of(slot, lane, row), self.count_of(slot, lane, row)
        if slot.lane in self.scope.direct.gathered:
            return f"{self.scope.lanes.rows(slot.lane)}[{start} : {start} + {count}]"
        if lane == 0 and self.functions is not None:
            elements = self._by_function(self.functions, type_, slot, start, count)
        else:
            elements = self.elements(type_, slot, lane, start, count)
        is_late = lane == 0 and self.scope.direct.late_at(slot) is not None
        if isinstance(type_, Array | Map) and not is_late:
            return f"({elements} if {count} else {self._nothing(type_, slot)})"
        return elements

    def _by_function(self, functions: dict[str, str], type_: String | Bytes | Array | Map, slot: Span, start: str, count: str) -> str:
        """A sequence of the message, by a function where that takes a comprehension."""
        inner = replace(self.scope, views=set[tuple[int, str]]())
        make = replace(self, scope=inner, functions=None)
        text = make.elements(type_, slot, 0, start, count)
        if " for " not in text:
            self.scope.views |= inner.views
            return text
        text = make.one_by_one(type_, slot.lane, count) or f"    return {text}\n"
        self.scope.views |= inner.views
        lanes, direct = lanes_within(slot, self.unit.layout), self.scope.direct
        needs = {view_name(self.scope.lanes, *view) for view in inner.views}
        needs |= {self.scope.lanes.rows(each) for each in lanes & direct.gathered.keys()}
        needs |= {self.scope.placed(*span) for span in direct.placed if span[0] in lanes}
        needs |= {each for each in (start, count) if each.isidentifier()}
        arguments = ", ".join([*(["data"] if re.search(r"\bdata\b", text) else []), *sorted(needs)])
        own = f"_made_{self.scope.lanes.rows(slot.lane)}"
        own = own if own not in functions.values() else f"{own}_{len(functions)}"
        name = functions.setdefault(f"({arguments}):\n{text}", own)
        return f"{name}({arguments})"

    def elements(self, type_: String | Bytes | Array | Map, slot: Span, lane: int, start: str, count: str) -> str:
        """Those of a sequence, from rows of its lane."""
        element = self.unit.layout.lanes[slot.lane].element
        match type_:
            case String("utf-16"):
                return f"_text16({self.scope.view(slot.lane, '')}, {start}, {count})"
            case String(encoding):
                if slot.lane not in self.reserved:
                    text = f"data[{start} : {start} - 1 - {count}].decode({_HOW[encoding]})"
                    return f'{text} if {count} else ""'
                return self._text("_text", slot, start, count)
            case Bytes():
                inside = slot.lane not in self.reserved
                return f"data[{start} : {start} - 1 - {count}] if {count} else b''" if inside else self._text("_bytes", slot, start, count)
            case Array() if isinstance(element, Number):
                return self._array_of_numbers(element.scalar, slot, start, count)
            case Array(inner) if self._is_borrowed(inner, slot.lane):
                assert isinstance(inner, String)
                return self._texts(inner, slot, start, count)
            case Array(String("utf-8" | "octets")) if lane == 0 and isinstance(element, Span):
                text_lane, rows = self.scope.view(element.lane, ""), self.scope.view(slot.lane, "q")
                return f"_texts({text_lane}, data, {rows}[{_rows(start, count, 2)}])"
            case Array(inner):
                return f"[{self._each(lambda index: self.row(inner, slot.lane, index), slot.lane, start, count)}]"
            case Map(key, value):
                assert isinstance(element, Row)
                pair = [(each.type, member.slot) for each, member in zip(map_entry(key, value).fields, element.members, strict=True)]

                def entry(index: str) -> str:
                    return ": ".join(self.value(*each, slot.lane, index) for each in pair)

                return f"{{{self._each(entry, slot.lane, start, count)}}}"

    def _array_of_numbers(self, scalar: str, slot: Span, start: str, count: str) -> str:
        """Integers of one byte may lie in the message, others lie in their lane."""
        if WIDTH[scalar] == 1 and scalar != "bool":
            borrowed = self._text("_bytes", slot, start, count)
            if self.unit.numpy:
                return f"_numbers_of(bytearray({borrowed}), {self.scope.dtype('u8')}).view({self.scope.dtype(scalar)})"
            return f'memoryview({borrowed}).cast("{CODES[scalar]}").tolist()'
        numbers = f"{self.scope.view(slot.lane, CODES[scalar])}[{_rows(start, count)}]"
        if self.unit.numpy:
            return self._numbers(numbers, scalar)
        numbers += ".tolist()"
        return f"[*map(bool, {numbers})]" if scalar == "bool" else numbers

    def _each(self, text: Callable[[str], str], lane: int, start: str, count: str) -> str:
        """The text of each element by the name of its index, in a comprehension."""
        self.depth += 1
        index = f"i_{self.depth}"
        found, names, codes = self.unpacked(text, lane, index)
        if codes and not re.search(rf"\b{index}\b", found):
            rows = f"{self.scope.view(lane, '')}[{_rows(start, count, self.scope.lanes.stride(lane))}]"
            self.depth -= 1
            return f'{found} for {names} in _unpack_each("{codes}", {rows})'
        found = f"{text(index)} for {index} in range({count if start == '0' else f'{start}, {start} + {count}'})"
        self.depth -= 1
        return found

    def unpacked(self, text: Callable[[str], str], lane: int, index: str) -> tuple[str, str, str]:
        """The text of an element whose numbers are locals, these in their order, and their codes: none if they are not read by one call."""
        fields = self.scope.unpacked[lane, index] = dict[int, str]()
        found = text(index)
        del self.scope.unpacked[lane, index]
        names = ", ".join(self.scope.own(lane, offset, fields[offset]) for offset in sorted(fields))
        return found, names, row_codes(fields, self.scope.lanes.stride(lane))

    def _numbers(self, numbers: str, scalar: str, *, is_few: bool = False) -> str:
        """An array of a list, or of a view of memory; numpy sees by itself what ``is_few`` floats are."""
        if not self.unit.numpy:
            return numbers
        type_ = self.scope.bool_dtype() if scalar == "bool" else self.scope.dtype(scalar)
        return f"_numbers_of({numbers})" if is_few and scalar == "f64" else f"_numbers_of({numbers}, {type_})"

    def _direct(self, type_: Type, slot: Span, lane: int, row: str) -> str | None:
        """What is a list or a string already."""
        known = self.scope.direct
        if (visit := known.visit_at(lane, slot.offset)) is not None:
            return self.scope.visited(visit)
        element = self.unit.layout.lanes[slot.lane].element
        if (lane, slot.offset) in known.pieces:
            piece = self.scope.piece(lane, slot.offset)
            return f"{piece}.decode({_HOW[type_.encoding]})" if isinstance(type_, String) else piece
        if slot.lane in known.whole:
            return self.scope.lanes.rows(slot.lane)
        if slot.lane in known.gathered and known.late_at(slot) is not None:
            return self.scope.lanes.rows(slot.lane)
        if slot.lane in known.appended:
            rows = self.scope.lanes.rows(slot.lane)
            return self._numbers(rows, element.scalar) if isinstance(element, Number) else rows
        if (lane, slot.offset) in known.placed:
            return f'{self.scope.placed(lane, slot.offset)}.get({self.start_of(slot, lane, row)}, "")'
        if slot.lane in known.rows:
            return f"[{', '.join(self.scope.element(slot.lane, number) for number in range(len(known.rows[slot.lane])))}]"
        if slot.lane in known.elements and isinstance(element, Number):
            texts = (self.scope.element(slot.lane, number) for number in range(len(known.elements[slot.lane])))
            return self._numbers(f"[{', '.join(texts)}]", element.scalar, is_few=True)
        if slot.lane in known.elements and isinstance(type_, Array):
            rows = len({each.row for each in known.elements[slot.lane]})
            return f"[{', '.join(self.row(type_.element, slot.lane, str(number)) for number in range(rows))}]"
        return self.scope.text(lane, slot.offset) if (lane, slot.offset) in known.texts else None

    def _is_borrowed(self, type_: Type, lane: int) -> bool:
        """Whether elements are texts that all lie in the message."""
        element = self.unit.layout.lanes[lane].element
        if not isinstance(element, Span) or not isinstance(type_, String) or type_.encoding == "utf-16":
            return False
        return element.lane not in self.reserved

    def _texts(self, type_: String, slot: Span, start: str, count: str) -> str:
        rows = self.scope.view(slot.lane, "q")
        parts = (f"{rows}[{f'{start} * 2' + offset} : ({start} + {count}) * 2 : 2]" for offset in ("", " + 1"))
        return f'[data[begin : begin - 1 - size].decode({_HOW[type_.encoding]}) if size else "" for begin, size in zip({", ".join(parts)})]'

    def row(self, type_: Type, lane: int, index: str) -> str:
        """The object of a row; those of types that contain themselves are made by a function."""
        if self.unit.layout.lanes[lane].links is not None:
            made = f"made_{self.scope.lanes.rows(lane)}"
            return f"{made}[{index}]" if self.scope.has_rows_apart else f"{made}({index})"
        return self.value(type_, self.unit.layout.lanes[lane].element, lane, index)

    def one_by_one(self, type_: String | Bytes | Array | Map, lane: int, count: str) -> str:  # noqa: ARG002 - of others
        """The body of a function that makes the first rows of a lane in a loop; nothing where a comprehension does."""
        return ""


def row_codes(fields: Mapping[int, str], stride: int) -> str:
    """Rows of which many numbers are needed, for the struct module; nothing where they are few, or lie in one another."""
    if len(fields) < MANY_NUMBERS:
        return ""
    codes, at = "=", 0
    for offset in sorted(fields):
        if offset < at:
            return ""
        codes += f"{offset - at}x" if offset > at else ""
        codes += CODES[fields[offset]] if fields[offset] != "bool" else "?"
        at = offset + WIDTH[fields[offset]]
    return codes + (f"{stride - at}x" if stride > at else "")


def _rows(start: str, count: str, each: int = 1) -> str:
    """Which numbers rows are, of which each is so many."""
    if start == "0":
        return f":{count}" if each == 1 else f": {count} * {each}"
    return f"{start} : {start} + {count}" if each == 1 else f"{start} * {each} : ({start} + {count}) * {each}"


def arrays_of(unit: Unit, *, in_recursive: bool = False) -> dict[int, Type]:
    """The types of the elements of arrays by their lanes; not those of types that contain themselves, nor by default what is in these."""
    found: dict[int, Type] = {}
    pending: list[tuple[Type, Slot]] = [(Ref(unit.type), unit.layout.root)]
    pending += [(Ref(struct), unit.layout.lanes[lane].element) for lane, struct in unit.layout.recursive if in_recursive]
    while pending:
        type_, slot = pending.pop()
        match unit.schema.resolve(type_), slot:
            case Struct(fields=fields), Row(members=members):
                inner = [each.type.value if isinstance(each.type, Optional) else each.type for each in fields]
                pending += zip(inner, (member.slot for member in members), strict=True)
            case Union(cases=cases), Variant(members=members):
                pending += zip((each.type for each in cases), (member.slot for member in members), strict=True)
            case Array(element), Span(_, lane) if unit.layout.lanes[lane].links is None:
                found[lane] = element
                pending.append((element, unit.layout.lanes[lane].element))
            case Map(key, value), Span(_, lane) if unit.layout.lanes[lane].links is None:
                pending += [(map_entry(key, value), unit.layout.lanes[lane].element)]
            case _:
                pass
    return found
