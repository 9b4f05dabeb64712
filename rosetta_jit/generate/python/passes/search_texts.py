"""Texts and bytes of a message that become strings and parts of it where a decoder finds them (see `search`).

texts       a text is decoded where it is checked: that is the check; those of rows of lanes are kept by their place
pieces      bytes are a part of the message
gathered    an array whose texts, or bytes, come one by one, wherever they are in the message: each is appended to a list
"""

from __future__ import annotations

from collections.abc import Collection

from rosetta_jit.generate.python.passes.direct import Direct
from rosetta_jit.generate.python.passes.mentions import changes, counted_lanes, places_of, readers_of
from rosetta_jit.generate.python.passes.slots import spans_of
from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import bound_names, expressions_of, statements
from rosetta_jit.model.layout import Layout, Row, Span


class Texts:
    """Looks for texts and bytes in a block that fills a row; what is found goes to ``direct``, the statements ``instead`` of others by id.

    ``mentions`` are the statements that have to do with a lane, ``fields`` those with a field of its rows, ``readers`` those that read a
    local, ``read_here`` those of them in the block, by their identity; ``checks`` says how often a text is checked.
    """

    def __init__(
        self, block: nodes.Block, kernel: ir.Kernel, layout: Layout, arrays: Collection[int], blobs: Collection[int], few: int
    ) -> None:
        self.block, self.layout, self.lists, self.blobs, self.few, self.direct = block, layout, arrays, blobs, few, Direct()
        self.instead: dict[int, nodes.Block] = {}
        self.mentions: dict[int, list[nodes.Stmt]] = {}
        self.fields: dict[tuple[int, int], list[nodes.Stmt]] = {}
        self.readers: dict[str, list[nodes.Stmt]] = {}
        self.read_here = readers_of(stmt for stmt, _ in statements(block))
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

    def _sets(self, block: nodes.Block, row: nodes.Place, value: nodes.Expr) -> list[nodes.SetField]:
        """The one statement, if it is one, that sets a field of the row to a value, and that has to do with the field."""
        found = [
            each
            for each in block
            if isinstance(each, nodes.SetField) and each.value == value and each.place.lane == row.lane and each.place.row == row.row
        ]
        return [each for each in found if len(self.fields[each.place.lane, each.place.offset]) == 1]

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
                read = self.read_here.get(row) == {id(first), id(second)}
                checked = self.checks.get((at, size), 0)
                is_text = checked == 1 and any(_checks(each, at, size) for each in block)
                if alone and read and (is_text or (lane in self.blobs and not checked)):
                    self.direct.gathered[lane] = at, size
                    if is_text:
                        self.direct.texts[lane, 0] = at, size
                        self.direct.listed.add(lane)
                    self.instead |= {id(each): () for each in own if each is not advance and each is not first}
            case _:
                pass


def _binds_behind(block: nodes.Block, stmt: nodes.Stmt, names: set[str]) -> bool:
    """Whether a block binds some locals behind a statement of it."""
    number = next(number for number, each in enumerate(block) if each is stmt)
    return any(names & {*bound_names(each)} for each in block[number:])


def _checks(stmt: nodes.Stmt, at: nodes.Expr, size: nodes.Expr) -> bool:
    return isinstance(stmt, nodes.Expect) and stmt.condition == nodes.IsText(nodes.Wire(at), size)
