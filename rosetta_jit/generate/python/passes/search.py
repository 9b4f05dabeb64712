"""Which arrays and texts of a message become lists and strings where a decoder finds them, instead of rows of a lane first.

    at once     the numbers of an array lie in the message as in its lane: one call of the struct module gives the list
    by name     an array of few elements, each set once: the list of so many locals; or of few arrays
    one by one  a loop fills row after row: it appends to a list instead

`search_texts` has what it says of texts. Everything else goes through lanes as kernels say, and becomes objects in the end.
"""

from __future__ import annotations

from collections.abc import Collection
from itertools import accumulate
from typing import cast

from rosetta_jit.generate.passes.cleared import offsets_of, slots_of
from rosetta_jit.generate.python.passes.bools import bools_read
from rosetta_jit.generate.python.passes.counted import counted
from rosetta_jit.generate.python.passes.direct import Direct
from rosetta_jit.generate.python.passes.groups import turned
from rosetta_jit.generate.python.passes.mentions import blocks_within, changes, reads_behind
from rosetta_jit.generate.python.passes.search_texts import Texts
from rosetta_jit.generate.python.passes.slots import spans_of
from rosetta_jit.generate.python.passes.written_out import written_out
from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.rewrite import with_blocks
from rosetta_jit.kernel.terms import add, index, mul
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


class _Search(Texts):
    """Looks for arrays and texts in the block that fills a row, and in the loops that fill rows there."""

    def rewritten(self, block: nodes.Block) -> nodes.Block:
        kept: list[nodes.Stmt] = []
        for stmt in block:
            kept += self.instead.get(id(stmt), (stmt,))
        return tuple(with_blocks(stmt, self.rewritten) for stmt in kept)

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
                if isinstance(count, nodes.Const) and 0 < count.value * len(code) <= self.few and "bool" not in code:
                    places = self.direct.elements[lane] = _places(lane, start, int(count.value), element)
                    begins = accumulate((nodes.WIDTH[each] for each in code * int(count.value)), initial=0)
                    self.instead[id(outer)] = tuple(
                        nodes.SetField(place, nodes.Load(type_, add(at, begin)))
                        for place, type_, begin in zip(places, code * int(count.value), begins, strict=False)
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
        if not isinstance(count, nodes.Const) or not 0 < count.value <= len(fills) <= FEW:
            return False
        element = self.layout.lanes[lane].element
        if not (isinstance(element, Number) or _is_numbers(element)) or self.layout.lanes[lane].links is not None:
            return False
        places = _places(lane, start, int(count.value), element)
        here = {id(each) for each in block}
        if len(fills) != len(places) or not all(isinstance(each, nodes.SetField) and id(each) in here for each in fills):
            return False
        if {each.place for each in fills if isinstance(each, nodes.SetField)} != set(places):
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
        is_taken = (lane, 0) in self.direct.texts or (lane in self.blobs and (lane, 0) in self.direct.pieces)
        self.direct.listed |= {lane} if isinstance(element, Span) and is_taken else set()
        return True


def _first_row(loop: nodes.For) -> nodes.Place | None:
    """The first row of the lane that a loop fills, if that can be read by one call."""
    if (found := turned(loop)) is not None:
        return found[0]
    bools = bools_read(loop)
    return None if bools is None else bools.first


def _places(lane: int, start: nodes.Local, count: int, element: Slot) -> list[nodes.Place]:
    """The numbers of the first rows of an array, each of which is a number, or some."""
    offsets = sorted(each.offset for each in slots_of(element) if isinstance(each, Number))
    return [nodes.Place(lane, add(start, number), offset) for number in range(count) for offset in offsets]


def _is_numbers(slot: Slot) -> bool:
    """Whether a row is a struct of numbers alone, none of which is a bool."""
    parts = [each for each in slots_of(slot) if not isinstance(each, Row)]
    rows = [each for each in slots_of(slot) if isinstance(each, Row)]
    is_plain = all(not each.presence_words and each.unknown is None for each in rows)
    return bool(parts) and is_plain and all(isinstance(each, Number) and each.scalar != "bool" for each in parts)


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
