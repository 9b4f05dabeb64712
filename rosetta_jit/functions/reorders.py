"""Orders of bytes that a function makes or takes: `permuted(decompress(.data), [2, 1, 0])`, `compress(rows(.pixels, ...), ...)`.

The bytes lie in the hidden lane of what is computed, and are put there once more in their new order. A call becomes one typed call:

    bytes, first, how many axes, (count, step, listed)*, whether it is padded, rows, size, stride, (condition, reason)*

where `COUNT` is the number of the bytes, and ``listed`` the numbers of an axis that the text names (`rosetta_jit.language.arrays.layouts`).
Nothing is read before it is shown that the first and the last byte of each row of reads lie within the bytes.
"""

from __future__ import annotations

from functools import reduce
from itertools import product

from rosetta_jit.functions.images import bytes_of
from rosetta_jit.kernel.nodes import Advance, Binary, Compare, Const, Copy, Expr, Fill, For, If, Local, Place, Reserve, SetField, Used, Wire
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.language import typed
from rosetta_jit.language.function import NOT_FOLLOWED, SEVERAL, Function, Row
from rosetta_jit.language.image_orders import COUNT, ORDERED
from rosetta_jit.language.scope import Scope
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.texts.views import View, byte_at, lane_of, sound
from rosetta_jit.lowering.writer import Writer, block
from rosetta_jit.model import expr as model
from rosetta_jit.startup.dataclass import dataclass, replace

ZERO, ONE = index(0), index(1)

MOST_UNROLLED = 4
"""Rounds of a loop that are written out."""


def _never_written(_call: model.Call, _arguments: list[typed.Expr], _scope: Scope) -> typed.Expr | None:
    raise AssertionError  # `rosetta_jit.language.arrays.orders` makes these calls


def _lower(call: typed.Call, values: Evaluation) -> View:
    core, first, number, *rest = call.arguments
    assert isinstance(number, typed.Const)
    extent, writer = bytes_of(core, values), values.writer
    size = writer.let("size", extent.size)
    inner = values.with_local(COUNT, size)
    triples, rest = rest[: 3 * int(number.value)], rest[3 * int(number.value) :]
    padding, rest = (rest[1:4], rest[4:]) if isinstance(rest[0], typed.Const) and rest[0].value else ([], rest[1:])
    for condition, reason in zip(rest[::2], rest[1::2], strict=True):
        assert isinstance(reason, typed.Const)
        values.reject(str(reason.value), when=inner.of(condition))
    lane, begin = (None, extent.address.at) if isinstance(extent.address, Wire) else (extent.address.lane, extent.address.row)
    order = _Order(writer, values, lane, writer.let("begin", begin), size)
    axes = order.axes(tuple(triples), inner)
    total = writer.let("total", order.product([each.count for each in axes]))
    if not padding:
        target = order.room(total)
        order.fill(axes, writer.let("from", inner.of(first)), target, total)
        return target
    rows, width, stride = (writer.let("number", inner.of(each)) for each in padding)
    values.reject("the rows are not all elements", when=Compare("ne", total, order.product([rows, width])))
    plain = order.room(total)
    order.fill(axes, writer.let("from", inner.of(first)), plain, total)
    return order.padded(plain, rows, width, stride)


@dataclass(frozen=True, slots=True)
class _Axis:
    """``count`` bytes, ``step`` apart, or the listed ``numbers`` of them; what is made of them lies ``apart``."""

    count: Expr
    step: Expr
    numbers: tuple[int, ...] | None
    apart: Expr = ONE


@dataclass(frozen=True, slots=True)
class _Order:
    """Bytes of a lane, or of the message, from ``begin`` on."""

    writer: Writer
    values: Evaluation
    lane: int | None
    begin: Expr
    size: Expr

    def axes(self, triples: tuple[typed.Expr, ...], inner: Evaluation) -> list[_Axis]:
        found: list[_Axis] = []
        for count, step, listed in zip(triples[::3], triples[1::3], triples[2::3], strict=True):
            assert isinstance(listed, typed.Const)
            numbers = tuple(int(each) for each in str(listed.value).split(",")) if listed.value else None
            if numbers is None and isinstance(count, typed.Const) and int(count.value) <= MOST_UNROLLED:
                numbers = tuple(range(int(count.value)))
            size = self.writer.let("count", inner.of(count)) if numbers is None else index(len(numbers))
            if numbers is None:
                self.must(Compare("ge", size, index(0)), "a size below 0")
            found.append(_Axis(size, _plain(self.writer, inner.of(step)), numbers))
        apart: Expr = ONE
        dense: list[_Axis] = []
        for axis in reversed(found):
            dense.insert(0, replace(axis, apart=apart))
            apart = self.product([axis.count, apart])
        return dense

    def product(self, factors: list[Expr]) -> Expr:
        return reduce(self.times, factors)

    def times(self, one: Expr, other: Expr) -> Expr:
        if ONE in (one, other):
            return other if one == ONE else one
        if isinstance(one, Const) and isinstance(other, Const):
            return index(int(one.value) * int(other.value))
        return self.writer.checked("mul", one, other, self.values.where, line=self.values.line)

    def plus(self, one: Expr, other: Expr) -> Expr:
        if ZERO in (one, other):
            return other if one == ZERO else one
        if isinstance(one, Const) and isinstance(other, Const):
            return index(int(one.value) + int(other.value))
        return self.writer.checked("add", one, other, self.values.where, line=self.values.line)

    def must(self, condition: Expr, why: str) -> None:
        self.writer.expect(condition, "range", self.values.where, why, line=self.values.line)

    def room(self, total: Expr) -> View:
        """So many new bytes."""
        writer, lane = self.writer, lane_of(self.writer)
        self.must(Compare("ge", total, ZERO), "a size below 0")
        writer.emit(Reserve(lane, total))
        first = writer.let("computed", Used(lane))
        writer.emit(Advance(lane, total))
        return sound(writer, View(lane, first, writer.let("after", add(first, total))))

    # --- loops ---------------------------------------------------------------------------------------------------------------

    def fill(self, axes: list[_Axis], first: Expr, target: View, total: Expr) -> None:
        """Every byte of the target, where there are any: the loops of unknown length outside, those written out within."""
        loops, short = [each for each in axes if each.numbers is None], [each for each in axes if each.numbers is not None]
        with self.writer.nested() as some:
            self.around(loops, short, first, ZERO, target)
        self.writer.emit(If(Compare("gt", total, ZERO), block(some)))

    def around(self, loops: list[_Axis], short: list[_Axis], at: Expr, to: Expr, target: View) -> None:
        if not loops:
            self.within(short, at, to, target, rounds=ONE, step=ZERO, apart=ZERO)
            return
        axis, *inner = loops
        if not inner:
            self.within(short, at, to, target, rounds=axis.count, step=axis.step, apart=axis.apart)
            return
        number = Local("i64", self.writer.fresh("number"))
        with self.writer.nested() as body:
            self.around(inner, short, self.plus(at, self.times(number, axis.step)), self.plus(to, self.times(number, axis.apart)), target)
        self.writer.emit(For(number.name, axis.count, block(body)))

    def within(self, short: list[_Axis], at: Expr, to: Expr, target: View, *, rounds: Expr, step: Expr, apart: Expr) -> None:
        """The innermost loop: its first and last round are checked, for all others lie between them."""
        writer, numbers = self.writer, [range(len(each.numbers or ())) for each in short]
        reads: list[tuple[Expr, Expr]] = []
        for chosen in product(*numbers):
            source, aim = at, to
            for axis, each in zip(short, chosen, strict=True):
                assert axis.numbers is not None
                source = self.plus(source, self.times(index(axis.numbers[each]), axis.step))
                aim = self.plus(aim, self.times(index(each), axis.apart))
            reads.append((_let(writer, source), _let(writer, aim)))
        self.must(Compare("ge", rounds, ONE), "a size below 1")
        last = writer.let("last", add(rounds, -1))
        for source, aim in reads:
            for begin, distance, size in ((source, step, self.size), (aim, apart, target.size)):
                end = self.plus(begin, self.times(last, distance))
                for each in (begin, end):
                    self.must(Compare("ge", each, ZERO), "a byte outside of the array")
                    self.must(Compare("lt", each, size), "a byte outside of the array")
        number = Local("i64", writer.fresh("number"))
        with writer.nested() as body:
            for source, aim in reads:
                place, put = (self.moved(each, number, distance) for each, distance in ((source, step), (aim, apart)))
                if not (isinstance(step, Const) and isinstance(apart, Const)):
                    self.must(Compare("ge", place, ZERO), "a byte outside of the array")
                    self.must(Compare("lt", place, self.size), "a byte outside of the array")
                    self.must(Compare("ge", put, ZERO), "a byte outside of the array")
                    self.must(Compare("lt", put, target.size), "a byte outside of the array")
                assert target.lane is not None
                value = writer.let("byte", byte_at(self.lane, Binary("add", self.begin, place)))
                writer.emit(SetField(Place(target.lane, Binary("add", target.first, put)), value))
        writer.emit(For(number.name, rounds, block(body)))

    def moved(self, begin: Expr, number: Expr, distance: Expr) -> Expr:
        if isinstance(distance, Const):
            return begin if distance == ZERO else Binary("add", begin, mul(number, int(distance.value)))
        return self.plus(begin, self.times(number, distance))

    def padded(self, plain: View, rows: Expr, size: Expr, stride: Expr) -> View:
        """Rows of the bytes so far apart, with zeros between them."""
        writer = self.writer
        for each in (rows, size, stride):
            self.must(Compare("ge", each, ZERO), "a size below 0")
        self.must(Compare("le", size, stride), "rows that overlap")
        target = self.room(writer.let("total", self.product([rows, stride])))
        self.must(Compare("le", plain.after, target.first), "bytes that overlap")
        number = Local("i64", writer.fresh("row"))
        with writer.nested() as body:
            source, aim = (self.times(number, each) for each in (size, stride))
            for begin, width, view in ((source, size, plain), (aim, stride, target)):
                self.must(Compare("ge", begin, ZERO), "a row outside of the array")
                self.must(Compare("le", begin, Binary("sub", view.size, width)), "a row outside of the array")
            assert plain.lane is not None
            assert target.lane is not None
            begin = writer.let("begin", Binary("add", target.first, aim))
            writer.emit(Copy(Place(target.lane, begin), Place(plain.lane, Binary("add", plain.first, source)), size))
            rest = writer.let("rest", Binary("sub", stride, size))
            writer.emit(Fill(Place(target.lane, Binary("add", begin, size)), rest, 0))
        writer.emit(For(number.name, rows, block(body)))
        return target


def _let(writer: Writer, value: Expr) -> Expr:
    return value if isinstance(value, Const) else writer.let("at", value)


def _plain(writer: Writer, value: Expr) -> Expr:
    return value if isinstance(value, Const) else writer.let("step", value)


ROW = Row(
    "images",
    "`permuted(decompress(b), [2, 1, 0])`, `compress(rows(p, h, n, step), …)`",
    ("an [order](#whole-arrays) of bytes that one of these functions makes or takes", "the bytes in this order"),
)

FUNCTIONS = (Function(ORDERED, _never_written, _lower, SEVERAL, NOT_FOLLOWED, (ROW,), operation="image compression", kept=False),)
