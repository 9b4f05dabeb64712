"""Which arrays and texts of a message become lists and strings where a decoder finds them, instead of rows of a lane first.

    at once     the numbers of an array lie in the message as in its lane: one call of the struct module gives the list
    by name     an array of few elements, each set once: the list of so many locals; or of few arrays
    one by one  a loop fills row after row: it appends to a list instead
    texts       a text is decoded where it is checked: that is the check; those of rows of lanes are kept by their place
    gathered    an array whose texts, or bytes, come one by one, wherever they are in the message: each is appended to a list

Everything else goes through lanes as kernels say, and becomes objects in the end.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import cast

from rosetta_jit.generate.cleared import offsets_of, slots_of
from rosetta_jit.generate.python.bools import bools_read
from rosetta_jit.generate.python.counted import counted
from rosetta_jit.generate.python.direct import Direct
from rosetta_jit.generate.python.groups import turned
from rosetta_jit.generate.python.mentions import blocks_within, changes, counted_lanes, places_of, reads_any, reads_behind
from rosetta_jit.generate.python.slots import spans_of
from rosetta_jit.generate.python.written_out import written_out
from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.rewrite import locals_in, with_blocks
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.kernel.walk import bound_names, expressions_of, statements
from rosetta_jit.model.layout import Layout, Number, Row, Slot, Span

FEW = 16
"""Elements of an array of a fixed length that become locals: they are read together with the numbers around them."""


MESSAGE = nodes.Place(0, index(0))


def direct(
    block: nodes.Block,
    kernel: ir.Kernel,
    layout: Layout,
    arrays: Collection[int],
    blobs: Collection[int],
    *,
    few: int = FEW,
    row: nodes.Place = MESSAGE,
) -> tuple[nodes.Block, Direct]:
    """A block of a decoder whose ``row`` is locals, without the statements that lanes of ``arrays`` needed; and what is direct.

    Arrays of a fixed length, up to ``few`` elements, are read together with the numbers around them; ``blobs`` are arrays of bytes.
    """
    found = _Search(counted(block), kernel, layout, arrays, blobs, few)
    found.arrays(found.block, row)
    for inner in blocks_within(found.block):
        found.texts(inner)
        if row == MESSAGE:
            found.texts_of_message(inner)
            found.texts_of_rows(inner)
    if row != MESSAGE:
        found.direct.appended.add(row.lane)
    return found.rewritten(found.block), found.direct


class _Search:
    """Looks for arrays and texts in the block that fills a row, and in the loops that fill rows there."""

    def __init__(
        self, block: nodes.Block, kernel: ir.Kernel, layout: Layout, arrays: Collection[int], blobs: Collection[int], few: int
    ) -> None:
        self.block, self.layout, self.lists, self.blobs, self.few, self.direct = block, layout, arrays, blobs, few, Direct()
        self.instead: dict[int, nodes.Block] = {}
        self.mentions: dict[int, list[nodes.Stmt]] = {}
        self.fields: dict[tuple[int, int], list[nodes.Stmt]] = {}
        self.readers: dict[str, list[nodes.Stmt]] = {}
        self.checks: dict[tuple[nodes.Expr, nodes.Expr], int] = {}
        for part in (block, *(routine.body for routine in kernel.routines)):
            for stmt, _ in statements(part):
                self._note(stmt)

    def _note(self, stmt: nodes.Stmt) -> None:
        places = list(places_of(stmt))
        for lane in {each.lane for each in places} | counted_lanes(stmt):
            self.mentions.setdefault(lane, []).append(stmt)
        for place in () if isinstance(stmt, nodes.Fill) and stmt.target == nodes.Place(0, index(0)) else places:
            self.fields.setdefault((place.lane, place.offset), []).append(stmt)
        for name in {name for expr in expressions_of(stmt) for name in locals_in(expr)}:
            self.readers.setdefault(name, []).append(stmt)
        match stmt:
            case nodes.Expect(nodes.IsText(nodes.Wire(at), size), _):
                self.checks[at, size] = self.checks.get((at, size), 0) + 1
            case _:
                pass

    def rewritten(self, block: nodes.Block) -> nodes.Block:
        kept: list[nodes.Stmt] = []
        for stmt in block:
            kept += self.instead.get(id(stmt), (stmt,))
        return tuple(with_blocks(stmt, self.rewritten) for stmt in kept)

    # --- a row -----------------------------------------------------------------------------------------------------------------------

    def arrays(self, block: nodes.Block, row: nodes.Place) -> None:
        """What is direct of a row that a block fills."""
        for stmt in block:
            match stmt:
                case nodes.Reserve(lane, count) if lane in self.lists:
                    self._array(block, row, stmt, count)
                case nodes.Expect(nodes.IsText(nodes.Wire(at), size), _) if self.checks[at, size] == 1:
                    self._text(block, row, at, size)
                case _:
                    pass
        self._pieces(block, row)

    def _pieces(self, block: nodes.Block, row: nodes.Place) -> None:
        """Bytes of a row of which a block says where they are in the message, once and nowhere else."""
        places = {each.place: each for each in block if isinstance(each, nodes.SetField)}
        for offset, lane in spans_of(self.layout, row.lane).items():
            begin, end = (places.get(nodes.Place(row.lane, row.row, offset + behind)) for behind in (0, 8))
            once = all(len(self.fields.get((row.lane, offset + behind), ())) == 1 for behind in (0, 8))
            if begin is None or end is None or not once or self.mentions.get(lane) or (row.lane, offset) in self.direct.texts:
                continue
            if _binds_behind(block, begin, locals_in(end.value)):
                continue
            match end.value:
                case nodes.Binary("sub", nodes.Const(_, -1), size):
                    self.direct.pieces[row.lane, offset] = begin.value, size
                    self.instead[id(end)] = ()
                case nodes.Const(_, negative) if negative < 0:
                    self.direct.pieces[row.lane, offset] = begin.value, index(-1 - int(negative))
                    self.instead[id(end)] = ()
                case _:
                    pass

    def _text(self, block: nodes.Block, row: nodes.Place, at: nodes.Expr, size: nodes.Expr) -> None:
        spans = [
            (begin, end)
            for begin in self._sets(block, row, at)
            for end in self._sets(block, row, nodes.Binary("sub", index(-1), size))
            if end.place.offset == begin.place.offset + 8
        ]
        slots = spans_of(self.layout, row.lane)
        if len(spans) != 1 or self.mentions.get(slots.get(spans[0][0].place.offset, -1)):
            return
        (begin, end) = spans[0]
        if begin.place.offset in slots:
            self.direct.texts[row.lane, begin.place.offset] = at, size
            self.instead[id(begin)] = self.instead[id(end)] = ()

    def texts_of_message(self, block: nodes.Block) -> None:
        """The texts that a block within another, which may not come, sets in the message's row."""
        known = {*self.direct.texts, *self.direct.pieces}
        for stmt in block:
            match stmt:
                case nodes.Expect(nodes.IsText(nodes.Wire(at), size), _) if self.checks[at, size] == 1 and not self.direct.text_at(
                    at, size
                ):
                    self._text(block, nodes.Place(0, index(0)), at, size)
                case _:
                    pass
        self._pieces(block, nodes.Place(0, index(0)))
        self.direct.late |= {*self.direct.texts, *self.direct.pieces} - known

    def texts_of_rows(self, block: nodes.Block) -> None:
        """The texts that a block sets in rows of lanes, each behind its length: no row has one at the place 0."""
        behind = {nodes.Local("i64", result.name) for each in block if isinstance(each, nodes.Call) for result in each.results}
        for stmt in block:
            match stmt:
                case nodes.Expect(nodes.IsText(nodes.Wire(at), size), _) if at in behind and self.checks[at, size] == 1:
                    starts = [each for each in block if isinstance(each, nodes.SetField) and each.value == at and each.place.lane]
                    if len(starts) == 1 and self.direct.text_at(at, size) is None:
                        self._placed(block, starts[0].place, at, size)
                case _:
                    pass

    def _placed(self, block: nodes.Block, place: nodes.Place, at: nodes.Expr, size: nodes.Expr) -> None:
        """A text of a row, of which the row goes on to say where it lies."""
        counts = self._sets(block, place, nodes.Binary("sub", index(-1), size))
        once = sum(not isinstance(each, nodes.Fill) for each in self.fields[place.lane, place.offset]) == 1
        lane = spans_of(self.layout, place.lane).get(place.offset) if isinstance(self.layout.lanes[place.lane].element, Row) else None
        if once and lane is not None and not self.mentions.get(lane) and [each.place.offset for each in counts] == [place.offset + 8]:
            self.direct.placed[place.lane, place.offset] = at, size
            self.instead[id(counts[0])] = ()

    def _sets(self, block: nodes.Block, row: nodes.Place, value: nodes.Expr) -> list[nodes.SetField]:
        """The one statement, if it is one, that sets a field of the row to a value, and that has to do with the field."""
        found = [
            each
            for each in block
            if isinstance(each, nodes.SetField) and each.value == value and each.place.lane == row.lane and each.place.row == row.row
        ]
        return [each for each in found if len(self.fields[each.place.lane, each.place.offset]) == 1]

    def _array(self, block: nodes.Block, row: nodes.Place, reserve: nodes.Reserve, count: nodes.Expr) -> None:
        lane, found = reserve.lane, self.mentions[reserve.lane]
        lets = [each for each in found if isinstance(each, nodes.Let) and each.value == nodes.Used(lane)]
        advances = [each for each in found if each == nodes.Advance(lane, count)]
        own = {id(each) for each in (reserve, *lets, *advances)}
        here = {id(each) for each in block}
        if len(lets) != 1 or len(advances) != 1 or not own <= here or sum(isinstance(each, nodes.Reserve) for each in found) > 1:
            return
        start = nodes.Local("i64", lets[0].name)
        spans = [
            (begin, end)
            for begin in self._sets(block, row, start)
            for end in self._sets(block, row, count)
            if end.place.offset == begin.place.offset + 8
        ]
        if len(spans) != 1 or spans_of(self.layout, row.lane).get(spans[0][0].place.offset) != lane:
            return
        fills = [each for each in found if id(each) not in own]
        if {id(each) for each in self.readers[start.name]} != {id(spans[0][0]), *map(id, fills)}:
            return
        if (
            self._at_once(block, lane, start, count, fills)
            or self._by_name(block, lane, start, count, fills)
            or self._written_out(block, lane, start, count, fills)
        ):
            self.instead[id(reserve)] = ()
        elif not self._one_by_one(block, lane, start, count, fills):
            return
        for stmt in (*lets, *advances, *spans[0]):
            self.instead[id(stmt)] = ()

    # --- its arrays ------------------------------------------------------------------------------------------------------------------

    def texts(self, block: nodes.Block) -> None:
        """The texts of an array of which a block adds one."""
        for lane in {*self.lists} - self.direct.appended:
            element = self.layout.lanes[lane].element
            if isinstance(element, Span) and any(isinstance(each, nodes.Reserve) and each.lane == lane for each in block):
                self._gather(block, lane, element.lane)

    def _gather(self, block: nodes.Block, lane: int, text_lane: int) -> None:
        own = [each for each in block if changes(each, lane)]
        match own:
            case (
                nodes.Reserve(_, nodes.Const(_, 1)),
                nodes.Let(row, nodes.Used(_)),
                nodes.Advance(_, nodes.Const(_, 1)) as advance,
                nodes.SetField(nodes.Place(_, nodes.Local(_, row_2), 0), at) as first,
                nodes.SetField(nodes.Place(_, nodes.Local(_, row_3), 8), nodes.Binary("sub", nodes.Const(_, -1), size)) as second,
            ) if row == row_2 == row_3 and not self.mentions.get(text_lane):
                elsewhere = [each for each in self.mentions[lane] if id(each) not in {*map(id, own)}]
                alone = not any(changes(each, lane) and not isinstance(each, nodes.Let) for each in elsewhere)
                alone = alone and not any(place.lane == lane for each in elsewhere for place in places_of(each))
                read = {id(each) for each, _ in statements(self.block) if reads_any(each, {row})} == {id(first), id(second)}
                checked = self.checks.get((at, size), 0)
                is_text = checked == 1 and any(_checks(each, at, size) for each in block)
                if alone and read and (is_text or (lane in self.blobs and not checked)):
                    self.direct.gathered[lane] = at, size
                    if is_text:
                        self.direct.texts[lane, 0] = at, size
                    self.instead |= {id(each): () for each in own if each is not advance and each is not first}
            case _:
                pass

    def _at_once(self, block: nodes.Block, lane: int, start: nodes.Local, count: nodes.Expr, fills: list[nodes.Stmt]) -> bool:
        if len(fills) != 1:
            return False
        stride, element = self.layout.lanes[lane].stride, self.layout.lanes[lane].element
        code = numbers_of(element, stride)
        match fills[0]:
            case nodes.Copy(nodes.Place(_, row, 0), nodes.Wire(at), size) as copy if code and row == start and size == mul(count, stride):
                outer = next((each for each in block if each is copy or _if_any(each, count, copy)), None)
                if outer is None:
                    return False
                if (
                    isinstance(count, nodes.Const)
                    and isinstance(element, Number)
                    and 0 < count.value <= self.few
                    and element.scalar != "bool"
                ):
                    places = [nodes.Place(lane, add(start, number)) for number in range(int(count.value))]
                    self.direct.elements[lane] = places
                    self.instead[id(outer)] = tuple(
                        nodes.SetField(place, nodes.Load(code[0], add(at, number * stride))) for number, place in enumerate(places)
                    )
                    return True
                self.instead[id(outer)] = (copy,)
            case nodes.SetField() as last if isinstance(element, Number):
                loop = next((each for each in block if isinstance(each, nodes.For) and each.body and each.body[-1] is last), None)
                first = None if loop is None else _first_row(loop)
                if loop is None or loop.count != count or first != nodes.Place(lane, start):
                    return False
            case _:
                return False
        self.direct.whole.add(lane)
        return True

    def _by_name(self, block: nodes.Block, lane: int, start: nodes.Local, count: nodes.Expr, fills: list[nodes.Stmt]) -> bool:
        if not isinstance(count, nodes.Const) or not 0 < count.value <= FEW or len(fills) != count.value:
            return False
        places = [nodes.Place(lane, add(start, number)) for number in range(int(count.value))]
        here = {id(each) for each in block}
        if not all(isinstance(each, nodes.SetField) and id(each) in here for each in fills):
            return False
        if {each.place for each in fills if isinstance(each, nodes.SetField)} != set(places):
            return False
        if not isinstance(self.layout.lanes[lane].element, Number):
            return False
        self.direct.elements[lane] = places
        return True

    def _written_out(self, block: nodes.Block, lane: int, start: nodes.Local, count: nodes.Expr, fills: list[nodes.Stmt]) -> bool:
        element = self.layout.lanes[lane].element
        if not isinstance(element, Span) or not (lane in self.blobs or element.lane in self.lists):
            return False
        of, inner = self.layout.lanes[element.lane], self.mentions.get(element.lane, [])
        is_read = isinstance(of.element, Number) and of.element.scalar != "bool"
        found = written_out(block, start, count, fills, inner, of.stride) if is_read else None
        if found is None:
            return False
        self.direct.rows[lane] = found.rows
        self.instead |= {id(stmt): () for stmt in found.gone}
        return True

    def _one_by_one(self, block: nodes.Block, lane: int, start: nodes.Local, count: nodes.Expr, fills: list[nodes.Stmt]) -> bool:
        loops = [each for each in block if isinstance(each, nodes.For) and each.count == count and any(fill in each.body for fill in fills)]
        element = self.layout.lanes[lane].element
        needed = offsets_of(element)
        if len(loops) != 1 or needed is None:
            return False
        loop = loops[0]
        row = nodes.Binary("add", start, nodes.Local("i64", loop.variable))
        here = {id(each) for each in loop.body}
        sets = [each for each in fills if isinstance(each, nodes.SetField) and id(each) in here and each.place.row == row]
        read = [each for each in fills if not changes(each, lane)]
        if len(sets) + len(read) != len(fills) or sorted(each.place.offset for each in sets) != sorted(needed):
            return False
        if not reads_behind(loop.body, {id(each) for each in read}, nodes.Place(lane, row)):
            return False
        self.direct.appended.add(lane)
        self.direct.loops[loop.variable] = lane
        self.arrays(loop.body, nodes.Place(lane, row))
        return True


def _binds_behind(block: nodes.Block, stmt: nodes.Stmt, names: set[str]) -> bool:
    """Whether a block binds some locals behind a statement of it."""
    number = next(number for number, each in enumerate(block) if each is stmt)
    return any(names & {*bound_names(each)} for each in block[number:])


def _first_row(loop: nodes.For) -> nodes.Place | None:
    """The first row of the lane that a loop fills, if that can be read by one call."""
    if (found := turned(loop)) is not None:
        return found[0]
    bools = bools_read(loop)
    return None if bools is None else bools.first


def _checks(stmt: nodes.Stmt, at: nodes.Expr, size: nodes.Expr) -> bool:
    return isinstance(stmt, nodes.Expect) and stmt.condition == nodes.IsText(nodes.Wire(at), size)


def _if_any(stmt: nodes.Stmt, count: nodes.Expr, copy: nodes.Copy) -> bool:
    return (
        isinstance(stmt, nodes.If)
        and stmt.condition == nodes.Compare("gt", count, index(0))
        and stmt.then == (copy,)
        and not stmt.otherwise
    )


def numbers_of(slot: Slot, stride: int) -> tuple[nodes.Scalar, ...]:
    """The types of the numbers that a row is, one behind the other."""
    slots = [each for each in slots_of(slot) if not isinstance(each, Row)]
    numbers = sorted((each for each in slots if isinstance(each, Number)), key=lambda each: each.offset)
    at = 0
    for each in numbers:
        at = at + nodes.WIDTH[each.scalar] if each.offset == at else -1
    scalars: list[nodes.Scalar] = [cast("nodes.Scalar", each.scalar) for each in numbers]
    return tuple(scalars) if len(numbers) == len(slots) and at == stride else ()
