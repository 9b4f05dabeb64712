"""Between the rows of kernels and objects.

    (take-points codec data row before)     the object of a row; the one that was there before is filled again
    (put-points codec row object)           its row is filled

There are two such functions for each struct in the layout; in a row, ``row`` is the byte where the row of its lane begins.
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

from rosetta_jit.generate.lisp.classes import ABSENT_BOOL, UNKNOWN, Classes
from rosetta_jit.generate.lisp.expressions import access, row_start
from rosetta_jit.generate.lisp.lines import Lines
from rosetta_jit.generate.lisp.texts import literal
from rosetta_jit.generate.shares import WHOLE, Ways, within
from rosetta_jit.model.layout import Member, Number, Row, Slot, Span, Variant, map_entry
from rosetta_jit.model.types import Array, Bool, Bytes, Field, Map, Optional, Ref, String, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.lisp.lanes import Lanes


@dataclass(slots=True)
class Walk:
    """Functions that are printed for one direction: ``verb`` begins their names, ``done`` are those by lane, offset and struct."""

    classes: Classes
    lanes: Lanes
    verb: str
    done: dict[tuple[int, int, str, Ways], str] = field(default_factory=dict[tuple[int, int, str, Ways], str])
    pending: list[tuple[Struct, Row, int, str, Ways]] = field(default_factory=list[tuple[Struct, Row, int, str, Ways]])
    lines: Lines = field(default_factory=Lines)
    depth: int = 0

    def element(self, lane: int) -> Slot:
        """The slot of a lane's rows."""
        return self.classes.unit.layout.lanes[lane].element

    def resolved(self, type_: Type) -> Type:
        return self.classes.schema.resolve(type_)

    def function(self, struct: Struct, slot: Row, lane: int, path: str, ways: Ways = WHOLE) -> str:
        """The function for the structs at a slot of a lane's rows, or for some of their fields."""
        key = lane, slot.offset, struct.name, ways
        if key not in self.done:
            named = "\0".join(map(str, (self.verb, *key[:3], *map(".".join, sorted(ways)))))
            self.done[key] = self.classes.names.symbol(named, wanted=f"{self.verb}-{path}")
            self.pending.append((struct, slot, lane, self.done[key], ways))
        return self.done[key]

    def at(self, lane: int, offset: int, scalar: str, row: str) -> str:
        """The byte of a scalar."""
        name = self.lanes.offset(lane, offset, scalar)
        return name if row == "0" else row if name == "0" else f"(+ {row} {name})"

    def scalar(self, lane: int, offset: int, scalar: str, row: str) -> str:
        """The place of a scalar of a row."""
        return f"({access(scalar)} {self.lanes.place(lane)} {self.at(lane, offset, scalar, row)})"  # pyright: ignore[reportArgumentType]

    def whole(self, path: str = "message", ways: Ways = WHOLE) -> str:
        """The function for the message."""
        unit = self.classes.unit
        root = self.resolved(Ref(unit.type))
        assert isinstance(root, Struct)
        assert isinstance(unit.layout.root, Row)
        return self.function(root, unit.layout.root, 0, path, ways)

    def printed(self) -> str:
        """The functions, those of messages last."""
        texts: list[str] = []
        while self.pending:
            self.lines = Lines()
            self.one(*self.pending.pop())
            texts.append(self.lines.text())
        return "\n".join(reversed(texts))

    def one(self, struct: Struct, slot: Row, lane: int, name: str, ways: Ways) -> None:
        raise NotImplementedError

    def local(self, what: str) -> str:
        return what if self.depth < 2 else f"{what}-{self.depth}"


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
