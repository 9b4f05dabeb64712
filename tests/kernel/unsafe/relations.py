"""Kernels whose safety rests on how values relate to each other: an operation to its operands, a long sum to its parts."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Advance, Binary, Compare, Convert, Fill, Let, Load, Reserve, Select, Used, Wire
from rosetta_jit.kernel.terms import BEGIN, add, index
from tests.kernel.kernels import compare, expect, i64, need
from tests.kernel.unsafe.cases import AT, TWO, Cases, M, N, both, plus, put, rows, sub

CASES = Cases()


def of(n, m):
    """Two numbers of the message between bounds."""
    ranges = [compare(op, i64(name), end) for name, ends in (("n", n), ("m", m)) for op, end in zip(("ge", "le"), ends, strict=True)]
    return *TWO, expect(both(*ranges))


for what, expr, most in (
    ("a quotient is no more than what is divided", Binary("div", N, M), N),
    ("a remainder is no more than what is divided", Binary("rem", N, M), N),
    ("a remainder is less than the divisor", Binary("rem", N, M), sub(M, 1)),
    ("an or is no more than the sum", Binary("or", N, M), plus(N, M)),
    ("an and is no more than either", Binary("and", N, M), M),
    ("a choice is no more than the greater", Select(compare("ge", N, 5), N, M), Binary("max", N, M)),
    ("a shift to the right is no more than what is shifted", Binary("shr", N, M), N),
    ("a minimum is no more than either", Binary("min", N, M), M),
    ("a product grows with a factor", Binary("mul", N, M), Binary("mul", N, plus(M, 1))),
):
    some = *of((0, 20), (1, 20)), Reserve(1, plus(most, 1)), Let("c", Used(1)), Advance(1, plus(most, 1))
    CASES.accept(what, (*some, put(expr)))
    CASES.add(f"{what}, and not less by two", "a row outside its lane", (*some, put(plus(expr, 2))))

PARTS = [f"part_{k}" for k in range(7)]
LONG = need(BEGIN, 7), *(Let(name, Convert("i64", Load("i8", add(BEGIN, k)))) for k, name in enumerate(PARTS))


def total():
    """A sum that is so long that the proof gives it a name."""
    made = i64(PARTS[0])
    for name in PARTS[1:]:
        made = plus(made, i64(name))
    return made


LONG_SUM = *LONG, expect(both(Compare("ge", total(), index(0)), Compare("le", total(), index(9)))), Let("n", total())
CASES.add("a long sum: one row too few", "a row outside its lane", (*LONG_SUM, *rows(9), put(N)), (*LONG_SUM, *rows(10), put(N)))
CASES.add("a long sum: one row before the first", "a row that may be negative", (*LONG_SUM, *rows(10), put(sub(N, 1))))
CASES.add("a long sum that may be negative", "a row that may be negative", (*LONG, Let("n", total()), *rows(999), put(N)))
LONG_WAY = *LONG, expect(Compare("ge", total(), index(0))), need(BEGIN, total()), Let("at", plus(BEGIN, total()))
CASES.add(
    "a position that is a long sum",
    "bytes beyond the end of the message",
    (*LONG_WAY, Fill(Wire(AT), index(1))),
    (*LONG_WAY, Fill(Wire(AT), index(0))),
)
CASES.add(
    "a position that is a long sum, too far back",
    "bytes before the begin of the message",
    (*LONG_WAY, expect(compare("ge", BEGIN, 1)), Fill(Wire(sub(AT, 1)), index(1))),
    (*LONG_WAY, expect(Compare("gt", total(), index(0))), Fill(Wire(sub(AT, 1)), index(1))),
)
HALVES = (
    plus(plus(i64("part_0"), i64("part_1")), i64("part_2")),
    plus(plus(i64("part_3"), i64("part_4")), plus(i64("part_5"), i64("part_6"))),
)
SUM_OF_TWO = *LONG, *(expect(Compare("ge", half, index(0))) for half in HALVES), Let("n", plus(*HALVES))
CASES.add(
    "a long sum of two that are not negative",
    "a row that may be negative",
    (*SUM_OF_TWO, *rows(999), put(sub(N, 1))),
    (*SUM_OF_TWO, *rows(999), put(N)),
)
