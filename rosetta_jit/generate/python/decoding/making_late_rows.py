"""Objects of rows that have many lists, and bring none of them or some (see `late_rows`)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.python.decoding.making import Make
from rosetta_jit.generate.python.passes.direct import LateRow, groups_of
from rosetta_jit.generate.python.printing.classes import member_names
from rosetta_jit.generate.python.printing.late_lists import fields_besides, maker_without_lists, set_groups
from rosetta_jit.model.layout import Span
from rosetta_jit.model.types import Array, Bytes, Map, String, Type
from rosetta_jit.startup.dataclass import replace

MADE = "each"
"""The local for an object that is being made."""


class MakeLate(Make):
    """Expressions for objects, some of whose rows get their lists when somebody asks for one."""

    __slots__ = ()

    def row(self, type_: Type, lane: int, index: str) -> str:
        value = Make.row(self, type_, lane, index)
        late = self.scope.direct.late_rows.get(lane) if self.unit.layout.lanes[lane].links is None else None
        return value if late is None else f"{value} if {self._any_lists(late, lane, index)} else {self._without_lists(late, lane, index)}"

    def _any_lists(self, late: LateRow, lane: int, row: str) -> str:
        """What is true of a row that has any of its lists: it says so where the first one starts."""
        return self._starts(late.lists[0], lane, row)

    def _starts(self, flag: Span, lane: int, row: str) -> str:
        """What is true of a row that says something where a list starts: which elements it has, or that it has some of others."""
        return f"{self.start_of(flag, lane, row)} or {self.count_of(flag, lane, row)}"

    def _without_lists(self, late: LateRow, lane: int, row: str) -> str:
        """The object of a row that has none of its lists."""
        values = [self.member(each, member, late.slot, lane, row) for _, each, member in fields_besides(late)]
        values += [self.unknown(late.slot.unknown, lane, row)] if late.slot.unknown is not None else []
        return f"{maker_without_lists(self.names[late.struct.name])}({', '.join(values)})"

    def _with_lists(self, late: LateRow, lane: int, row: str) -> Iterator[str]:
        """The lines that make the object of a row that has a list."""
        identifier = self.names[late.struct.name]
        yield f"{MADE} = _new({identifier})"
        yield from self._read(lambda row: self._besides(late, lane, row), lane, row)
        groups = [
            (self._has(number), self._read(lambda row, group=group: self._lists(late, group, lane, row), lane, row))
            for number, group in enumerate(groups_of(late.lists))
        ]
        yield from set_groups(MADE, identifier, groups)

    def _besides(self, late: LateRow, lane: int, row: str) -> str:
        """The lines that set the fields of an object that are no lists, and say which groups of these it has."""
        lines = [f"{MADE}.{name} = {bare(self.member(each, member, late.slot, lane, row))}" for name, each, member in fields_besides(late)]
        if late.slot.unknown is not None:
            lines.append(f"{MADE}.unknown_fields = {bare(self.unknown(late.slot.unknown, lane, row))}")
        flags = (self._starts(group[-1], lane, row) for group in groups_of(late.lists))
        return "\n".join([*lines, *(f"{self._has(number)} = {flag}" for number, flag in enumerate(flags))])

    def _has(self, group: int) -> str:
        """The local that says whether an object has a group of lists."""
        return self.scope.locals.identifier(f"has\0lists\0{group}")

    def _lists(self, late: LateRow, group: tuple[Span, ...], lane: int, row: str) -> str:
        """The lines that set the lists of a group."""
        rows = zip(member_names(late.struct), late.struct.fields, late.slot.members, strict=True)
        values = [(name, self.member(each, member, late.slot, lane, row)) for name, each, member in rows if member.slot in group]
        return "\n".join(f"{MADE}.{name} = {bare(value)}" for name, value in values)

    def one_by_one(self, type_: String | Bytes | Array | Map, lane: int, count: str) -> str:
        """One call reads all numbers of a group of which a row has a list, and none those of others."""
        late, row = self.scope.direct.late_rows.get(lane), self.scope.locals.identifier("row\0index")
        if late is None or not isinstance(type_, Array):
            return ""
        lines = [
            "made = []",
            f"for {row} in range({count}):",
            f"    if {self._any_lists(late, lane, row)}:",
            *(f"        {line}" for line in self._with_lists(late, lane, row)),
            f"        made.append({MADE})",
            "    else:",
            f"        made.append({self._without_lists(late, lane, row)})",
            "return made",
        ]
        return "".join(f"    {line}\n" for line in lines)

    def function_of(self, type_: Type, lane: int) -> list[str]:
        """The lines of a function that makes the object of a row of a type that contains itself."""
        row, slot, marked = "index", self.unit.layout.lanes[lane].element, self.scope.direct.marked.get(lane)

        def returned(row: str) -> str:
            return f"return {self.value(type_, slot, lane, row)}"

        if marked is None:
            return [returned(row)]
        if (late := self.scope.direct.late_rows.get(lane)) is not None:
            lines, empty = [*self._with_lists(late, lane, row), f"return {MADE}"], self._without_lists(late, lane, row)
        else:
            spans = frozenset((lane, offset) for offset in marked.offsets)
            lines, empty = self._read(returned, lane, row), replace(self, absent=spans).value(type_, slot, lane, row)
        any_list = " or ".join(self.scope.field(lane, row, marked.mark + behind, "i64") for behind in (0, 8))
        return [f"if {any_list}:", *(f"    {line}" for line in lines), f"return {empty}"]

    def _read(self, text: Callable[[str], str], lane: int, row: str) -> list[str]:
        """Lines that need numbers of a row: one call reads many."""
        found, names, codes = self.unpacked(text, lane, row)
        if not codes or re.search(rf"\b{row}\b", found):
            return text(row).splitlines()
        rows, size = self.scope.view(lane, ""), self.scope.lanes.stride(lane)
        return [f'{names} = _unpack("{codes}", {rows}, {row} * {size})', *found.splitlines()]
