"""The values that a reduction makes one of: each is computed in turn, in a loop over the elements."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import For, Local
from rosetta_jit.lowering.arithmetic import inside
from rosetta_jit.lowering.writer import block
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Generator

    from rosetta_jit.kernel.ir import Expr
    from rosetta_jit.language import typed
    from rosetta_jit.lowering.evaluation import Evaluation
    from rosetta_jit.lowering.writer import Writer


@dataclass(frozen=True, slots=True)
class Elements:
    """What is reduced, how many there are, and how each is computed."""

    reduce: typed.Reduce
    count: Expr
    values: Evaluation

    @property
    def writer(self) -> Writer:
        """Where statements go."""
        return self.values.writer

    @contextmanager
    def each(self) -> Generator[Expr]:
        """Around what is done with each value, from the first to the last."""
        writer, number = self.writer, Local("i64", self.writer.fresh("element"))
        self.values.look_ahead((self.reduce.value,))
        writer.certain |= {inside(number, count) for count in (self.count, self.values.of(self.reduce.count))}
        with self.values.source.forgetting(), writer.nested() as body:
            yield self.values.with_local(self.reduce.variable.name, number).of(self.reduce.value)
        writer.emit(For(number.name, self.count, block(body)))
