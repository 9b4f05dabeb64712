"""The fields of a holder: where a walk over a codec finds their values in the holder's rows, or puts them."""

from __future__ import annotations

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import ROW, add, index, mul
from rosetta_jit.lowering.codec.fields import OTHER_CASE, Stored, converted, scalar_name
from rosetta_jit.lowering.limits import MAX_SIZE
from rosetta_jit.lowering.writer import MESSAGE, Where, Writer
from rosetta_jit.model.layout import UNKNOWN, Layout, Member, Number, Row, Slot, Span, Variant
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.wire.codec import Choice, Codec, Path


@dataclass(frozen=True, slots=True)
class Cell:
    """A slot of a row of a lane."""

    lane: int
    row: nodes.Expr
    slot: Slot

    def place(self, offset: int) -> nodes.Place:
        return nodes.Place(self.lane, self.row, offset)


@dataclass(frozen=True, slots=True)
class HolderFields:
    """Fields in the lanes of a holder. With ``borrow`` bytes stay in the message, and the holder says where."""

    writer: Writer
    layout: Layout
    cell: Cell
    where: Where = MESSAGE
    borrow: bool = False
    owner: HolderFields | None = None

    @property
    def scope(self) -> HolderFields:
        return self.owner or self

    def shown(self, path: Path) -> Where:
        """As users name it: a case of a union stands among the fields around the union."""
        where, slot = self.where, self.cell.slot
        for number, name in enumerate(path, 1):
            slot = member_of(slot, name).slot
            where = where.member(name) if number == len(path) or not isinstance(slot, Variant) else where
        return where

    def put(self, path: Path, value: nodes.Expr) -> None:
        cell = self.mark(path)
        match cell.slot:
            case Number(offset, scalar):
                self.writer.emit(nodes.SetField(cell.place(offset), converted(value, scalar)))
            case _:
                raise AssertionError(path)

    def get(self, path: Path) -> nodes.Expr | None:
        cell = self.find(path)
        match cell.slot:
            case Number(offset, scalar):
                return nodes.Get(scalar_name(scalar), cell.place(offset))
            case _:
                raise AssertionError(path)

    def put_bytes(self, path: Path, at: nodes.Expr, size: nodes.Expr) -> None:
        cell = self.mark(path)
        span = span_of(cell)
        left = self.writer.left_in_message(span.lane, size) if self.borrow else None
        if left is not None:
            self.set_span(cell, at, left)
            return
        start = self.reserve(span.lane, size)
        self.writer.emit(nodes.Copy(nodes.Place(span.lane, start), nodes.Wire(at), size))
        self.set_span(cell, start, size)

    def stored(self, path: Path, fixed: int | None = None) -> Stored:
        del fixed
        start, count = self.read_span(self.find(path), self.shown(path))
        return Stored(count, start)

    def copy_bytes(self, path: Path, stored: Stored) -> None:
        assert stored.start is not None
        source = nodes.Place(span_of(self.find(path)).lane, stored.start)
        self.writer.emit(nodes.Copy(nodes.Wire(self.writer.position), source, stored.size))

    def open(self, path: Path, count: nodes.Expr) -> HolderElements:
        cell = self.mark(path)
        lane = span_of(cell).lane
        start = self.reserve(lane, count)
        self.set_span(cell, start, count)
        if has_gaps(self.layout.lanes[lane].element):
            stride = self.layout.lanes[lane].stride
            self.writer.expect(nodes.Compare("le", count, index(MAX_SIZE // stride)), "count", self.shown(path), "too many elements")
            self.clear(lane, start, count)
        return HolderElements(self, lane, start, self.shown(path))

    def elements(self, path: Path, stored: Stored) -> HolderElements:
        assert stored.start is not None
        return HolderElements(self, span_of(self.find(path)).lane, stored.start, self.shown(path))

    def branch(self, choice: Choice) -> None:
        """Fields of a holder are written in whichever branch they come."""

    def choose(self, path: Path, number: int) -> None:
        cell = self.find(path)
        assert isinstance(cell.slot, Variant)
        place = cell.place(cell.slot.offset)
        if self.writer.direction == "decode":
            self.writer.emit(nodes.SetField(place, index(number)))
        else:
            agrees = nodes.Compare("eq", nodes.Get("i64", place), index(number))
            self.writer.expect(agrees, "union", self.shown(path[:-1]), OTHER_CASE)

    def scatter(self, path: Path) -> None:
        """Lanes take fields in any order."""

    def appear(self, path: Path) -> None:
        self.mark(path)

    def present(self, path: Path) -> nodes.Expr:
        owner = self.find(path[:-1])
        member = member_of(owner.slot, path[-1])
        assert isinstance(owner.slot, Row)
        assert member.presence is not None
        place, mask = presence_bit(owner, owner.slot, member.presence)
        return nodes.Compare("ne", nodes.Binary("and", nodes.Get("u64", place), mask), nodes.Const("u64", 0))

    # --- places ------------------------------------------------------------------------------------------------------

    def find(self, path: Path) -> Cell:
        """The slot at a path."""
        slot = self.cell.slot
        for name in path:
            slot = member_of(slot, name).slot
        return replace(self.cell, slot=slot)

    def mark(self, path: Path) -> Cell:
        """The slot at a path that is about to be set: what can be absent on the way becomes present."""
        slot = self.cell.slot
        for name in path:
            self.mark_member(slot, name)
            slot = member_of(slot, name).slot
        return replace(self.cell, slot=slot)

    def mark_member(self, slot: Slot, name: str) -> None:
        member = member_of(slot, name)
        match slot:
            case Row() if member.presence is not None:
                place, mask = presence_bit(self.cell, slot, member.presence)
                self.writer.emit(nodes.SetField(place, nodes.Binary("or", nodes.Get("u64", place), mask)))
            case Variant(offset, members):
                self.writer.emit(nodes.SetField(self.cell.place(offset), index(1 + members.index(member))))
            case _:
                pass

    def reserve(self, lane: int, count: nodes.Expr) -> nodes.Expr:
        """Take ``count`` new rows of a lane; gives the first."""
        self.writer.emit(nodes.Reserve(lane, count))
        start = self.writer.let("start", nodes.Used(lane))
        self.writer.emit(nodes.Advance(lane, count))
        return start

    def clear(self, lane: int, start: nodes.Expr, count: nodes.Expr) -> None:
        """Zeros in so many rows; but what `size` has left in their hidden words is kept for `encode`."""
        links = self.layout.lanes[lane].links
        if links is None or self.writer.direction != "encode":
            self.writer.emit(nodes.Fill(nodes.Place(lane, start), mul(count, self.layout.lanes[lane].stride)))
            return
        number = self.writer.fresh("cleared")
        row = add(start, nodes.Local("i64", number))
        self.writer.emit(nodes.For(number, count, (nodes.Fill(nodes.Place(lane, row), index(links)),)))

    def is_own_row(self, span: Span) -> bool:
        """Whether a span leads to messages that can contain themselves."""
        return self.layout.lanes[span.lane].links is not None

    def set_span(self, cell: Cell, start: nodes.Expr, count: nodes.Expr) -> None:
        offset = cell.slot.offset if isinstance(cell.slot, Span) else 0
        self.writer.emit(nodes.SetField(cell.place(offset), start), nodes.SetField(cell.place(offset + 8), count))

    def read_span(self, cell: Cell, where: Where) -> tuple[nodes.Expr, nodes.Expr]:
        """Start and count of a field's elements, checked: a damaged holder must not lead outside its lanes."""
        span = span_of(cell)
        start = self.writer.let("start", nodes.Get("i64", cell.place(span.offset)))
        count = self.writer.let("count", nodes.Get("i64", cell.place(span.offset + 8)))
        inside = nodes.Binary("and", nodes.Compare("ge", count, index(0)), nodes.Compare("le", count, nodes.Used(span.lane)))
        self.writer.expect(inside, "length", where, "the holder is damaged")
        inside = nodes.Binary(
            "and", nodes.Compare("ge", start, index(0)), nodes.Compare("le", start, nodes.Binary("sub", nodes.Used(span.lane), count))
        )
        self.writer.expect(inside, "length", where, "the holder is damaged")
        return start, count


@dataclass(frozen=True, slots=True)
class HolderElements:
    """The rows of an array from a first one on."""

    parent: HolderFields
    lane: int
    start: nodes.Expr
    where: Where

    def place(self, item: Codec, first: nodes.Expr, step: int) -> HolderElements:
        del item, first, step
        return self

    def at(self, number: nodes.Expr) -> HolderFields:
        slot = self.parent.layout.lanes[self.lane].element
        cell = Cell(self.lane, add(self.start, number), slot)
        owner = None if isinstance(slot, Row) else self.parent.scope
        return replace(self.parent, cell=cell, where=self.where.element(number), owner=owner)


def root_fields(writer: Writer, layout: Layout, *, borrow: bool = False) -> HolderFields:
    """The fields of the message itself: row `row` of lane 0."""
    return HolderFields(writer, layout, Cell(0, ROW, layout.root), borrow=borrow)


def member_of(slot: Slot, name: str) -> Member:
    """A field of a row, or a case of a union."""
    match slot:
        case Row(unknown=Span() as unknown) if name == UNKNOWN:
            return Member(UNKNOWN, unknown)
        case Row(members=members) | Variant(members=members):
            return members.named[name]
        case _:
            raise AssertionError(name)


def has_gaps(slot: Slot) -> bool:
    """Whether reading a value may leave parts of its slot as they were: what is absent, the other cases of a union."""
    match slot:
        case Row(_, _, words, members):
            return words > 0 or any(has_gaps(member.slot) for member in members)
        case Variant():
            return True
        case _:
            return False


def span_of(cell: Cell) -> Span:
    """The span at a cell that is one."""
    match cell.slot:
        case Span():
            return cell.slot
        case _:
            raise AssertionError(cell)


def presence_bit(cell: Cell, row: Row, bit: int) -> tuple[nodes.Place, nodes.Const]:
    """The presence word of a field, and its bit in there."""
    return cell.place(row.offset + 8 * (bit // 64)), nodes.Const("u64", 1 << bit % 64)
