"""Arrays that a function makes of others: how many elements they have, and the loops that set each."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Protocol

from rosetta_jit.kernel.nodes import Expr, For, Local
from rosetta_jit.language import typed
from rosetta_jit.lowering.arithmetic import inside
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.writer import block
from rosetta_jit.model.types import Array, Int, Type
from rosetta_jit.startup.dataclass import dataclass


class Put(Protocol):
    """Sets the element of a number to a value, and gives that as an element has it; what does not fit is refused."""

    def __call__(self, number: Expr, value: Expr) -> Expr: ...


UINT8 = Int(8, signed=False)


@dataclass(frozen=True, slots=True)
class MadeArray:
    """An array: how many elements there are, and what sets them all, where there is room for them."""

    count: Expr
    fill: Callable[[Put], None]


@dataclass(frozen=True, slots=True)
class ArrayArgument:
    """An array, or bytes, that a function reads."""

    place: typed.Place
    values: Evaluation

    @property
    def element(self) -> Type:
        """The type of an element."""
        return self.place.type.element if isinstance(self.place.type, Array) else UINT8

    @property
    def count(self) -> Expr:
        """How many elements there are."""
        return self.values.source.count(self.place, self.values)

    def at(self, number: Expr) -> Expr:
        """The element of a number; outside of the array it is an error of kind ``index``."""
        variable = typed.Local(f"(given {len(self.values.variables)})")
        element = typed.Place(self.place.side, (*self.place.steps, typed.IndexStep(variable)), self.element)
        return self.values.with_local(variable.name, number).of(typed.Access(element, self.element))

    @contextmanager
    def each(self, count: Expr | None = None) -> Generator[Local]:
        """Around what is done with the number of each element, or of the first ones."""
        writer = self.values.writer
        number, stop = Local("i64", writer.fresh("element")), self.count if count is None else count
        if count is None:
            writer.certain.add(inside(number, stop))
        with self.values.source.forgetting(), writer.nested() as body:
            yield number
        writer.emit(For(number.name, stop, block(body)))


def array_argument(argument: typed.Expr, values: Evaluation) -> ArrayArgument:
    """The array that an argument names."""
    assert isinstance(argument, typed.Access)
    return ArrayArgument(argument.place, values)
