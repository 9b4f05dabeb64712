"""Objects of rows that have many lists, and bring none of them or some (see `late_rows`)."""

from __future__ import annotations

import re

from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.python.decoding.making import Make
from rosetta_jit.generate.python.passes.direct import LateRow
from rosetta_jit.generate.python.printing.classes import member_names
from rosetta_jit.generate.python.printing.late_lists import fields_besides, maker_without_lists
from rosetta_jit.model.types import Array, Bytes, Map, String, Type

MADE = "each"
"""The local for an object that is being made."""


class MakeLate(Make):
    """Expressions for objects, some of whose rows get their lists when somebody asks for one."""

    __slots__ = ()

    def row(self, type_: Type, lane: int, index: str) -> str:
        value = Make.row(self, type_, lane, index)
        late = self.scope.direct.late_rows.get(lane)
        return value if late is None else f"{value} if {self._any_lists(late, lane, index)} else {self._without_lists(late, lane, index)}"

    def _any_lists(self, late: LateRow, lane: int, row: str) -> str:
        """What is true of a row that has any of its lists: it says so where the first one starts."""
        return f"{self.start_of(late.lists[0], lane, row)} or {self.count_of(late.lists[0], lane, row)}"

    def _without_lists(self, late: LateRow, lane: int, row: str) -> str:
        """The object of a row that has none of its lists."""
        values = [self.member(each, member, late.slot, lane, row) for _, each, member in fields_besides(late)]
        values += [self.unknown(late.slot.unknown, lane, row)] if late.slot.unknown is not None else []
        return f"{maker_without_lists(self.names[late.struct.name])}({', '.join(values)})"

    def _settings(self, late: LateRow, lane: int, row: str) -> str:
        """The lines that set all fields of an object: a call of its class with many of them takes longer."""
        rows = zip(member_names(late.struct), late.struct.fields, late.slot.members, strict=True)
        values = [(name, self.member(each, member, late.slot, lane, row)) for name, each, member in rows]
        values += [("unknown_fields", self.unknown(late.slot.unknown, lane, row))] if late.slot.unknown is not None else []
        return "\n".join(f"{MADE}.{name} = {bare(value)}" for name, value in values)

    def one_by_one(self, type_: String | Bytes | Array | Map, lane: int, count: str) -> str:
        """One call reads all numbers of a row that has a list, and none those of others."""
        late, row = self.scope.direct.late_rows.get(lane), self.scope.locals.identifier("row\0index")
        if late is None or not isinstance(type_, Array):
            return ""
        usual, names, numbers = self.unpacked(lambda row: self._settings(late, lane, row), lane, row)
        if not numbers or re.search(rf"\b{row}\b", usual):
            return ""
        size, rows = self.scope.lanes.stride(lane), self.scope.view(lane, "")
        lines = [
            "made = []",
            f"for {row} in range({count}):",
            f"    if {self._any_lists(late, lane, row)}:",
            f'        {names} = _unpack("{numbers}", {rows}, {row} * {size})',
            f"        {MADE} = _new({self.names[late.struct.name]})",
            *(f"        {line}" for line in usual.splitlines()),
            f"        made.append({MADE})",
            "    else:",
            f"        made.append({self._without_lists(late, lane, row)})",
            "return made",
        ]
        return "".join(f"    {line}\n" for line in lines)
