"""What formulas of the proof say, and what its atoms stand for, in the words of z3: as integers, or as bits where bits are asked about."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never, cast

import z3

from rosetta_jit.kernel.arithmetic import limits
from rosetta_jit.kernel.nodes import Scalar
from rosetta_jit.kernel.proof.formula import All, Any, Formula
from rosetta_jit.kernel.proof.linear import Linear

if TYPE_CHECKING:
    from rosetta_jit.kernel.proof.record import RecordedFacts

BITS = 160
"""Bits in which no sum of products of two 64-bit numbers wraps."""

NAMES = {0: "begin", 1: "length", 2: "row"}
"""The first atoms of a body (`scope.entry`); those of a routine have no row to speak of."""

BITWISE = ("and", "or", "xor")


def atoms_in(formula: object) -> set[int]:
    """The atoms of a formula, or of what an atom stands for."""
    match formula:
        case Linear(_, terms):
            return {atom for atom, _ in terms}
        case All(parts) | Any(parts):
            return set[int]().union(*map(atoms_in, parts))
        case ("mul", int(a), int(b)):
            return {a, b}
        case tuple():
            return set[int]().union(*map(atoms_in, cast("tuple[object, ...]", formula)))
        case _:
            return set()


class Terms:
    """The atoms of a part of a kernel as integers of z3, or as bits."""

    def __init__(self, facts: RecordedFacts, *, as_bits: bool = False) -> None:
        self._facts = facts
        self._as_bits = as_bits
        self._atoms: dict[int, z3.ExprRef] = {}

    # --- formulas ----------------------------------------------------------------------------------------------------

    def said(self, formula: Formula) -> z3.BoolRef:
        """A formula that is taken as known: a part of which nothing is known says nothing."""
        return self._formula(formula, unknown=True)

    def claimed(self, formula: Formula) -> z3.BoolRef:
        """A formula that is claimed: a part of which nothing is known cannot be relied on."""
        return self._formula(formula, unknown=False)

    def _formula(self, formula: Formula, *, unknown: bool) -> z3.BoolRef:
        match formula:
            case bool():
                return z3.BoolVal(formula)
            case None:
                return z3.BoolVal(unknown)
            case Linear():
                return self.sum(formula) >= 0
            case All(parts):
                return z3.And([self._formula(part, unknown=unknown) for part in parts])
            case Any(parts):
                return z3.Or([self._formula(part, unknown=unknown) for part in parts])
            case _:
                assert_never(formula)

    # --- sums --------------------------------------------------------------------------------------------------------

    def atom(self, number: int) -> z3.ExprRef:
        """An atom."""
        if number not in self._atoms:
            self._atoms[number] = self._unknown(NAMES.get(number, f"x{number}"))
        return self._atoms[number]

    def sum(self, linear: Linear) -> z3.ExprRef:
        """A linear sum."""
        total = self._number(linear.constant)
        for atom, coefficient in linear.terms:
            total = total + self._number(coefficient) * self.atom(atom)
        return total

    def range(self, number: int) -> z3.BoolRef:
        """The range of an atom on every path."""
        low, high = self._facts.born(number)
        return z3.And(self.atom(number) >= self._number(low), self.atom(number) <= self._number(high))

    def _unknown(self, name: str) -> z3.ExprRef:
        return z3.BitVec(name, BITS) if self._as_bits else z3.Int(name)

    def _number(self, value: int) -> z3.ExprRef:
        return z3.BitVecVal(value, BITS) if self._as_bits else z3.IntVal(value)

    # --- what atoms stand for ----------------------------------------------------------------------------------------

    def operands(self, number: int) -> set[int]:
        """The atoms in what an atom stands for."""
        return atoms_in(self._facts.meanings.get(number))

    def is_bitwise(self, number: int) -> bool:
        """Whether an atom stands for an operation on bits."""
        match self._facts.meanings.get(number):
            case (str(op), *_):
                return op in BITWISE
            case _:
                return False

    def meaning(self, number: int) -> z3.BoolRef:
        """What an atom stands for; nothing, where it is any value of a range."""
        it = self.atom(number)
        if number in self._facts.choices:
            return z3.Or([z3.And(self.said(condition), it == self.sum(value)) for condition, value in self._facts.choices[number]])
        match self._facts.meanings.get(number):
            case ("mul", int(a), int(b)):
                return it == self.atom(a) * self.atom(b)
            case ("sum", Linear() as total):
                return it == self.sum(total)
            case ("host", str()) | ("register", int()):
                return self.range(number)
            case _ if self._as_bits:
                return self._of_bits(it, self._facts.meanings.get(number, ()))
            case (str(op), Linear() as left, Linear() | int() as right, *ends):
                return self._operation(number, op, self.sum(left), right, cast("list[tuple[int, int]]", ends))
            case ("low bits", str(type_), Linear() as value):
                return _low_bits(self.sum(value), it, limits(cast("Scalar", type_)), z3.Int(f"turns{number}"))
            case _:
                return z3.BoolVal(val=True)

    def _of_bits(self, it: z3.ExprRef, meaning: tuple[object, ...]) -> z3.BoolRef:
        """Operations on bits, and shifts by so many, which stand among them."""
        match meaning:
            case ("and" | "or" | "xor" as op, Linear() as left, Linear() as right, (int(low), int(high))):
                a, b = self.sum(left), self.sum(right)
                # That the operands are words of the operation's type was owed where they were made.
                words = [z3.And(each >= self._number(low), each <= self._number(high)) for each in (a, b)]
                return z3.And(*words, it == (a & b if op == "and" else a | b if op == "or" else a ^ b))
            case ("shr", Linear() as left, Linear(by, ()), *_):
                return it == self.sum(left) >> by
            case ("shl", Linear() as left, Linear(by, ()), (int(low), int(high))):
                return it == _as_word(self.sum(left) << by, (low, high))
            case ("low bits", str(type_), Linear() as value):
                return it == _as_word(self.sum(value), limits(cast("Scalar", type_)))
            case _:
                return z3.BoolVal(val=True)

    def _operation(self, number: int, op: str, left: z3.ExprRef, right: Linear | int, ends: list[tuple[int, int]]) -> z3.BoolRef:
        """Operations of integers: what else they have is an unknown that must exist."""
        it, other = self.atom(number), z3.Int(f"other{number}")
        match op, right:
            case "div", _:
                return _divided(left, self._divisor(right), it, other)
            case "rem", _:
                return _divided(left, self._divisor(right), other, it)
            case "shl", Linear(by, ()):
                return _low_bits(left * (1 << by), it, ends[0], other)
            case "shr", Linear(by, ()):
                return _rounded_down(left, z3.IntVal(1 << by), it, other)
            case "shl" | "shr", Linear():
                power = z3.Int(f"power{number}")
                shifted = _low_bits(left * power, it, ends[0], other) if op == "shl" else _rounded_down(left, power, it, other)
                return z3.And(power >= 1, shifted)
            case _:
                return z3.BoolVal(val=True)

    def _divisor(self, divisor: Linear | int) -> z3.ExprRef:
        return self.sum(divisor) if isinstance(divisor, Linear) else z3.IntVal(divisor)


def _divided(number: z3.ExprRef, divisor: z3.ExprRef, quotient: z3.ExprRef, rest: z3.ExprRef) -> z3.BoolRef:
    """Toward zero: the remainder has the sign of what is divided."""
    size = z3.If(divisor < 0, -divisor, divisor)
    signed = z3.If(number >= 0, z3.And(rest >= 0, rest < size), z3.And(rest <= 0, -rest < size))
    return z3.And(number == quotient * divisor + rest, signed)


def _low_bits(value: z3.ExprRef, it: z3.ExprRef, ends: tuple[int, int], turns: z3.ExprRef) -> z3.BoolRef:
    low, high = ends
    return z3.And(it == value + turns * (high - low + 1), it >= low, it <= high)


def _as_word(value: z3.ExprRef, ends: tuple[int, int]) -> z3.ExprRef:
    """The low bits of bits, as a number of a type."""
    low, high = ends
    size = (high - low).bit_length()
    word, more = z3.Extract(size - 1, 0, value), BITS - size
    return z3.SignExt(more, word) if low < 0 else z3.ZeroExt(more, word)


def _rounded_down(number: z3.ExprRef, divisor: z3.ExprRef, it: z3.ExprRef, rest: z3.ExprRef) -> z3.BoolRef:
    return z3.And(number == it * divisor + rest, rest >= 0, rest < divisor)
