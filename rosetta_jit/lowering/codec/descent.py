"""Recursive structs whose bytes do not tell where they end: read and written depth first, with the stack in the holder's own rows.

The codec of the message, and that of each recursive struct, is cut where a recursive struct follows; the pieces are the states of one loop.
What a stack would hold is kept in the hidden words of the row that is being visited: to which row and state to return, how many of its
neighbours are still to be visited before that, and where what has its size before it began, or must end. The message itself has variables
for these.
"""

from __future__ import annotations

from collections.abc import Mapping

from rosetta_jit.kernel.nodes import Binary, Block, Compare, Const, Expect, Expr, Get, If, Local, SetField, Switch, Used, While
from rosetta_jit.kernel.terms import BEGIN, END, add, index, joined, mul
from rosetta_jit.kernel.visits import Stack, entering, going, going_back
from rosetta_jit.lowering.codec.holder_fields import Cell, HolderElements, HolderFields
from rosetta_jit.lowering.codec.walk import begin_elements, if_present, switch_cases, walk
from rosetta_jit.lowering.codec.work_list import link
from rosetta_jit.lowering.codec.xcdr2_members import store_size
from rosetta_jit.lowering.limits import MAX_RECURSION, MAX_SIZE
from rosetta_jit.lowering.writer import Where, Writer, block, integer
from rosetta_jit.model.layout import LINK_WORDS
from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.wire.codec import Cases, Codec, Delimited, Maybe, Path, Recursion, Repeat, Seq
from rosetta_jit.wire.recursion import MAX_OPEN_SIZES, open_sizes, recurses

ROW_WORD, STATE_WORD, LEFT_WORD, OPEN_WORD = range(4)
"""The hidden words of a row: the row around it, the state to go on with there, how many neighbours follow it; then those of `Delimited`."""
assert LINK_WORDS - OPEN_WORD >= MAX_OPEN_SIZES

SIZE_BYTES = 4
DONE = -1
ROOT = -1
"""The lane of pieces of the message itself."""


@dataclass(frozen=True, slots=True)
class Close:
    """The end of a part of a message whose size stands before it."""

    delimited: Delimited


@dataclass(frozen=True, slots=True)
class Piece:
    """What is done in a state: a codec for the row of a lane, then on to another state. Without a codec, the row is finished.

    ``open`` is how many sizes around it are still to be closed in its row.
    """

    lane: int
    codec: Codec | Close | None
    then: int
    open: int = 0


@dataclass(slots=True)
class Descent:
    """The loop that is being written: its variables, and the pieces of its states by number."""

    writer: Writer
    nested: Mapping[str, Codec]
    root: HolderFields
    stack: Stack
    opened: tuple[Local, ...] = ()
    pieces: list[Piece] = field(default_factory=list[Piece])

    def number(self, piece: Piece) -> int:
        """The state of a piece."""
        if piece not in self.pieces:
            self.pieces.append(piece)
        return self.pieces.index(piece)

    def entry(self, lane: int) -> int:
        """The state that begins a row of a lane."""
        struct = dict(self.root.layout.recursive)[lane]
        finished = self.number(Piece(lane, None, DONE))
        return self.number(Piece(lane, self.nested[struct], finished))

    def block(self, piece: Piece) -> Block:
        """The statements of a state."""
        with self.writer.nested() as body:
            self.writer.position = self.stack.at
            fields = self.fields(piece.lane)
            if piece.codec is None:
                self.finish(piece.lane)
            elif isinstance(piece.codec, Close):
                self.close(piece.codec.delimited, fields, piece)
            else:
                with self.writer.whole():
                    self.flow(piece.codec, fields, piece)
        return block(body)

    def fields(self, lane: int) -> HolderFields:
        """The fields of the row that is being visited."""
        if lane == ROOT:
            return self.root
        where = Where().members(tuple(self.root.layout.lanes[lane].name.split(".")))
        where = Where(f"{where.path}[]")
        known = Binary("and", Compare("ge", self.stack.row, index(0)), Compare("lt", self.stack.row, Used(lane)))
        self.writer.expect(known, "length", where, "the holder is damaged")
        cell = Cell(lane, self.stack.row, self.root.layout.lanes[lane].element)
        return HolderFields(self.writer, self.root.layout, cell, where, self.root.borrow)

    # --- within a row --------------------------------------------------------------------------------------------------

    def flow(self, codec: Codec, fields: HolderFields, piece: Piece) -> None:
        """A codec, then on to the piece's next state: at once, or when the recursive structs in it have been visited."""
        match codec:
            case _ if not recurses(codec):
                walk(codec, fields, self.writer)
                self.go(piece.then)
            case Seq(items):
                first = next(number for number, item in enumerate(items) if recurses(item))
                walk(Seq(items[:first]), fields, self.writer)
                rest = replace(piece, codec=Seq(items[first + 1 :]))
                then = self.number(rest) if items[first + 1 :] else piece.then
                self.flow(items[first], fields, replace(piece, then=then))
            case Repeat(_, _, Recursion()):
                elements, count = begin_elements(self.writer, fields, codec)
                assert isinstance(elements, HolderElements)
                self.visit(elements, count, piece.then)
            case Recursion(path):
                self.visit(self.single(fields, path), index(1), piece.then)
            case Cases():
                walk(codec.discriminator, fields, self.writer)
                switch_cases(self.writer, fields, codec, lambda each: self.flow(each, fields, piece))
            case Maybe():
                if_present(self.writer, fields, codec, lambda each: self.flow(each, fields, piece))
            case Delimited():
                self.open(codec, fields, piece)
            case _:
                raise AssertionError(codec)  # encodings refuse recursion elsewhere

    def single(self, fields: HolderFields, path: Path) -> HolderElements:
        """The row of a struct that is always there, and has one because it can contain itself."""
        if self.writer.direction == "decode":
            return fields.open(path, index(1))
        stored = fields.stored(path)
        self.writer.expect(Compare("eq", stored.size, index(1)), "missing", fields.shown(path), "it is not set")
        return fields.elements(path, stored)

    # --- sizes before what they are of -----------------------------------------------------------------------------------

    def open(self, codec: Delimited, fields: HolderFields, piece: Piece) -> None:
        """Note where it must end, or where its size will be written; then what is in it."""
        writer, where = self.writer, fields.shown(codec.path)
        if writer.direction == "decode":
            size = writer.let("size", integer(writer.load("u32", where, codec.order)))
            writer.require(size, where)
            self.note(piece, Binary("add", writer.position, size))
        else:
            self.note(piece, writer.position)
            writer.require(SIZE_BYTES, where, "no room for the message")
            writer.advance(SIZE_BYTES)
        then = self.number(replace(piece, codec=Close(codec)))
        self.flow(codec.value, fields, replace(piece, then=then, open=piece.open + 1))

    def close(self, codec: Delimited, fields: HolderFields, piece: Piece) -> None:
        """Check the end, or write the size."""
        writer, where = self.writer, fields.shown(codec.path)
        noted = writer.let("noted", self.noted(piece))
        if writer.direction == "decode":
            writer.expect(Compare("eq", writer.position, noted), "length", where, "its content is not as long as it says")
        elif writer.direction == "encode":
            sane = Binary("and", Compare("ge", noted, BEGIN), Compare("le", noted, writer.position))
            writer.expect(sane, "length", where, "the holder is damaged")
            writer.require(SIZE_BYTES, where, "the holder is damaged", at=noted)
            store_size(writer, noted, add(noted, SIZE_BYTES), where, codec.order)
        self.go(piece.then)

    def note(self, piece: Piece, value: Expr) -> None:
        if piece.lane == ROOT:
            self.writer.assign(self.opened[piece.open], value)
        else:
            assert piece.open < MAX_OPEN_SIZES  # encodings refuse more
            self.remember(piece.lane, self.stack.row, {OPEN_WORD + piece.open: value})

    def noted(self, piece: Piece) -> Expr:
        return self.opened[piece.open] if piece.lane == ROOT else self.recall(piece.lane, OPEN_WORD + piece.open)

    def go(self, state: int) -> None:
        self.writer.settle()
        self.writer.emit(*going(self.stack, self.writer.position, state))

    # --- from row to row -----------------------------------------------------------------------------------------------

    def visit(self, elements: HolderElements, count: Expr, then: int) -> None:
        """The rows of an array, the first of them next."""
        writer = self.writer
        writer.settle()
        with writer.nested() as some:
            shallow = Compare("lt", self.stack.depth, index(MAX_RECURSION))
            writer.expect(shallow, "nesting", elements.where, f"more than {MAX_RECURSION} structs within each other")
            words = [link(self.root.layout, elements.lane, elements.start, word) for word in (ROW_WORD, STATE_WORD, LEFT_WORD)]
            writer.emit(*entering(self.stack, words, elements.start, count, then))
            self.go(self.entry(elements.lane))
        with writer.nested() as none:
            self.go(then)
        writer.emit(If(Compare("gt", count, index(0)), block(some), block(none)))

    def finish(self, lane: int) -> None:
        """The next neighbour, or back to the row around."""
        writer = self.writer
        left = writer.let("left", self.recall(lane, LEFT_WORD))
        with writer.nested() as neighbour:
            following = writer.let("following", add(self.stack.row, 1))
            writer.expect(Compare("lt", following, Used(lane)), "length", Where(), "the holder is damaged")
            words = {ROW_WORD: self.recall(lane, ROW_WORD), STATE_WORD: self.recall(lane, STATE_WORD), LEFT_WORD: add(left, -1)}
            self.remember(lane, following, words)
            writer.assign(self.stack.row, following)
            writer.assign(self.stack.state, index(self.entry(lane)))
        with writer.nested() as back:
            writer.expect(Compare("gt", self.stack.depth, index(0)), "length", Where(), "the holder is damaged")
            writer.emit(*going_back(self.stack, [self.recall(lane, word) for word in (ROW_WORD, STATE_WORD)]))
        writer.emit(If(Compare("gt", left, index(0)), block(neighbour), block(back)))

    def remember(self, lane: int, row: Expr, words: Mapping[int, Expr]) -> None:
        for word, value in words.items():
            self.writer.emit(SetField(link(self.root.layout, lane, row, word), value))

    def recall(self, lane: int, word: int) -> Expr:
        return Get("i64", link(self.root.layout, lane, self.stack.row, word))


def descend(nested: Mapping[str, Codec], attempt: Codec, fields: HolderFields, writer: Writer) -> None:
    """Read or write a message that contains recursive structs."""
    at, state, row = writer.cursor("at"), writer.var("state", index(0)), writer.var("here", index(0))
    opened = tuple(writer.var("opened", index(0)) for _ in range(open_sizes(attempt)))
    descent = Descent(writer, nested, fields, Stack(at, state, row, writer.var("depth", index(0))), opened)
    descent.number(Piece(ROOT, attempt, DONE))
    rounds = writer.var("rounds", index(0))
    blocks: list[tuple[int, Block]] = []
    while len(blocks) < len(descent.pieces):
        blocks.append((len(blocks), descent.block(descent.pieces[len(blocks)])))
    with writer.nested() as unknown:
        writer.emit(Expect(Const("bool", value=False), writer.failure("length", Where(), "the holder is damaged", at=at)))
    with writer.nested() as body:
        writer.emit(Switch(state, tuple(blocks), block(unknown)))
        writer.position = at
        inside = Binary("and", *writer.position_invariant(at))
        deep = Binary("and", Compare("ge", descent.stack.depth, index(0)), Compare("le", descent.stack.depth, index(MAX_RECURSION)))
        writer.expect(Binary("and", inside, deep), "length", Where(), "the holder is damaged")  # true anyway; said for the proof
        writer.assign(rounds, add(rounds, 1))
    limit = _most_rounds(writer, fields, len(blocks))
    invariant = (
        Compare("ge", rounds, index(0)),
        Compare("ge", descent.stack.depth, index(0)),
        Compare("le", descent.stack.depth, index(MAX_RECURSION)),
        *writer.position_invariant(at),
    )
    goes_on = Binary("and", Compare("ge", state, index(0)), Compare("lt", rounds, limit))
    writer.emit(While(goes_on, block(body), invariant, rounds))
    writer.position = at
    writer.expect(Compare("lt", state, index(0)), "length", Where(), "the holder is damaged")


def _most_rounds(writer: Writer, fields: HolderFields, states: int) -> Expr:
    """Each row is visited in each state at most once, and there are no more rows than bytes, or rows of lanes."""
    if writer.direction == "decode":
        rows = add(Binary("sub", END, BEGIN), 2)
        writer.expect(Compare("le", rows, index(MAX_SIZE // states)), "length", Where(), "the message is larger than any memory")
    else:
        rows = add(joined("add", [Used(lane) for lane, _ in fields.layout.recursive]), 2)
    return writer.let("most", mul(writer.let("rows", rows), states))
