"""The values that a reduction makes one of: each is computed in turn, in a loop over the elements."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager

from rosetta_jit.kernel.nodes import Binary, Expr, For, Local
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.language import typed
from rosetta_jit.lowering.arithmetic import inside
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.writer import Writer, block
from rosetta_jit.startup.dataclass import dataclass

BLOCK = 1 << 16
"""How many elements a block has: so many integers of 32 bits add up to one of 64."""


@dataclass(frozen=True, slots=True)
class Elements:
    """What is reduced, how many there are, and how each is computed."""

    reduce: typed.Reduce
    count: Expr
    values: Evaluation

    @property
    def writer(self) -> Writer:
        """The writer that takes the statements."""
        return self.values.writer

    @property
    def taken(self) -> Expr:
        """How many elements are taken, of those that there are."""
        return self.count if self.reduce.chosen is None else self.values.of(self.reduce.chosen)

    @contextmanager
    def each(self) -> Generator[Expr]:
        """Around what is done with each value, from the first to the last."""
        writer, number = self.writer, Local("i64", self.writer.fresh("element"))
        self.values.look_ahead((self.reduce.value,))
        writer.certain.add(inside(number, self.count))
        if isinstance(self.reduce.count, typed.LenOf):
            writer.certain.add(inside(number, self.values.of(self.reduce.count)))
        with self.values.source.forgetting(), writer.nested() as body:
            yield self.values.with_local(self.reduce.variable.name, number).of(self.reduce.value)
        writer.emit(For(number.name, self.count, block(body)))

    @contextmanager
    def blocks(self) -> Generator[tuple[Expr, Expr]]:
        """Around what is done with each block of elements, from the first to the last: the number of its first one, and how many it has."""
        writer, number = self.writer, Local("i64", self.writer.fresh("block"))
        self.values.look_ahead((self.reduce.value,))
        with self.values.source.forgetting(), writer.nested() as body:
            first = writer.let("first", mul(number, index(BLOCK)))
            yield first, writer.let("size", Binary("min", Binary("sub", self.count, first), index(BLOCK)))
        count = writer.let("blocks", Binary("div", add(self.count, index(BLOCK - 1)), index(BLOCK)))
        writer.emit(For(number.name, count, block(body)))

    @contextmanager
    def each_of(self, first: Expr, size: Expr) -> Generator[Expr]:
        """Around what is done with each value of a block."""
        writer, number = self.writer, Local("i64", self.writer.fresh("element"))
        with self.values.source.forgetting(), writer.nested() as body:
            yield self.values.with_local(self.reduce.variable.name, writer.let("number", add(first, number))).of(self.reduce.value)
        writer.emit(For(number.name, size, block(body)))
