"""Kernels that are unsafe on one of their paths, or in one of their rounds."""

from __future__ import annotations

from rosetta_jit.kernel.ir import (
    Advance,
    Assign,
    Binary,
    Compare,
    Const,
    Fill,
    For,
    If,
    Let,
    Load,
    Local,
    Place,
    Reserve,
    SetField,
    Switch,
    Used,
    Var,
    While,
    Wire,
)
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from tests.kernel.kernels import compare, expect, i64, need
from tests.kernel.unsafe.cases import AT, BYTE, DONE, FALSE, START, TRUE, TWO, WORD, Cases, M, N, X, between, both, plus, put, rows, sub

CASES = Cases()

# --- paths -------------------------------------------------------------------------------------------------------------

CASES.add("no statement", "a path ends without Return", (None,))
CASES.add("no Return", "a path ends without Return", (Let("x", index(1)), None))
CASES.add("one branch returns", "a path ends without Return", (If(compare("gt", END, 0), (DONE,)), None))
CASES.accept("one branch returns", (If(compare("gt", END, 0), (DONE,), (DONE,)), None))
CASES.add("a loop that returns", "a path ends without Return", (For("i", index(3), (DONE,)), None))
CASES.accept("a path that fails", (If(compare("gt", END, 0), (DONE,), (expect(FALSE),)), None))
CASES.accept("a branch that nothing takes", (If(compare("lt", END, 0), (SetField(Place(1, index(5)), index(1)),)),))
CASES.add("statements behind a Return", "statements after the end of their path", (DONE, Let("x", index(1))))
BRANCH = compare("gt", N, 7)
CASES.add(
    "a check in one branch",
    "bytes beyond the end of the message",
    (*BYTE, If(BRANCH, (need(BEGIN, 8),)), X),
    (*BYTE, If(BRANCH, (need(BEGIN, 8),), (need(BEGIN, 9),)), X),
)
CASES.add(
    "a check in the other branch",
    "bytes beyond the end of the message",
    (*BYTE, If(BRANCH, (), (need(BEGIN, 8),)), X),
    (*BYTE, If(BRANCH, (expect(FALSE),), (need(BEGIN, 8),)), X),
)
CASES.add(
    "weaker checks in branches",
    "bytes beyond the end of the message",
    (*BYTE, If(BRANCH, (need(BEGIN, 7),), (need(BEGIN, 8),)), X),
    (*BYTE, If(BRANCH, (need(BEGIN, 8),), (need(BEGIN, 8),)), X),
)
CASES.add(
    "weaker checks in branches, the other way round",
    "bytes beyond the end of the message",
    (*BYTE, If(BRANCH, (need(BEGIN, 8),), (need(BEGIN, 7),)), X),
)
CASES.add(
    "a check on a path that returns",
    "bytes beyond the end of the message",
    (*BYTE, If(BRANCH, (need(BEGIN, 8), DONE)), X),
    (*BYTE, If(BRANCH, (DONE,), (need(BEGIN, 8),)), X),
)
CASES.add(
    "a check in some cases",
    "bytes beyond the end of the message",
    (*BYTE, Switch(N, ((1, (need(BEGIN, 8),)), (2, (need(BEGIN, 8),))), ()), X),
    (*BYTE, Switch(N, ((1, (need(BEGIN, 8),)), (2, (need(BEGIN, 8),))), (need(BEGIN, 8),)), X),
)
CASES.add(
    "a check in all cases but one",
    "bytes beyond the end of the message",
    (*BYTE, Switch(N, ((1, (need(BEGIN, 8),)), (2, ())), (need(BEGIN, 8),)), X),
)
CASES.add(
    "the number of a case",
    "a row outside its lane",
    (*WORD, *rows(4), Switch(N, ((3, (put(N),)), (4, (put(N),))), ())),
    (*WORD, *rows(5), Switch(N, ((3, (put(N),)), (4, (put(N),))), ())),
)
CASES.add(
    "the number of no case",
    "a row outside its lane",
    (*between("n", 0, 4), *rows(4), Switch(N, ((3, ()),), (put(N),))),
    (*between("n", 0, 4), *rows(4), Switch(N, ((4, ()),), (put(N),))),
)
CASES.add(
    "the other branch",
    "a row outside its lane",
    (*between("n", 0, 9), *rows(4), If(compare("lt", N, 4), (), (put(N),))),
    (*between("n", 0, 9), *rows(4), If(compare("ge", N, 4), (), (put(N),))),
)
CASES.add(
    "a position that one branch moves",
    "bytes beyond the end of the message",
    (Var("at", BEGIN), *BYTE, If(BRANCH, (expect(compare("le", BEGIN, 1000)), Assign("at", add(BEGIN, 100)))), Fill(Wire(AT), index(0))),
    (Var("at", BEGIN), *BYTE, If(BRANCH, (need(BEGIN, 100), Assign("at", add(BEGIN, 100)))), Fill(Wire(AT), index(0))),
)
CASES.add(
    "a position that both branches move",
    "bytes beyond the end of the message",
    (
        Var("at", BEGIN),
        need(BEGIN, 1),
        If(
            Compare("gt", Load("u8", BEGIN), Const("u8", 7)),
            (expect(compare("le", BEGIN, 1000)), Assign("at", plus(BEGIN, 100))),
            (Assign("at", plus(BEGIN, 0)),),
        ),
        Fill(Wire(AT), index(0)),
    ),
)
CASES.add(
    "a position that one branch moves back",
    "bytes before the begin of the message",
    (Var("at", add(BEGIN, 8)), *BYTE, need(BEGIN, 99), If(BRANCH, (Assign("at", sub(AT, 9)),)), need(AT, 1), Let("x", Load("u8", AT))),
    (Var("at", add(BEGIN, 8)), *BYTE, need(BEGIN, 99), If(BRANCH, (Assign("at", sub(AT, 8)),)), need(AT, 1), Let("x", Load("u8", AT))),
)
CASES.add(
    "a number that one branch changes",
    "a row outside its lane",
    (Var("k", index(3)), *BYTE, *rows(4), If(BRANCH, (Assign("k", index(4)),)), put(i64("k"))),
    (Var("k", index(3)), *BYTE, *rows(4), If(BRANCH, (Assign("k", index(2)),)), put(i64("k"))),
)
CASES.add(
    "a number that one branch lowers",
    "a row that may be negative",
    (Var("k", index(0)), *BYTE, *rows(4), If(BRANCH, (Assign("k", index(-1)),)), put(i64("k"))),
    (Var("k", index(0)), *BYTE, *rows(4), If(BRANCH, (Assign("k", index(1)),)), put(i64("k"))),
)
CASES.add(
    "a number that both branches change",
    "a row outside its lane",
    (Var("k", index(0)), *BYTE, *rows(4), If(BRANCH, (Assign("k", index(3)),), (Assign("k", index(4)),)), put(i64("k"))),
    (Var("k", index(0)), *BYTE, *rows(4), If(BRANCH, (Assign("k", index(3)),), (Assign("k", index(2)),)), put(i64("k"))),
)
CASES.add(
    "a number that a case changes",
    "a row outside its lane",
    (Var("k", index(0)), *BYTE, *rows(4), Switch(N, ((1, ()), (2, (Assign("k", index(4)),))), ()), put(i64("k"))),
    (Var("k", index(0)), *BYTE, *rows(4), Switch(N, ((1, ()), (2, (Assign("k", index(3)),))), ()), put(i64("k"))),
)
OK, SMALL = Local("bool", "ok"), both(compare("ge", N, 0), compare("le", N, 99))
CASES.add(
    "a bool that one branch changes",
    "a row outside its lane",
    (*TWO, expect(SMALL), Var("ok", compare("lt", N, 4)), If(compare("gt", M, 0), (Assign("ok", TRUE),)), *rows(4), If(OK, (put(N),))),
    (*TWO, expect(SMALL), Var("ok", compare("lt", N, 4)), If(compare("gt", M, 0), ()), *rows(4), If(OK, (put(N),))),
)
CASES.add(
    "a bool that a loop changes",
    "a row outside its lane",
    (*between("n", 0, 9), Var("ok", compare("lt", N, 4)), For("i", index(2), (Assign("ok", TRUE),)), *rows(4), If(OK, (put(N),))),
    (*between("n", 0, 9), Var("ok", compare("lt", N, 4)), For("i", index(2), ()), *rows(4), If(OK, (put(N),))),
)
CASES.add(
    "rows that one branch uses",
    "a row that may be negative",
    (*BYTE, If(BRANCH, rows(1)), SetField(Place(1, sub(Used(1), 1)), index(1))),
    (*BYTE, If(BRANCH, rows(1), rows(1, "d")), SetField(Place(1, sub(Used(1), 1)), index(1))),
)
CASES.add(
    "rows that a branch has used up",
    "rows that were not reserved",
    (*BYTE, Reserve(1, index(1)), If(BRANCH, (Advance(1, index(1)),)), Advance(1, index(1))),
    (*BYTE, Reserve(1, index(1)), If(BRANCH, (Let("d", Used(1)),)), Advance(1, index(1))),
)
FAR_BACK = -(1 << 63)
CASES.add(
    "a position that moved as far back as numbers go",
    "a division that may be by zero",
    (
        *BYTE,
        expect(both(compare("eq", BEGIN, 5), compare("eq", N, 5))),
        START,
        Let("far", plus(BEGIN, FAR_BACK)),
        If(compare("gt", END, 99), (Assign("at", i64("far")),), (Assign("at", sub(i64("far"), N)),)),
        If(compare("eq", AT, FAR_BACK), (Let("x", Binary("div", index(1), index(0))),)),
    ),
)

# --- loops -------------------------------------------------------------------------------------------------------------

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
