"""Relations to digits of one integer: `.ready <-> .status & 1 != 0` and `.mode <-> int32(.status >> 4 & 7)` together say what `.status` is.

A digit is `modulo(floor_divide(x, low), n)`, with `high = low * n`; bits are digits, too (`language.both_ways.bits`). Packing adds each
digit times its `low`, when it has checked that the digit is from 0 to below `n`. Digits of no relation are 0.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.inverse import CONVERSIONS, Solution, condition_in, fields_in, may_round, named, solve
from rosetta_jit.language.both_ways.inverse_parts import Digit, until
from rosetta_jit.language.folding import folded
from rosetta_jit.model.expr import Binary, Call, Expr, Literal, Nearest
from rosetta_jit.model.mapping import Relation
from rosetta_jit.model.types import Bool, Enum, Float, Int
from rosetta_jit.model.walk import fields_of, parts
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf
    from rosetta_jit.language.both_ways.joint_relations import Related
    from rosetta_jit.language.both_ways.knowledge import Loops

BEYOND = 1 << 63


@dataclass(frozen=True, slots=True)
class _Taken:
    """The digit of ``whole`` from ``low`` to ``high``, None where it is all that is above; and the ``call`` that gives it."""

    whole: Expr
    low: int
    high: int | None
    call: Expr

    @property
    def below(self) -> int | None:
        return None if self.high is None else self.high // self.low


@dataclass(frozen=True, slots=True)
class Digits:
    """An integer, and the relations to its digits, from the highest on."""

    whole: Expr
    relations: tuple[Related, ...]

    def solved(self, type_of: TypeOf) -> Solution:
        """The integer that has these digits.

        Raises
        ------
        NoInverseError
        """
        total: Expr | None = None
        for rule, _ in self.relations:
            taken, number = _number(rule, type_of)
            each = number if taken.low == 1 else Binary("*", number, Literal(taken.low, rule.span), rule.span)
            total = each if total is None else Binary("+", total, each, rule.span)
        assert total is not None
        return solve(self.whole, total, type_of)

    def length(self, type_of: TypeOf) -> None:
        """An integer has none."""
        del type_of

    def digits(self, type_of: TypeOf) -> dict[int, tuple[Digit, ...]]:
        """What must be less than what, by the relation that says it; a bool is, as it is."""
        found: dict[int, tuple[Digit, ...]] = {}
        for rule, _ in self.relations:
            taken, number = _number(rule, type_of)
            is_flag = isinstance(number, Call) and isinstance(type_of(rule.place), Bool) and taken.below == 2
            if taken.below is not None and not is_flag:
                found[id(rule)] = (Digit(number, taken.below),)
        return found

    @property
    def refused(self) -> tuple[tuple[Expr, str], ...]:
        """None: what digits leave of a message is lost, and the law says so."""
        return ()


def digits_of(relations: list[Related]) -> list[Digits]:
    """The integers of which relations name digits, where no relation says all of the integer."""
    found: dict[tuple[Expr, Loops], list[tuple[_Taken, Related]]] = {}
    whole: set[object] = set()
    for rule, loops in relations:
        taken = _taken_in(rule)
        if taken is not None:
            found.setdefault((taken.whole, loops), []).append((taken, (rule, loops)))
        elif len(fields_in(rule.value)) == 1:
            whole.add((fields_in(rule.value)[0], loops))
    groups: list[Digits] = []
    for (integer, loops), related in found.items():
        ordered = _apart(related)
        if (fields_in(integer)[0], loops) not in whole and [taken.high for taken, _ in ordered] != [None]:
            groups.append(Digits(integer, tuple(each for _, each in reversed(ordered))))
    return groups


def _apart(related: list[tuple[_Taken, Related]]) -> list[tuple[_Taken, Related]]:
    """The digits from the lowest on, without those that lie in larger ones: relations to them are checks."""
    found: list[tuple[_Taken, Related]] = []
    for each in sorted(related, key=lambda each: -(each[0].below or BEYOND)):
        together = sorted([*found, each], key=lambda one: one[0].low)
        if all(one.high is not None and other.low % one.high == 0 for (one, _), (other, _) in pairwise(together)):
            found = together
    return found


def _taken_in(rule: Relation) -> _Taken | None:
    """The digit that a relation takes of its only field."""
    if len(fields_in(rule.value)) != 1 or fields_of(rule.place, "wire") or condition_in(rule.value):
        return None
    call = next((each for each in parts(rule.value) if isinstance(each, Call) and each.function in ("floor_divide", "modulo")), None)
    found = None if call is None else _taken(call)
    return None if found is None or found.whole == call or not fields_in(found.whole) else found


def _taken(expr: Expr) -> _Taken | None:
    """What divisions within each other take; None where they do not come out even."""
    match expr:
        case Call("floor_divide" | "modulo" as function, (inner, divisor)):
            before, by = _taken(inner), folded(divisor)
            if before is None or not isinstance(by, Literal) or type(by.value) is not int or by.value <= 0:
                return None
            end = before.low * by.value
            if end >= BEYOND or (before.high is not None and (before.high % end or before.high == end)):
                return None
            low, high = (end, before.high) if function == "floor_divide" else (before.low, end)
            return _Taken(before.whole, low, high, expr)
        case Call(function, (_,)) if function not in CONVERSIONS:
            return None
        case _:
            return _Taken(expr, 1, None, expr)


def _number(rule: Relation, type_of: TypeOf) -> tuple[_Taken, Expr]:
    """What a digit must be: the nearest integer where it is computed with floats, if the relation gives the same of it."""
    taken = _taken_in(rule)
    assert taken is not None
    assert isinstance(taken.call, Call)
    number = until(rule.value, rule.place, taken.call, type_of)
    type_ = type_of(number)
    if isinstance(type_, Float) and may_round(rule.value):
        return taken, Nearest(number, named(rule.value, taken.call), rule.place, _type_of_digit(taken, type_of), rule.span)
    return taken, Call("int64", (number,), rule.span) if isinstance(type_, Bool | Enum) else number


def _type_of_digit(taken: _Taken, type_of: TypeOf) -> Int:
    """The narrowest type of a digit, so that it meets floats as the digit does; all that is above has at most the type of the whole."""
    whole = type_of(taken.whole)
    if taken.below is None and isinstance(whole, Int) and whole.bits <= 32:
        return whole
    narrow = (Int(8, signed=False), Int(16, signed=False), Int(32, signed=False))
    return next((each for each in narrow if taken.below is not None and taken.below <= 1 << each.bits), Int(64))
