"""From rows to objects: ``(take-points codec data row before)`` is the object of a row; the one that was there before is filled again."""

from __future__ import annotations

from rosetta_jit.generate.lisp.classes import ABSENT_BOOL, UNKNOWN
from rosetta_jit.generate.lisp.expressions import row_start
from rosetta_jit.generate.lisp.objects import Walk
from rosetta_jit.generate.shares import Ways, within
from rosetta_jit.model.layout import Member, Number, Row, Slot, Span, Variant, map_entry
from rosetta_jit.model.types import Array, Bool, Bytes, Field, Map, Optional, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass


@dataclass(slots=True)
class Take(Walk):
    """From rows to objects: an expression for each value."""

    def one(self, struct: Struct, slot: Row, lane: int, name: str, ways: Ways) -> None:
        type_, row = self.classes.types[struct.name], "row" if lane else "0"
        with self.lines.form(f"(defun {name} (codec data row before)"):
            self.lines.line("(declare (type codec codec) (type octets data) (type fixnum row) (ignorable codec data row))")
            with self.lines.form(f"(let ((object (if (typep before '{type_}) before (make-{type_}))))"):
                for each, member in zip(struct.fields, slot.members, strict=True):
                    if part := within(ways, each.name):
                        place = self.classes.accessor(struct, each.name)
                        self.lines.line(f"(setf {place} {self.member(each, member, slot, lane, row, place, part)})")
                if slot.unknown is not None and () in ways:
                    place = self.classes.accessor(struct, UNKNOWN)
                    self.lines.line(f"(setf {place} {self.sequence(Bytes(), slot.unknown, lane, row, place, '')})")
                self.lines.line("object")

    def member(self, each: Field, member: Member, slot: Row, lane: int, row: str, place: str, part: Ways) -> str:
        """The value of a field, of which a part is set: it may be absent."""
        type_ = each.type.value if isinstance(each.type, Optional) and member.presence is not None else each.type
        resolved = self.resolved(type_)
        if () not in part and isinstance(resolved, Struct) and isinstance(member.slot, Row):
            value = f"({self.function(resolved, member.slot, lane, each.name, part)} codec data {row} {place})"
        else:
            value = self.value(type_, member.slot, lane, row, place, each.name)
        if member.presence is None:
            return value
        word, bit = divmod(member.presence, 64)
        absent = ABSENT_BOOL if isinstance(resolved, Bool) else "nil"
        return f"(if (logbitp {bit} {self.scalar(lane, slot.offset + 8 * word, 'u64', row)}) {value} {absent})"

    def value(self, type_: Type, slot: Slot, lane: int, row: str, before: str, path: str) -> str:
        """The value at a slot of a row; ``before`` is the one that was there."""
        resolved = self.resolved(type_)
        match resolved, slot:
            case _, Number(offset, scalar):
                return self.scalar(lane, offset, scalar, row)
            case Struct(), Row():
                return f"({self.function(resolved, slot, lane, path)} codec data {row} {before})"
            case Union(), Variant():
                return self.union(resolved, slot, lane, row, path)
            case Struct(), Span():
                start, count = self.span(slot, lane, row)
                return f"(if (plusp {count}) {self.row_value(type_, slot.lane, start, before, path)} nil)"
            case ((String() | Bytes() | Array() | Map()), Span()):
                return self.sequence(resolved, slot, lane, row, before, path)
            case _:
                raise AssertionError(type_)

    def span(self, slot: Span, lane: int, row: str) -> tuple[str, str]:
        return self.scalar(lane, slot.offset, "i64", row), self.scalar(lane, slot.offset + 8, "i64", row)

    def row_value(self, type_: Type, lane: int, index: str, before: str, path: str) -> str:
        """The value of a row of a lane."""
        return self.value(type_, self.element(lane), lane, row_start(self.lanes.stride(lane), index), before, path)

    def sequence(self, type_: String | Bytes | Array | Map, slot: Span, lane: int, row: str, before: str, path: str) -> str:
        start, count = self.span(slot, lane, row)
        element, rows = self.element(slot.lane), self.lanes.place(slot.lane)
        match type_:
            case String("utf-16"):
                return f"(utf-16-of {before} {rows} {start} {count})"
            case String():
                return f"(text-of {before} {rows} {start} {count} data)"
            case Bytes():
                return f"(u8s {before} {rows} {start} {count} data)"
            case Array() if isinstance(element, Number) and element.scalar != "bool":
                data = " data" if element.scalar in ("u8", "i8") else ""
                return f"({element.scalar}s {before} {rows} {start} {count}{data})"
            case Array(inner):
                self.depth += 1
                index, was = self.local("index"), self.local("before")
                value = self.row_value(inner, slot.lane, index, was, path)
                self.depth -= 1
                return f"(elements ({before} {start} {count}) ({was} {index}) {value})"
            case Map(key, value):
                self.depth += 1
                index, entry = self.local("index"), map_entry(key, value)
                assert isinstance(element, Row)
                at = row_start(self.lanes.stride(slot.lane), index)
                parts = [
                    self.value(each.type, member.slot, slot.lane, at, "nil", f"{path}-{each.name}")
                    for each, member in zip(entry.fields, element.members, strict=True)
                ]
                self.depth -= 1
                return f"(entries ({before} {start} {count}) ({index}) {parts[0]} {parts[1]})"

    def union(self, union: Union, slot: Variant, lane: int, row: str, path: str) -> str:
        cases = [
            f"({number} (cons {self.classes.case(union, each.name)} "
            f"{self.value(each.type, member.slot, lane, row, 'nil', f'{path}-{each.name}')}))"
            for number, (each, member) in enumerate(zip(union.cases, slot.members, strict=True), 1)
        ]
        return f"(case {self.scalar(lane, slot.offset, 'i64', row)} {' '.join(cases)} (t nil))"
