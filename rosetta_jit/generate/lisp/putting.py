"""From objects to rows: ``(put-points codec row object)`` fills the row of an object."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import ExitStack, contextmanager

from rosetta_jit.generate.lisp.classes import ABSENT_BOOL, UNKNOWN
from rosetta_jit.generate.lisp.expressions import row_start
from rosetta_jit.generate.lisp.objects import Walk
from rosetta_jit.generate.lisp.texts import literal
from rosetta_jit.generate.shares import Ways
from rosetta_jit.model.layout import Number, Row, Slot, Span, Variant, map_entry
from rosetta_jit.model.types import Array, Bool, Bytes, Map, Optional, Ref, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass


@dataclass(slots=True)
class Put(Walk):
    """From objects to rows, which are 0 before: statements for each value."""

    def one(self, struct: Struct, slot: Row, lane: int, name: str, ways: Ways) -> None:
        del ways  # all fields are written
        with self.lines.form(f"(defun {name} (codec row object)"):
            type_, row = self.classes.types[struct.name], "row" if lane else "0"
            self.lines.line(f"(declare (type codec codec) (type fixnum row) (type {type_} object) (ignorable codec row object))")
            with self.reporting(self.is_sure(Ref(struct.name), slot)):
                self.fields(struct, slot, lane, row)
                self.lines.line("object")

    @contextmanager
    def reporting(self, is_sure: bool) -> Generator[None]:
        """Around statements that say which field comes next, where there are some that may fail."""
        with ExitStack() as forms:
            if not is_sure:
                forms.enter_context(self.lines.form('(let ((where ""))'))
                forms.enter_context(self.lines.form("(reporting where"))
            yield

    def is_sure(self, type_: Type, slot: Slot) -> bool:
        """Whether the type of an object's slot says that all of it can be written."""
        resolved = self.resolved(type_.value if isinstance(type_, Optional) else type_)
        match resolved, slot:
            case (_, Number()) | (Bytes(), Span()):
                return True
            case Struct(), Row(members=members):
                return all(self.is_sure(each.type, member.slot) for each, member in zip(resolved.fields, members, strict=True))
            case Array(), Span(_, own):
                return isinstance(self.element(own), Number)
            case _:
                return False

    def fields(self, struct: Struct, slot: Row, lane: int, row: str) -> None:
        """All fields of an object."""
        for each, member in zip(struct.fields, slot.members, strict=True):
            place = self.classes.accessor(struct, each.name)
            if not self.is_sure(each.type, member.slot):
                self.lines.line(f"(setf where {literal(f'.{each.name}')})")
            if member.presence is None:
                self.value(each.type, member.slot, lane, row, place, each.name)
                continue
            assert isinstance(each.type, Optional)
            word, bit = divmod(member.presence, 64)
            is_bool = isinstance(self.resolved(each.type.value), Bool)
            there = f"(not (eq value {ABSENT_BOOL}))" if is_bool else "value"
            with self.lines.form(f"(let ((value {place}))"), self.lines.form(f"(when {there}"):
                self.lines.line(f"(set-bit {self.lanes.place(lane)} {self.at(lane, slot.offset + 8 * word, 'u64', row)} {bit})")
                self.value(each.type.value, member.slot, lane, row, "value", each.name)
        if slot.unknown is not None:
            self.sequence(Bytes(), slot.unknown, lane, row, self.classes.accessor(struct, UNKNOWN), "")

    def value(self, type_: Type, slot: Slot, lane: int, row: str, at: str, path: str) -> None:
        """A value of an object."""
        resolved = self.resolved(type_)
        match resolved, slot:
            case _, Number(offset, scalar):
                self.lines.line(f"(setf {self.scalar(lane, offset, scalar, row)} {self.checked(scalar, at)})")
            case Struct(), Row():
                self.lines.line(f"({self.function(resolved, slot, lane, path)} codec {row} {at})")
            case Union(), Variant():
                self.union(resolved, slot, lane, row, at, path)
            case Struct(), Span():
                self.link(type_, slot, lane, row, at, path)
            case ((String() | Bytes() | Array() | Map()), Span()):
                self.sequence(resolved, slot, lane, row, at, path)
            case _:
                raise AssertionError(type_)

    def checked(self, scalar: str, at: str) -> str:
        """A number; slots have the right types, of what is elsewhere nobody knows."""
        return at if at.startswith("(") or scalar == "bool" else f"(checked {at} {scalar})"

    def span(self, slot: Span, lane: int, row: str, append: str) -> None:
        """Something that is put behind what a lane has already."""
        place = f"({self.lanes.place(lane)} {self.at(lane, slot.offset, 'i64', row)})"
        into = f"({self.lanes.place(slot.lane)} {self.lanes.place_of_used(slot.lane)})"
        self.lines.line(f"(put-span {place} {into} {append})")

    def link(self, type_: Type, slot: Span, lane: int, row: str, at: str, path: str) -> None:
        """A field of a type that contains itself: no row, or one."""
        self.depth += 1
        start, stride = self.local("first"), self.lanes.stride(slot.lane)
        with self.lines.form(f"(when {at}"), self.lines.form(f"(let (({start} {self.lanes.place_of_used(slot.lane)}))"):
            self.span(slot, lane, row, f"append-rows 1 {stride}")
            self.value(type_, self.element(slot.lane), slot.lane, row_start(stride, start), at, path)
        self.depth -= 1

    def sequence(self, type_: String | Bytes | Array | Map, slot: Span, lane: int, row: str, at: str, path: str) -> None:
        element = self.element(slot.lane)
        match type_:
            case String(encoding):
                self.span(slot, lane, row, f"append-{'utf-16' if encoding == 'utf-16' else 'text'} {at}")
            case Bytes():
                self.span(slot, lane, row, f"append-u8s {at}")
            case Array() if isinstance(element, Number):
                self.span(slot, lane, row, f"append-{element.scalar}s {at}")
            case Array(inner):
                self.rows(inner, slot, lane, row, at, path)
            case Map(key, value):
                self.map(key, value, slot, lane, row, at, path)

    def rows(self, inner: Type, slot: Span, lane: int, row: str, at: str, path: str) -> None:
        """Rows for the elements of a vector, which are all there before any is filled."""
        self.depth += 1
        all_, first, index, stride = self.local("all"), self.local("first"), self.local("index"), self.lanes.stride(slot.lane)
        with self.lines.form(f"(let* (({all_} {at}) ({first} {self.lanes.place_of_used(slot.lane)}))"):
            self.lines.line(f"(declare (type simple-vector {all_}))")
            self.span(slot, lane, row, f"append-rows (length {all_}) {stride}")
            with self.lines.form(f"(dotimes ({index} (length {all_}))"), self.lines.form(f"(reporting-element {index}"):
                self.value(
                    inner,
                    self.element(slot.lane),
                    slot.lane,
                    row_start(stride, f"(+ {first} {index})"),
                    f"(svref {all_} {index})",
                    path,
                )
        self.depth -= 1

    def map(self, key: Type, value: Type, slot: Span, lane: int, row: str, at: str, path: str) -> None:
        """Rows for the entries of a hash table."""
        self.depth += 1
        table, first, index, stride = self.local("table"), self.local("first"), self.local("index"), self.lanes.stride(slot.lane)
        element, entry = self.element(slot.lane), map_entry(key, value)
        assert isinstance(element, Row)
        own = self.local("key"), self.local("mapped")
        with self.lines.form(f"(let* (({table} {at}) ({first} {self.lanes.place_of_used(slot.lane)}) ({index} {first}))"):
            self.lines.line(f"(declare (type hash-table {table}) (type fixnum {index}))")
            self.span(slot, lane, row, f"append-rows (hash-table-count {table}) {stride}")
            with self.lines.form(f"(loop for {own[0]} being the hash-keys of {table} using (hash-value {own[1]}) do"):
                with self.lines.form(f"(reporting-element {own[0]}"):
                    for each, member, name in zip(entry.fields, element.members, own, strict=True):
                        self.value(each.type, member.slot, slot.lane, row_start(stride, index), name, f"{path}-{each.name}")
                self.lines.line(f"(incf {index})")
        self.depth -= 1

    def union(self, union: Union, slot: Variant, lane: int, row: str, at: str, path: str) -> None:
        self.depth += 1
        which, value = self.local("which"), self.local("value")
        with self.lines.form(f"(let* (({which} {at}) ({value} (cdr {which})))"):
            self.lines.line(f"(declare (ignorable {value}))")
            with self.lines.form(f"(ecase (car {which})"):
                self.lines.line("((nil))")
                for number, (each, member) in enumerate(zip(union.cases, slot.members, strict=True), 1):
                    with self.lines.form(f"({self.classes.case(union, each.name)}", by=1):
                        self.lines.line(f"(setf {self.scalar(lane, slot.offset, 'i64', row)} {number})")
                        self.value(each.type, member.slot, lane, row, value, f"{path}-{each.name}")
        self.depth -= 1
