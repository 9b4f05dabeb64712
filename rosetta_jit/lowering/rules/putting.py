"""The elements of an array that a function makes, set one by one."""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Binary, Compare, Convert, If, Local
from rosetta_jit.kernel.terms import index, type_of
from rosetta_jit.lowering.rules.values import NAMES, RANGES, scalar_type
from rosetta_jit.lowering.writer import block
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.kernel.ir import Expr, Scalar
    from rosetta_jit.language import typed
    from rosetta_jit.lowering.made_arrays import Put
    from rosetta_jit.lowering.rules.holder_side import HolderSide
    from rosetta_jit.lowering.rules.values import Values
    from rosetta_jit.lowering.writer import Where


@dataclass(slots=True)
class Putting:
    """Sets elements by their numbers: ``element`` is the place of the one whose number is that of the variable.

    Of integers that may not fit, `beyond` gathers the bits that are lost, so that no round waits for a check. Where there are such bits,
    `check` makes all values once more, and refuses the first that does not fit.
    """

    target: HolderSide
    element: typed.Place
    variable: typed.Local
    values: Values
    beyond: Local | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        if self.scalar in RANGES and self.scalar != "i64":
            self.beyond = self.values.writer.var("beyond", index(0))

    @property
    def scalar(self) -> Scalar:
        """What an element is."""
        return scalar_type(self.element.type)

    def __call__(self, number: Expr, value: Expr) -> Expr:
        writer = self.values.writer
        variables, where = {**self.values.variables, self.variable.name: number}, self.values.where.element(number)
        inner = replace(self.values, variables=variables, where=where)
        if self.beyond is not None and type_of(value) == "i64":
            wide = writer.let("wide", value)
            found = writer.let("number", Convert(self.scalar, wide))
            lost = Binary("shr", wide, index(63)) if self.scalar == "u64" else Binary("xor", wide, Convert("i64", found))
            writer.assign(self.beyond, Binary("or", self.beyond, lost))
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
        none_lost = Compare("eq", self.beyond, index(0))
        writer.emit(If(Compare("ne", self.beyond, index(0)), block(again)))
        self._expect(none_lost, self.values.where)  # others than before, if they fit the second time

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
