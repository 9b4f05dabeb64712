"""Series as LLVM blocks: a loop over the rows of their tables, or a block that many cases of a switch lead to."""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from llvmlite import ir

from rosetta_jit.backends.llvm.alike import NOTHING, Number, Series
from rosetta_jit.backends.llvm.expr import expression, fill_memory
from rosetta_jit.backends.llvm.frame import Frame, Stretch
from rosetta_jit.backends.llvm.tables import signed, table
from rosetta_jit.backends.llvm.values import I64, LLVM_TYPES, constant, forgotten, state_word
from rosetta_jit.kernel.nodes import Block, Direction, Local, Switch
from rosetta_jit.kernel.state import LANE_WORDS, USED, lane_word
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    Printer = Callable[[Frame, Block], None]

FEW_LANES = 64
"""Lanes up to which the used lengths of all are copied one by one: a loop takes twice as long."""


@dataclass(frozen=True, slots=True)
class Row:
    """The row of a series' table at an index. Numbers that grow by the same from row to row are computed, others loaded."""

    series: Series
    index: ir.Value
    module: ir.Module

    def number(self, builder: ir.IRBuilder, number: Number) -> ir.Value:
        """A number of the row, where a builder stands."""
        column = [row[number.column] for row in self.series.rows]
        step = column[1] - column[0]
        if all(after - before == step for before, after in pairwise(column)):
            return builder.add(builder.mul(self.index, _constant(step)), _constant(column[0] + number.further))
        start = builder.mul(self.index, constant(len(self.series.rows[0])))
        place = builder.add(start, constant(number.column))
        value = builder.load(
            state_word(builder, table(self.module, [each for row in self.series.rows for each in row]), place), typ=I64, align=8
        )
        return builder.add(value, constant(number.further)) if number.further else value


def print_series(frame: Frame, series: Series, block: Printer) -> None:
    """A loop over the stretches."""
    builder = frame.builder
    before, head, behind = builder.block, frame.block("stretch"), frame.block("after")
    firsts = [expression(frame, Local(each.type, each.first)) for each in series.carried]
    builder.branch(head)
    builder.position_at_end(head)
    index, values = builder.phi(I64), [builder.phi(LLVM_TYPES[each.type]) for each in series.carried]
    for each, value in zip(series.carried, values, strict=True):
        frame.locals[each.name] = forgotten(builder, value) if value.type == I64 else value
    _stretch(frame, series, index, block)
    lasts = [expression(frame, Local(each.type, each.last)) for each in series.carried]
    following = builder.add(index, constant(1), flags=("nsw",))
    starts, rounds = (constant(0), *firsts), (following, *lasts)
    for phi, start, again in zip((index, *values), starts, rounds, strict=True):
        phi.add_incoming(start, before)
        phi.add_incoming(again, builder.block)
    builder.cbranch(builder.icmp_signed("<", following, constant(len(series.rows))), head, behind)
    builder.position_at_end(behind)


def print_cases(
    frame: Frame,
    switch: Switch,
    printed: ir.SwitchInstr,
    block: Printer,
    leave: Callable[[Block], object],
    blocks: dict[int, ir.Block] | None = None,
) -> Container[int]:
    """The cases of a switch that are alike, each series once, with what ``leave`` prints behind it; which these are.

    They begin in blocks of their own, or in ``blocks``.
    """
    builder, known = frame.builder, set[int]()
    for cases in frame.alike.cases(switch):
        shared = frame.block("alike")
        builder.position_at_end(shared)
        index = builder.phi(I64)
        for number, each in enumerate(cases.numbers):
            case = frame.block(f"case{each}") if blocks is None else blocks[each]
            printed.add_case(ir.Constant(LLVM_TYPES[type_of(switch.value)], each), case)
            index.add_incoming(constant(number), case)
            ir.IRBuilder(case).branch(shared)
        _stretch(frame, cases.series, index, block)
        if not builder.block.is_terminated:
            leave(cases.series.body)
        known |= set(cases.numbers)
    return known


def _stretch(frame: Frame, series: Series, index: ir.Value, block: Printer) -> None:
    """A stretch with the numbers of a row of its table. What repeats itself inside is printed as it stands: one table is used at a time."""
    builder = frame.builder
    row = Row(series, index, frame.module)
    for name, (type_, number) in series.constants.items():
        frame.locals[name] = builder.trunc(row.number(builder, number), LLVM_TYPES[type_])
    columns = {column: row.number(builder, Number(column, 0)) for column in columns_of(series)}
    words = words_of(builder, frame.parameters.state, series, columns)
    stretch = Stretch(series.lanes, series.offsets, columns, words, series.sites, row.number)
    around, frame.alike, frame.stretch = frame.alike, NOTHING, stretch
    block(frame, series.body)
    frame.alike, frame.stretch = around, None


def columns_of(series: Series) -> list[int]:
    """The columns with the numbers of lanes and offsets."""
    return sorted({each.column for each in (*series.lanes.values(), *series.offsets.values())})


def words_of(builder: ir.IRBuilder, state: ir.Value, series: Series, columns: Mapping[int, ir.Value]) -> dict[int, ir.Value]:
    """Where the words of lanes lie whose numbers stand in columns."""
    wanted = sorted({each.column for each in series.lanes.values()})
    return {each: state_word(builder, state, builder.mul(columns[each], constant(LANE_WORDS))) for each in wanted}


def _constant(number: int) -> ir.Constant:
    return constant(signed(number))


# --- used lengths --------------------------------------------------------------------------------------------------------


def begin_rows(frame: Frame, direction: Direction) -> None:
    """An array of the used lengths of the holder's lanes, as the body begins with them: to decode into row 0 empties all behind lane 0."""
    array = ir.ArrayType(I64, frame.own_lanes)
    frame.rows = rows = frame.entry.alloca(array, name="rows")
    builder = frame.builder

    def start(lane: ir.Value) -> None:
        builder.store(builder.load(_used_word(frame, builder, lane), typ=I64, align=8), state_word(builder, rows, lane), align=8)

    if direction == "decode":
        empty, later, behind = (frame.block(name) for name in ("empty", "later", "body"))
        builder.cbranch(builder.icmp_signed("==", frame.parameters.row, constant(0)), empty, later)
        builder.position_at_end(empty)
        fill_memory(frame, rows, 0, constant(8 * frame.own_lanes))
        start(constant(0))
        builder.branch(behind)
        builder.position_at_end(later)
        _each(builder, frame.own_lanes, start)
        builder.branch(behind)
        builder.position_at_end(behind)
    else:
        _each(builder, frame.own_lanes, start)


def end_rows(frame: Frame, lanes: Sequence[int]) -> None:
    """The array in the state, where the body has succeeded; ``lanes`` are those that may have changed."""
    rows = frame.rows
    assert rows is not None
    builder = ir.IRBuilder(frame.done.block)
    if lanes:
        _each(builder, frame.own_lanes, lambda lane: _keep(frame, builder, rows, lane))
    builder.ret(frame.done.phis[0])


def _keep(frame: Frame, builder: ir.IRBuilder, rows: ir.Value, lane: ir.Value) -> None:
    builder.store(builder.load(state_word(builder, rows, lane), typ=I64), _used_word(frame, builder, lane), align=8)


def _each(builder: ir.IRBuilder, count: int, body: Callable[[ir.Value], None]) -> None:
    """Do something for each of some lanes: in a loop, where they are many."""
    if count <= FEW_LANES:
        for lane in range(count):
            body(constant(lane))
        return
    before, head, behind = builder.block, builder.append_basic_block("lane"), builder.append_basic_block("after")
    builder.branch(head)
    builder.position_at_end(head)
    index = builder.phi(I64)
    body(index)
    following = builder.add(index, constant(1), flags=("nsw",))
    index.add_incoming(constant(0), before)
    index.add_incoming(following, builder.block)
    builder.cbranch(builder.icmp_signed("<", following, constant(count)), head, behind)
    builder.position_at_end(behind)


def _used_word(frame: Frame, builder: ir.IRBuilder, lane: ir.Value) -> ir.Value:
    first = state_word(builder, frame.parameters.state, builder.mul(lane, constant(LANE_WORDS)))
    return state_word(builder, first, lane_word(0, USED))
