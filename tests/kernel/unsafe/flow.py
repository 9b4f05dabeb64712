"""Kernels that are unsafe on one of their paths."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import (
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
    Wire,
)
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from tests.kernel.kernels import compare, expect, i64, need
from tests.kernel.unsafe.cases import (
    AT,
    BRANCH,
    BYTE,
    DONE,
    FALSE,
    START,
    TRUE,
    TWO,
    WORD,
    Cases,
    M,
    N,
    X,
    between,
    both,
    plus,
    put,
    rows,
    sub,
)

CASES = Cases()

# --- paths -------------------------------------------------------------------------------------------------------------

CASES.add("no statement", "a path ends without Return", (None,))
CASES.add("no Return", "a path ends without Return", (Let("x", index(1)), None))
CASES.add("one branch returns", "a path ends without Return", (If(compare("gt", END, 0), (DONE,)), None))
CASES.accept("one branch returns", (If(compare("gt", END, 0), (DONE,), (DONE,)), None))
CASES.add("a loop that returns", "a path ends without Return", (For("i", index(3), (DONE,)), None))
CASES.accept("both branches fail", (If(compare("gt", END, 0), (expect(FALSE),), (expect(FALSE),)), None))
CASES.accept("a path that fails", (If(compare("gt", END, 0), (DONE,), (expect(FALSE),)), None))
CASES.accept("a branch that nothing takes", (If(compare("lt", END, 0), (SetField(Place(1, index(5)), index(1)),)),))
CASES.add("statements behind a Return", "statements after the end of their path", (DONE, Let("x", index(1))))
CASES.add(
    "a check in one branch",
    "bytes beyond the end of the message",
    (*BYTE, If(BRANCH, (need(BEGIN, 8),)), X),
    (*BYTE, If(BRANCH, (need(BEGIN, 8),), (need(BEGIN, 9),)), X),
)
IS_ROW = Local("bool", "is_row")
PERHAPS_ROW = *between("n", 0, 20), *rows(9), Var("is_row", compare("lt", N, 9)), If(BRANCH, (Assign("is_row", compare("lt", N, 10)),))
CASES.add(
    "a bool that a branch changes",
    "a row outside its lane",
    (*PERHAPS_ROW, If(IS_ROW, (put(N),))),
    (*PERHAPS_ROW, If(IS_ROW, (expect(compare("lt", N, 9)), put(N)))),
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
    "a position that one branch moves behind the end",
    "bytes beyond the end of the message",
    (Var("at", BEGIN), *BYTE, expect(compare("le", END, 1000)), If(BRANCH, (Assign("at", add(END, 8)),)), Fill(Wire(AT), index(0))),
    (Var("at", BEGIN), *BYTE, expect(compare("le", END, 1000)), If(BRANCH, (Assign("at", END),)), Fill(Wire(AT), index(0))),
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
FAR = 1 << 40
CASES.add(
    "a far number that one branch changes",
    "i64 arithmetic that may wrap",
    (Var("k", index(-FAR)), *BYTE, If(BRANCH, (Assign("k", index(-(1 << 63))),)), Let("x", sub(i64("k"), 1))),
    (Var("k", index(-FAR)), *BYTE, If(BRANCH, (Assign("k", index(FAR)),)), Let("x", sub(i64("k"), 1)), Let("y", plus(i64("k"), 1))),
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

LITTLE = *TWO, expect(both(compare("ge", M, -99), compare("le", M, 99))), *rows(100)
for what, asked, less, row in (
    ("at most", compare("le", M, 3), compare("le", M, 4), plus(M, 96)),
    ("at least", compare("ge", M, -3), compare("ge", M, -4), sub(index(96), M)),
):
    CASES.add(
        f"{what} so much, in one branch",
        "a row outside its lane",
        (*LITTLE, expect(compare("ge", row, 0)), If(compare("ge", N, 0), (expect(asked),), (expect(less),)), put(row)),
        (*LITTLE, expect(compare("ge", row, 0)), If(compare("ge", N, 0), (expect(asked),), (expect(asked),)), put(row)),
    )
