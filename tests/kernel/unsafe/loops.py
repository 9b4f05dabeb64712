"""Kernels that are unsafe in one of the rounds of a loop, or behind it."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import (
    Advance,
    Assign,
    Binary,
    Compare,
    Const,
    Convert,
    Fill,
    For,
    If,
    Let,
    Load,
    Place,
    Reserve,
    Select,
    SetField,
    Used,
    Var,
    While,
    Wire,
)
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from tests.kernel.kernels import compare, expect, i64, need
from tests.kernel.unsafe.cases import AT, BRANCH, BYTE, START, Cases, N, X, between, plus, put, rows, sub

CASES = Cases()


INDEX = i64("i")
CASES.add(
    "a check in a loop of no rounds",
    "bytes beyond the end of the message",
    (*BYTE, For("i", N, (need(BEGIN, 8),)), X),
    (*BYTE, For("i", N, (need(BEGIN, 8), X))),
)
CASES.add(
    "the index behind the last",
    "a row outside its lane",
    (*between("n", 0, 9), Reserve(1, N), Let("c", Used(1)), Advance(1, N), For("i", N, (put(plus(INDEX, 1)),))),
    (*between("n", 0, 9), Reserve(1, N), Let("c", Used(1)), Advance(1, N), For("i", N, (put(INDEX),))),
)
CASES.add(
    "the index before the first",
    "a row that may be negative",
    (*between("n", 0, 9), *rows(9), For("i", N, (put(sub(INDEX, 1)),))),
    (*between("n", 0, 9), *rows(9), For("i", N, (put(INDEX),))),
)
CASES.add(
    "a loop of the message's length",
    "bytes beyond the end of the message",
    (For("i", sub(END, BEGIN), (Let("x", Load("u16", plus(BEGIN, INDEX))),)),),
    (For("i", sub(END, BEGIN), (Let("x", Load("u8", plus(BEGIN, INDEX))),)),),
)
CASES.add(
    "a position that a loop moves",
    "bytes beyond the end of the message",
    (Var("at", BEGIN), For("i", END, (need(AT, 1), Assign("at", add(AT, 2)))), Fill(Wire(AT), index(0))),
    (Var("at", BEGIN), For("i", END, (need(AT, 2), Assign("at", add(AT, 2)))), Fill(Wire(AT), index(0))),
)
CASES.add(
    "a position that a loop moves back",
    "bytes before the begin of the message",
    (
        Var("at", add(BEGIN, 9)),
        need(BEGIN, 9),
        For("i", index(9), (expect(compare("ge", AT, 1)), Assign("at", sub(AT, 1)))),
        Fill(Wire(AT), index(0)),
    ),
    (
        Var("at", add(BEGIN, 9)),
        need(BEGIN, 9),
        For("i", index(9), (expect(compare("gt", AT, BEGIN)), Assign("at", sub(AT, 1)))),
        Fill(Wire(AT), index(0)),
    ),
)
CASES.add(
    "a position that a loop within a loop moves",
    "bytes beyond the end of the message",
    (Var("at", BEGIN), For("i", END, (For("j", END, (need(AT, 1), Assign("at", add(AT, 2)))),)), Fill(Wire(AT), index(0))),
    (Var("at", BEGIN), For("i", END, (For("j", END, (need(AT, 2), Assign("at", add(AT, 2)))),)), Fill(Wire(AT), index(0))),
)
CASES.add(
    "a position that a branch of a loop moves",
    "bytes beyond the end of the message",
    (
        *BYTE,
        Var("at", BEGIN),
        For("i", END, (need(AT, 1), If(BRANCH, (Assign("at", add(AT, 2)),), (Assign("at", add(AT, 1)),)))),
        Fill(Wire(AT), index(0)),
    ),
    (
        *BYTE,
        Var("at", BEGIN),
        For("i", END, (need(AT, 2), If(BRANCH, (Assign("at", add(AT, 2)),), (Assign("at", add(AT, 1)),)))),
        Fill(Wire(AT), index(0)),
    ),
)
CASES.add(
    "a number that a loop changes",
    "a row outside its lane",
    (Var("k", index(0)), *rows(9), For("i", index(9), (Assign("k", INDEX),)), SetField(Place(1, i64("k")), index(1))),
    (Var("k", index(0)), *rows(9), For("i", index(9), (Assign("k", INDEX), SetField(Place(1, i64("k")), index(1))))),
)
CASES.add(
    "a number that a loop lowers",
    "a row that may be negative",
    (
        Var("k", index(3)),
        *rows(4),
        For("i", index(4), (expect(compare("gt", i64("k"), -5)), Assign("k", sub(i64("k"), 1)))),
        If(compare("lt", i64("k"), 4), (put(i64("k")),)),
    ),
    (
        Var("k", index(3)),
        *rows(4),
        For("i", index(4), (expect(compare("gt", i64("k"), 0)), Assign("k", sub(i64("k"), 1)))),
        If(compare("lt", i64("k"), 4), (put(i64("k")),)),
    ),
)
RAISED = Assign("k", add(i64("k"), 1))
CASES.add(
    "a number below zero that a loop raises",
    "a row that may be negative",
    (*between("n", 0, 9), *rows(10), Var("k", index(-1)), For("i", N, (RAISED,)), put(i64("k"))),
    (*between("n", 0, 9), *rows(10), Var("k", index(0)), For("i", N, (RAISED,)), put(i64("k"))),
)
CASES.add(
    "rows that each round uses",
    "rows that were not reserved",
    (Reserve(1, index(9)), For("i", index(9), (Advance(1, index(1)),))),
    (For("i", index(9), (Reserve(1, index(1)), Advance(1, index(1)))),),
)
CASES.add(
    "the first row of the loop",
    "a row outside its lane",
    (Reserve(1, index(1)), For("i", index(9), (SetField(Place(1, Used(1)), index(1)), Reserve(1, index(1)), Advance(1, index(1))))),
    (For("i", index(9), (Reserve(1, index(1)), SetField(Place(1, Used(1)), index(1)), Advance(1, index(1)))),),
)
INSIDE = compare("le", AT, END), compare("ge", AT, BEGIN)
STEP = Assign("at", add(AT, 1))
LOOP = compare("lt", AT, END)
CASES.add(
    "a round without progress",
    "a round that makes no progress",
    (START, While(LOOP, (), INSIDE, AT)),
    (START, While(LOOP, (STEP,), INSIDE, AT)),
)
CASES.add(
    "a round that may make no progress",
    "a round that makes no progress",
    (*between("n", 0, 9), START, While(LOOP, (need(AT, N), Assign("at", Binary("add", AT, N))), INSIDE, AT)),
    (*between("n", 1, 9), START, While(LOOP, (need(AT, N), Assign("at", Binary("add", AT, N))), INSIDE, AT)),
)
CASES.add(
    "a branch of a round without progress",
    "a round that makes no progress",
    (*BYTE, START, While(LOOP, (If(BRANCH, (STEP,)),), INSIDE, AT)),
    (*BYTE, START, While(LOOP, (If(BRANCH, (STEP,), (STEP,)),), INSIDE, AT)),
)
CASES.add("a round that goes back", "a round that makes no progress", (START, While(LOOP, (Assign("at", BEGIN),), INSIDE, AT)))
CASES.add(
    "an invariant that a round breaks",
    "an invariant that a round breaks",
    (START, While(LOOP, (Assign("at", add(AT, 2)),), INSIDE, AT)),
    (START, While(LOOP, (need(AT, 2), Assign("at", add(AT, 2))), INSIDE, AT)),
)
CASES.add(
    "an invariant that does not hold at first",
    "an invariant that does not hold at first",
    (START, While(LOOP, (STEP,), (compare("gt", AT, BEGIN),), AT)),
)
CASES.accept(
    "an invariant that does not hold at first",
    (
        START,
        While(LOOP, (STEP,), (compare("ge", AT, BEGIN),), AT),
    ),
)
CASES.add(
    "an invariant of which nothing is known",
    "an invariant that does not hold at first",
    (START, While(LOOP, (STEP,), (*INSIDE, Compare("lt", Const("f64", 0.0), Const("f64", 1.0))), AT)),
)
CASES.add(
    "a loop for ever",
    "a loop that nothing bounds",
    (
        Var("k", index(0)),
        While(
            compare("ge", i64("k"), 0),
            (expect(compare("lt", i64("k"), 1 << 62)), Assign("k", add(i64("k"), 1))),
            (compare("ge", i64("k"), 0),),
            i64("k"),
        ),
    ),
)
CASES.add(
    "a bound that is read anew",
    "a loop that nothing bounds",
    (
        need(BEGIN, 8),
        Var("k", index(0)),
        While(Compare("lt", i64("k"), Load("i64", BEGIN)), (Assign("k", add(i64("k"), 1)),), (compare("ge", i64("k"), 0),), i64("k")),
    ),
    (
        need(BEGIN, 8),
        Let("n", Load("i64", BEGIN)),
        Var("k", index(0)),
        While(Compare("lt", i64("k"), N), (Assign("k", add(i64("k"), 1)),), (compare("ge", i64("k"), 0),), i64("k")),
    ),
)
K = i64("k")


def rounds(most):
    """A loop that only a constant bounds."""
    inside = compare("ge", K, 0), compare("le", K, most)
    return Var("k", index(0)), While(compare("ne", K, most), (Assign("k", add(K, 1)),), inside, K)


CASES.add("a loop of too many rounds", "a loop that nothing bounds", rounds((1 << 20) + 2), rounds((1 << 20) + 1))
CASES.add(
    "what a loop leaves",
    "bytes beyond the end of the message",
    (START, While(LOOP, (STEP,), INSIDE, AT), Let("x", Load("u8", AT))),
    (START, While(LOOP, (Let("x", Load("u8", AT)), STEP), INSIDE, AT)),
)
CASES.add(
    "what a loop's condition leaves",
    "a row outside its lane",
    (
        Var("k", index(0)),
        *rows(4),
        While(compare("lt", K, 4), (Assign("k", add(K, 1)),), (compare("ge", K, 0), compare("le", K, 4)), K),
        put(K),
    ),
    (
        Var("k", index(0)),
        *rows(5),
        While(compare("lt", K, 4), (Assign("k", add(K, 1)),), (compare("ge", K, 0), compare("le", K, 4)), K),
        put(K),
    ),
)
CASES.add("a measure that is no number", "bool where i64 belongs", (START, While(LOOP, (STEP,), INSIDE, LOOP)))

FOUND = i64("found")
COUNTED = Assign("found", add(FOUND, Convert("i64", compare("gt", N, 3))))
CASES.add(
    "the row that is counted next",
    "a row outside its lane",
    (*between("n", 0, 9), Reserve(1, N), Let("c", Used(1)), Advance(1, N), Var("found", index(0)), For("i", N, (COUNTED, put(FOUND)))),
    (*between("n", 0, 9), Reserve(1, N), Let("c", Used(1)), Advance(1, N), Var("found", index(0)), For("i", N, (put(FOUND), COUNTED))),
)
SUMMED = Assign("found", add(FOUND, Select(compare("gt", N, 3), Convert("i64", Load("i32", BEGIN)), index(1))))
CASES.add(
    "a sum of any number of integers",
    "i64 arithmetic that may wrap",
    (*between("n", 0, 1 << 40), need(BEGIN, 8), Var("found", index(0)), For("i", N, (SUMMED,))),
    (*between("n", 0, 1 << 20), need(BEGIN, 8), Var("found", index(0)), For("i", N, (SUMMED,))),
)
