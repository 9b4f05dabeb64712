"""The elements of an array that a function makes, set one by one."""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Binary, Compare, Convert, Local, Select
from rosetta_jit.kernel.terms import index, type_of
from rosetta_jit.lowering.rules.values import NAMES, RANGES, scalar_type
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.kernel.ir import Expr, Scalar
    from rosetta_jit.language import typed
    from rosetta_jit.lowering.rules.holder_side import HolderSide
    from rosetta_jit.lowering.rules.values import Values

NONE = index((1 << 63) - 1)
"""The number of no element."""


@dataclass(slots=True)
class Putting:
    """Sets elements by their numbers: ``element`` is the place of the one whose number is that of the variable.

    Integers that do not fit are refused behind all of them, at the first that does not: so no round waits for a check.
    """

    target: HolderSide
    element: typed.Place
    variable: typed.Local
    values: Values
    wrong: Local = field(init=False)

    def __post_init__(self) -> None:
        self.wrong = self.values.writer.var("wrong", NONE)

    @property
    def scalar(self) -> Scalar:
        """What an element is."""
        return scalar_type(self.element.type)

    def __call__(self, number: Expr, value: Expr) -> Expr:
        writer = self.values.writer
        variables, where = {**self.values.variables, self.variable.name: number}, self.values.where.element(number)
        inner = replace(self.values, variables=variables, where=where)
        if type_of(value) == "i64" and self.scalar in RANGES and self.scalar != "i64":
            wide = writer.let("wide", value)
            found = writer.let("number", Convert(self.scalar, wide))
            fits = Compare("ge", wide, index(0)) if self.scalar == "u64" else Compare("eq", Convert("i64", found), wide)
            writer.assign(self.wrong, Binary("min", self.wrong, Select(fits, NONE, number)))
        else:
            found = writer.let("number", value if type_of(value) == self.scalar else inner.convert(value, self.scalar, "exact"))
        self.target.set_number(self.element, found, inner)
        return found

    def check(self) -> None:
        """That all numbers fit."""
        where = self.values.where.element(self.wrong)
        self.values.writer.expect(
            Compare("eq", self.wrong, NONE),
            "range",
            where,
            f"the value does not fit {NAMES.get(self.scalar, self.scalar)}",
            line=self.values.line,
        )
