"""Arrays set element by element, as functions make them, and values copied as a whole, from lanes to lanes."""

from __future__ import annotations

from collections.abc import Callable
from typing import assert_never

from rosetta_jit.kernel.nodes import Binary, Block, Compare, Const, Convert, Copy, Expr, For, Get, If, Local, Place, Scalar, Switch
from rosetta_jit.kernel.terms import index, mul, type_of
from rosetta_jit.language import typed
from rosetta_jit.language.typed import Change
from rosetta_jit.lowering.codec.holder_fields import HolderFields, presence_bit
from rosetta_jit.lowering.limits import MAX_SIZE
from rosetta_jit.lowering.made_arrays import Put
from rosetta_jit.lowering.rules.holder_side import HolderSide
from rosetta_jit.lowering.rules.rescaling import by_number, change_of_member, rescaled
from rosetta_jit.lowering.rules.scalars import NAMES, RANGES, scalar_type
from rosetta_jit.lowering.rules.values import Values
from rosetta_jit.lowering.writer import Where, block
from rosetta_jit.model.layout import Layout, Member, Number, Row, Slot, Span, Variant
from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.wire.codec import Path


@dataclass(slots=True)
class Putting:
    """Sets elements by their numbers: ``element`` is the place of the one whose number is that of the variable.

    Of integers that may not fit, `beyond` gathers the bits of how far each lies above the least one that fits, so that no round waits for
    a check. Where such a bit is beyond those of an element, `check` makes all values once more, and refuses the first that does not fit.
    """

    target: HolderSide
    element: typed.Place
    variable: typed.Local
    values: Values
    beyond: Local | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        if self.scalar in RANGES and self.scalar != "i64":
            self.beyond = self.values.writer.var("beyond", Const("u64", 0))

    @property
    def scalar(self) -> Scalar:
        """The scalar type of an element."""
        return scalar_type(self.element.type)

    def __call__(self, number: Expr, value: Expr) -> Expr:
        writer = self.values.writer
        variables, where = {**self.values.variables, self.variable.name: number}, self.values.where.element(number)
        inner = replace(self.values, variables=variables, where=where)
        if self.beyond is not None and type_of(value) == "i64":
            wide = writer.let("wide", value)
            found = writer.let("number", Convert(self.scalar, wide))
            writer.assign(self.beyond, Binary("or", self.beyond, self._above_least(wide)))
        else:
            found = writer.let("number", value if type_of(value) == self.scalar else inner.convert(value, self.scalar, "exact"))
        self.target.set_number(self.element, found, inner)
        return found

    def check(self, fill: Callable[[Put], None]) -> None:
        """That all numbers fit, which ``fill`` has made."""
        if self.beyond is None:
            return
        writer = self.values.writer
        with writer.nested() as again:
            fill(self._refuse)
        low, high = RANGES[self.scalar]
        size = Const("u64", min(high - low, 1 << 63))  # an int64 that is not negative fits all of uint64
        writer.emit(If(Compare("ge", self.beyond, size), block(again)))
        self._expect(Compare("lt", self.beyond, size), self.values.where)  # others than before, if they fit the second time

    def _above_least(self, wide: Expr) -> Expr:
        """How far an int64 lies above the least that fits, as a word: of one that lies below, the word wraps and is beyond all that fit."""
        low, _ = RANGES[self.scalar]
        distance = Convert("u64", wide)
        return Binary("wrapping_add", distance, Const("u64", -low)) if low else distance

    def _refuse(self, number: Expr, value: Expr) -> Expr:
        """The element as it is set, if it fits."""
        if type_of(value) != "i64":
            return value
        wide = self.values.writer.let("wide", value)
        found = Convert(self.scalar, wide)
        fits = Compare("ge", wide, index(0)) if self.scalar == "u64" else Compare("eq", Convert("i64", found), wide)
        self._expect(fits, self.values.where.element(number))
        return found

    def _expect(self, condition: Expr, where: Where) -> None:
        detail = f"the value does not fit {NAMES.get(self.scalar, self.scalar)}"
        self.values.writer.expect(condition, "range", where, detail, line=self.values.line)


def is_endless(layout: Layout, slot: Slot) -> bool:
    """Whether a value can hold others of its own type."""
    match slot:
        case Number():
            return False
        case Span(_, lane):
            return layout.lanes[lane].links is not None or is_endless(layout, layout.lanes[lane].element)
        case Row(members=members) | Variant(members=members):
            return any(is_endless(layout, member.slot) for member in members)
        case _:
            assert_never(slot)


def copy(source: HolderFields, origin: Path, target: HolderFields, path: Path, change: Change | None = None) -> None:
    """Copy the value at a path of one message to a path of another, which holds nothing there yet. It must not be endless.

    ``change`` says which numbers have another unit there.
    """
    slot = source.find(origin).slot
    match slot:
        case Number():
            value = source.get(origin)
            assert value is not None
            target.put(path, value if change is None else rescaled(value, change))
        case Span():
            _elements(source, origin, target, path, change)
        case Row(members=members):
            target.mark(path)
            for member in members:
                ends = (source, (*origin, member.name)), (target, (*path, member.name))
                _member(slot, member, *ends, change_of_member(change, member.name))
        case Variant(offset, members):
            case = source.writer.let("case", Get("i64", source.find(origin).place(offset)))
            changes = [change_of_member(change, member.name) for member in members]
            ways = enumerate(zip(members, changes, strict=True))
            cases = tuple((1 + number, _case(member, source, origin, target, path, within)) for number, (member, within) in ways)
            source.writer.emit(Switch(case, cases, ()))
        case _:
            assert_never(slot)


def _member(row: Row, member: Member, origin: tuple[HolderFields, Path], target: tuple[HolderFields, Path], change: Change | None) -> None:
    if member.presence is None:
        copy(*origin, *target, change)
        return
    source, path = origin
    place, mask = presence_bit(source.find(path[:-1]), row, member.presence)
    with source.writer.nested() as there:
        copy(*origin, *target, change)
    source.writer.emit(If(Compare("ne", Binary("and", Get("u64", place), mask), Const("u64", 0)), block(there)))


def _case(member: Member, source: HolderFields, origin: Path, target: HolderFields, path: Path, change: Change | None) -> Block:
    with source.writer.nested() as body:
        copy(source, (*origin, member.name), target, (*path, member.name), change)
    return block(body)


def _elements(source: HolderFields, origin: Path, target: HolderFields, path: Path, change: Change | None) -> None:
    writer, stored = source.writer, source.stored(origin)
    taken = source.elements(origin, stored)
    lane = source.layout.lanes[taken.lane]
    writer.expect(Compare("le", stored.size, index(MAX_SIZE // lane.stride)), "count", source.shown(origin), "too many elements")
    made = target.open(path, stored.size)
    if isinstance(lane.element, Number) and change is None:
        writer.emit(Copy(Place(made.lane, made.start), Place(taken.lane, taken.start), mul(stored.size, lane.stride)))
        return
    number = Local("i64", writer.fresh("each"))
    with writer.nested() as body:
        by_number(writer, change, number, lambda within: copy(taken.at(number), (), made.at(number), (), within))
    writer.emit(For(number.name, stored.size, block(body)))
