"""Objects taken apart: statements that make their numbers locals, or parts of rows, and fill the lanes of arrays."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Writer
from rosetta_jit.generate.python.printing.classes import NUMPY, member_names
from rosetta_jit.generate.python.printing.conversions import within
from rosetta_jit.generate.python.printing.scope import CODES, flat_name
from rosetta_jit.generate.unit import Unit
from rosetta_jit.model.layout import WIDTH, Number, Row, Slot, Span, Variant, map_entry
from rosetta_jit.model.types import Array, Bytes, Map, Optional, Ref, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes

MOST_AT_ONCE = 40
"""Numbers of an array of a fixed length that are packed by a function of its own."""

OUTSIDE = 2
"""How deep the statements of `encode` are that stand in no loop."""


@dataclass(slots=True)
class Collect:
    """Statements that take an object apart: its numbers become locals, or parts of rows that are packed.

    ``replaced`` are lines that begin lanes with no rows, in vain; ``wholes`` are functions that pack arrays of a fixed length.
    ``unpacked``: numbers become locals, which nothing packs, and thereby checks.
    """

    unit: Unit
    lanes: Lanes
    structs: dict[str, str]
    writer: Writer = field(default_factory=lambda: Writer(depth=1))
    number: int = 0
    replaced: set[str] = field(default_factory=set[str])
    wholes: set[str] = field(default_factory=set[str])
    unpacked: bool = False

    def name(self, what: str) -> str:
        self.number += 1
        return f"{what}_{self.number}"

    def value(self, type_: Type, slot: Slot, at: str, found: dict[int, tuple[str, str]]) -> None:
        """A value of an object: ``found`` gets the expression and the scalar for each offset of the row."""
        resolved = self.unit.schema.resolve(type_)
        match resolved, slot:
            case _, Number(offset, scalar):
                text = within(at, scalar) if self.unpacked and scalar[0] in "iu" else at
                found[offset] = (f"1 if {at} else 0" if scalar == "bool" else text, scalar)
            case Struct(), Row():
                self.struct(resolved, slot, at, found)
            case Union(), Variant():
                self.union(resolved, slot, at, found)
            case Struct(), Span():
                self.link(type_, slot, at, found)
            case ((String() | Bytes() | Array() | Map()), Span()):
                self.sequence(resolved, slot, at, found)
            case _:
                raise AssertionError(type_)

    def _span(self, slot: Span, start: str, count: str, found: dict[int, tuple[str, str]]) -> None:
        found[slot.offset], found[slot.offset + 8] = (start, "i64"), (count, "i64")

    def struct(self, struct: Struct, slot: Row, at: str, found: dict[int, tuple[str, str]]) -> None:
        own = self.name("each") if not at.isidentifier() else at
        if own != at:
            self.writer.line(f"{own} = {at}")
        words = [self.name("presence") for _ in range(slot.presence_words)]
        for number, word in enumerate(words):
            self.writer.line(f"{word} = 0")
            found[slot.offset + 8 * number] = (word, "u64")
        for each, member, name in zip(struct.fields, slot.members, member_names(struct), strict=True):
            if member.presence is None:
                self.value(each.type, member.slot, f"{own}.{name}", found)
                continue
            assert isinstance(each.type, Optional)
            word, bit = divmod(member.presence, 64)
            self.maybe(each.type.value, member.slot, f"{own}.{name}", f"{words[word]} |= {1 << bit}", found)
        if slot.unknown is not None:
            self.sequence(Bytes(), slot.unknown, f"{own}.unknown_fields", found)

    def maybe(self, type_: Type, slot: Slot, at: str, there: str, found: dict[int, tuple[str, str]]) -> None:
        """What is there under a condition: its numbers are 0 else."""
        inner: dict[int, tuple[str, str]] = {}
        outer, self.writer = self.writer, Writer(depth=self.writer.depth + 1)
        value = self.name("value")
        self.writer.line(there)
        self.value(type_, slot, value, inner)
        names = {offset: self.name("part") for offset in inner}
        lines = [f"{self.writer.depth * '    '}{names[offset]} = {text}" for offset, (text, _) in inner.items()]
        inside, self.writer = [*self.writer.lines, *lines], outer
        self.writer.line(f"{' = '.join([*names.values(), value])} = 0" if names else f"{value} = 0")
        self.writer.line(f"{value} = {at}")
        self.writer.line(f"if {value} is not None:")
        self.writer.lines += inside
        found |= {offset: (names[offset], scalar) for offset, (_, scalar) in inner.items()}

    def union(self, union: Union, slot: Variant, at: str, found: dict[int, tuple[str, str]]) -> None:
        which, case = self.name("which"), self.name("case")
        self.writer.line(f"{which} = 0")
        self.writer.line(f"{case} = {at} or (None, None)")
        found[slot.offset] = (which, "i64")
        for number, (each, member) in enumerate(zip(union.cases, slot.members, strict=True), 1):
            self.maybe(each.type, member.slot, f'({case}[1] if {case}[0] == "{each.name}" else None)', f"{which} = {number}", found)

    def link(self, type_: Type, slot: Span, at: str, found: dict[int, tuple[str, str]]) -> None:
        rows, start, count = self.name("rows"), self.name("start"), self.name("count")
        self.writer.line(f"{rows} = [] if {at} is None else [{at}]")
        self._rows(type_, slot.lane, rows, start, count)
        self._span(slot, start, count, found)

    def sequence(self, type_: String | Bytes | Array | Map, slot: Span, at: str, found: dict[int, tuple[str, str]]) -> None:
        lane, start, count = self.lanes.rows(slot.lane), self.name("start"), self.name("count")
        element = self.unit.layout.lanes[slot.lane].element
        if not isinstance(type_, Map) and isinstance(element, Number):
            size = WIDTH[element.scalar]
            if self.writer.depth == OUTSIDE and not self.unit.layout.recursive:  # nothing else is in that lane
                self.replaced.add(f"{self.writer.depth * '    '}{lane} = bytearray()")
                self.writer.line(f"{lane} = {self._raw(type_, element.scalar, at)}")
                self._span(slot, "0", f"len({lane}){f' // {size}' if size > 1 else ''}", found)
                return
            raw = self.name("raw")
            self.writer.line(f"{raw} = {self._raw(type_, element.scalar, at)}")
            self.writer.line(f"{start} = len({lane}){f' // {size}' if size > 1 else ''}")
            self.writer.line(f"{count} = len({raw}){f' // {size}' if size > 1 else ''}")
            self.writer.line(f"{lane}.extend({raw})")
        elif isinstance(type_, Map):
            self._entries(type_, slot.lane, at, start, count)
        elif isinstance(type_, Array):
            self._rows(type_.element, slot.lane, at, start, count)
        self._span(slot, start, count, found)

    def _raw(self, type_: String | Bytes | Array, scalar: str, at: str) -> str:
        match type_:
            case String("utf-16"):
                return f'{at}.encode("utf-16-le", "surrogatepass")'
            case String("octets"):
                return f'{at}.encode("utf-8", "surrogateescape")'
            case String():
                return f"{at}.encode()"
            case Bytes():
                return at
            case Array() if self.unit.numpy:
                self.wholes.add(dtype := f"_dtype_{NUMPY[scalar][1]}")
                return f"_raw({dtype}, {at}{', is_bool=True' if scalar == 'bool' else ''})"
            case Array(_, int(length)) if 0 < length <= MOST_AT_ONCE:
                self.wholes.add(whole := f"_whole_{CODES[scalar] * length}")
                return f'{whole}(*{at}) if len({at}) == {length} else _packed("{CODES[scalar]}", {at})'
            case Array():
                return f'_packed("{CODES[scalar]}", {at})'

    def _rows(self, type_: Type, lane: int, at: str, start: str, count: str) -> None:
        """Rows for the elements of a list, which are reserved before any is filled."""
        self._loop(lane, at, start, count, partial(self._element, type_, lane))

    def _element(self, type_: Type, lane: int, own: str, found: dict[int, tuple[str, str]]) -> None:
        if self.unit.layout.lanes[lane].links is None:
            self.value(type_, self.unit.layout.lanes[lane].element, own, found)

    def _loop(self, lane: int, at: str, start: str, count: str, fill: Callable[[str, dict[int, tuple[str, str]]], None]) -> None:
        rows, stride = self.lanes.rows(lane), self.lanes.stride(lane)
        own, index = self.name("element"), self.name("at")
        self.writer.line(f"{start} = len({rows}) // {stride}")
        self.writer.line(f"{count} = len({at})")
        self.writer.line(f"{rows}.extend(bytes({stride} * {count}))")
        outside, self.unpacked = self.unpacked, False
        with self.writer.indented(f"for {index}, {own} in enumerate({at}, {start}):"):
            self._row(lane, rows, index, own, fill)
        self.unpacked = outside

    def _row(self, lane: int, rows: str, index: str, own: str, fill: Callable[[str, dict[int, tuple[str, str]]], None]) -> None:
        if self.unit.layout.lanes[lane].links is not None:
            self.writer.line(f"collect_{rows}({index}, {own})")
            return
        found: dict[int, tuple[str, str]] = {}
        fill(own, found)
        self.pack(lane, index, found)

    def _entries(self, type_: Map, lane: int, at: str, start: str, count: str) -> None:
        element = self.unit.layout.lanes[lane].element
        assert isinstance(element, Row)
        entry = map_entry(type_.key, type_.value)

        def fill(own: str, found: dict[int, tuple[str, str]]) -> None:
            for number, (each, member) in enumerate(zip(entry.fields, element.members, strict=True)):
                self.value(each.type, member.slot, f"{own}[{number}]", found)

        items = self.name("items")
        self.writer.line(f"{items} = {at}.items()")
        self._loop(lane, items, start, count, fill)

    def pack(self, lane: int, index: str, found: dict[int, tuple[str, str]]) -> None:
        """Write a row."""
        if not found:
            return
        stride = self.lanes.stride(lane)
        where = "0" if index == "0" else f"{index} * {stride}"
        texts = [text for _, (text, _) in sorted(found.items())]
        self.writer.line(f"{self.struct_for(found)}({self.lanes.rows(lane)}, {where}, {', '.join(texts)})")

    def struct_for(self, found: dict[int, tuple[str, str]]) -> str:
        """The function that packs numbers at such offsets."""
        code, at = "=", 0
        for offset, (_, scalar) in sorted(found.items()):
            code += f"{offset - at}x" if offset > at else ""
            code += CODES[scalar]
            at = offset + WIDTH[scalar]
        return self.structs.setdefault(code, f"_pack_{len(self.structs) + 1}")

    def root(self, flat_rows: set[str], *, flat: bool) -> None:
        """The message."""
        found: dict[int, tuple[str, str]] = {}
        self.unpacked = flat
        self.value(Ref(self.unit.type), self.unit.layout.root, "target", found)
        if not flat:
            self.writer.line(f"message = bytearray({self.lanes.stride(0)})")
            self.pack(0, "0", found)
            return
        for offset, (text, scalar) in sorted(found.items()):
            name = flat_name(self.lanes, offset, scalar)
            if name in flat_rows:
                self.writer.line(f"{name} = {text}")
