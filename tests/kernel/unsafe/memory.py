"""Kernels that read or write beyond the message or a lane."""

from __future__ import annotations

from rosetta_jit.kernel.ir import Routine
from rosetta_jit.kernel.nodes import (
    Advance,
    Call,
    Capacity,
    Const,
    Convert,
    Copy,
    Extent,
    Fill,
    Get,
    HostCall,
    HostValue,
    If,
    IsText,
    Let,
    Load,
    Nearest,
    Place,
    Require,
    Reserve,
    Return,
    SetField,
    Store,
    Used,
    Wire,
)
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index
from tests.kernel.kernels import ROW_EXISTS, SITES, compare, expect, fail, i64, need
from tests.kernel.unsafe.cases import BYTE, C, Cases, N, X, between, both, plus, put, rows, sub

CASES = Cases()

# --- the message -------------------------------------------------------------------------------------------------------

CASES.add("load beyond the end", "bytes beyond the end of the message", (need(BEGIN, 7), X), (need(BEGIN, 8), X))
CASES.add("load without a check", "bytes beyond the end of the message", (X,))
CASES.add("load of an empty message", "bytes beyond the end of the message", (need(BEGIN, 0), Let("x", Load("u8", BEGIN))))
CASES.add(
    "load before the begin",
    "bytes before the begin of the message",
    (expect(compare("ge", BEGIN, 1)), need(sub(BEGIN, 1), 9), Let("x", Load("i64", sub(BEGIN, 1)))),
    (expect(compare("ge", BEGIN, 1)), need(sub(BEGIN, 1), 9), Let("x", Load("i64", BEGIN))),
)
CASES.add(
    "load far before the begin",
    "bytes before the begin of the message",
    (expect(compare("ge", BEGIN, 8)), Require(sub(BEGIN, 8), index(4), fail(1)), Let("x", Load("u32", sub(BEGIN, 8)))),
)
CASES.add(
    "store beyond the end",
    "bytes beyond the end of the message",
    (need(BEGIN, 3), Store(BEGIN, Const("i32", 1))),
    (need(BEGIN, 4), Store(BEGIN, Const("i32", 1))),
    direction="encode",
)
CASES.add("store without a check", "bytes beyond the end of the message", (Store(END, Const("u8", 1)),), direction="encode")
CASES.add(
    "fill before the begin",
    "bytes before the begin of the message",
    (expect(compare("ge", BEGIN, 1)), need(sub(BEGIN, 1), 4), Fill(Wire(sub(BEGIN, 1)), index(4))),
    (expect(compare("ge", BEGIN, 1)), need(sub(BEGIN, 1), 5), Fill(Wire(BEGIN), index(4))),
    direction="encode",
)
CASES.add(
    "fill of a size that may be negative",
    "a size that may be negative",
    (*BYTE, need(BEGIN, 254), Fill(Wire(BEGIN), sub(N, 1))),
    (*BYTE, need(BEGIN, 254), expect(compare("ge", N, 1)), Fill(Wire(BEGIN), sub(N, 1))),
)
CASES.add(
    "text beyond the end",
    "bytes beyond the end of the message",
    (need(BEGIN, 5), expect(IsText(Wire(BEGIN), index(6)))),
    (need(BEGIN, 6), expect(IsText(Wire(BEGIN), index(6)))),
)
CASES.add(
    "digits beyond the end",
    "bytes beyond the end of the message",
    (need(BEGIN, 5), Let("x", Nearest(Wire(BEGIN), index(6), index(0)))),
    (need(BEGIN, 6), Let("x", Nearest(Wire(BEGIN), index(6), index(0)))),
)
CASES.add(
    "copy beyond the end",
    "bytes beyond the end of the message",
    (ROW_EXISTS, need(BEGIN, 7), Copy(Place(0, ROW), Wire(BEGIN), index(8))),
    (ROW_EXISTS, need(BEGIN, 8), Copy(Place(0, ROW), Wire(BEGIN), index(8))),
)
CASES.add(
    "copy within the message",
    "a copy within the message",
    (need(BEGIN, 16), Copy(Wire(BEGIN), Wire(add(BEGIN, 8)), index(8))),
    (ROW_EXISTS, need(BEGIN, 16), Copy(Place(0, ROW), Wire(add(BEGIN, 8)), index(8))),
)
CASES.add(
    "a check of one read, an access of another",
    "bytes beyond the end of the message",
    (need(BEGIN, 1), need(BEGIN, Convert("i64", Load("u8", BEGIN))), Fill(Wire(BEGIN), Convert("i64", Load("u8", BEGIN)))),
    (*BYTE, need(BEGIN, N), Fill(Wire(BEGIN), N)),
)
CASES.add("load at what a failing check reports", "bytes beyond the end of the message", (need(BEGIN, 4, 1, Load("i64", BEGIN)),))
CASES.add(
    "a failure's offset that is no number",
    "f64 where i64 belongs",
    (Require(BEGIN, index(4), fail(1, Const("f64", 1.0))),),
    (Require(BEGIN, index(4), fail(1, index(1))),),
)
CASES.add("a position that may be negative", "a position that may be negative", (Return(sub(BEGIN, 1)), None), (Return(BEGIN), None))
CASES.add(
    "a position of the message that may be negative",
    "a position that may be negative",
    (*between("n", -1, 5), Return(N), None),
    (*between("n", 0, 5), Return(N), None),
)
CASES.add(
    "an index of a call that is no number",
    "f64 where i64 belongs",
    (Call("pass", (), (), (), (Const("f64", 1.0),)),),
    (Call("pass", (), (), (), (index(1),)),),
    (Routine("pass", (), (), (), (), (), SITES[:1]),),
)

# --- lanes -------------------------------------------------------------------------------------------------------------

HERE = Place(0, ROW)
CASES.add(
    "row at the capacity",
    "a row outside its lane",
    (expect(compare("le", ROW, Capacity(0))), SetField(HERE, index(1))),
    (expect(compare("lt", ROW, Capacity(0))), SetField(HERE, index(1))),
)
CASES.add(
    "the row behind the last",
    "a row outside its lane",
    (Let("c", Capacity(1)), SetField(Place(1, C), index(1))),
    (Let("c", Capacity(1)), expect(compare("ge", C, 1)), SetField(Place(1, sub(C, 1)), index(1))),
)
CASES.add("the first row without a check", "a row outside its lane", (SetField(Place(1, index(0)), index(1)),))
CASES.add("get behind the last", "a row outside its lane", (Let("x", Get("i64", HERE)),), (ROW_EXISTS, Let("x", Get("i64", HERE))))
CASES.add("the capacity of another lane", "a row outside its lane", (ROW_EXISTS, SetField(Place(1, ROW), index(1))))
CASES.add(
    "a row that may be negative",
    "a row that may be negative",
    (*rows(9), *between("n", -1, 5), SetField(Place(1, N), index(1))),
    (*rows(9), *between("n", 0, 5), SetField(Place(1, N), index(1))),
)
CASES.add(
    "a field behind its row",
    "a field outside its row",
    (ROW_EXISTS, SetField(Place(0, ROW, 64), index(1))),
    (ROW_EXISTS, SetField(Place(0, ROW, 56), index(1))),
)
CASES.add(
    "a field that reaches beyond its row",
    "a field outside its row",
    (ROW_EXISTS, SetField(Place(0, ROW, 60), index(1))),
    (ROW_EXISTS, SetField(Place(0, ROW, 60), Const("i32", 1))),
)
CASES.add(
    "a field that is not aligned",
    "a field that is not aligned",
    (ROW_EXISTS, SetField(Place(0, ROW, 4), index(1))),
    (ROW_EXISTS, SetField(Place(0, ROW, 4), Const("f32", 1.0))),
)
CASES.add("rows that are not aligned", "a field that is not aligned", (ROW_EXISTS, SetField(HERE, index(1))), strides=(12,))
CASES.accept(
    "rows that are not aligned",
    (
        ROW_EXISTS,
        SetField(HERE, Const("i32", 1)),
    ),
    strides=(12,),
)
CASES.add(
    "a field before its row",
    "a negative offset",
    (ROW_EXISTS, SetField(Place(0, ROW, -8), index(1))),
    (ROW_EXISTS, SetField(Place(0, ROW, 0), index(1))),
)
CASES.add("bytes before their row", "a negative offset", (ROW_EXISTS, Fill(Place(0, ROW, -1), index(1))))
CASES.add("a lane that is not there", "no such lane", (SetField(Place(2, ROW), index(1)),))
CASES.add("a lane before the first", "no such lane", (SetField(Place(-1, ROW), index(1)),))
for what, expr in {"used length": Used, "capacity": Capacity}.items():
    CASES.add(f"the {what} of no lane", "no such lane", (Let("x", expr(2)),), (Let("x", expr(1)),))
CASES.add("rows of no lane", "no such lane", (Reserve(2, index(1)),), (Reserve(1, index(1)),))
CASES.add(
    "fill beyond the row and the lane",
    "bytes outside the lane",
    (ROW_EXISTS, Fill(HERE, index(65))),
    (ROW_EXISTS, Fill(HERE, index(64))),
)
CASES.add(
    "fill from an offset",
    "bytes outside the lane",
    (ROW_EXISTS, Fill(Place(0, ROW, 8), index(57))),
    (ROW_EXISTS, Fill(Place(0, ROW, 8), index(56))),
)
CASES.add(
    "fill of more rows than there are",
    "bytes outside the lane",
    (*rows(4), Fill(Place(1, C), index(33))),
    (*rows(4), Fill(Place(1, C), index(32))),
)
CASES.add("fill of a byte that is none", "256 is no byte", (ROW_EXISTS, Fill(HERE, index(1), 256)), (ROW_EXISTS, Fill(HERE, index(1), 255)))
CASES.add("fill of a byte below zero", "-1 is no byte", (ROW_EXISTS, Fill(HERE, index(1), -1)), (ROW_EXISTS, Fill(HERE, index(1), 0)))
CASES.add(
    "copy onto itself, to the left",
    "a copy onto itself",
    (ROW_EXISTS, Copy(HERE, Place(0, ROW, 7), index(8))),
    (ROW_EXISTS, Copy(HERE, Place(0, ROW, 8), index(8))),
)
CASES.add(
    "copy onto itself, to the right",
    "a copy onto itself",
    (ROW_EXISTS, Copy(Place(0, ROW, 7), HERE, index(8))),
    (ROW_EXISTS, Copy(Place(0, ROW, 8), HERE, index(8))),
)
CASES.add(
    "copy out of too few rows",
    "bytes outside the lane",
    (*rows(2), ROW_EXISTS, Copy(HERE, Place(1, C), index(17))),
    (*rows(2), ROW_EXISTS, Copy(HERE, Place(1, C), index(16))),
)
CASES.add("rows that nobody reserved", "rows that were not reserved", (Advance(1, index(1)),), (Reserve(1, index(1)), Advance(1, index(1))))
CASES.add("more rows than reserved", "rows that were not reserved", (Reserve(1, index(3)), Advance(1, index(4))), rows(4))
CASES.add("rows reserved in another lane", "rows that were not reserved", (Reserve(0, index(4)), Advance(1, index(4))), rows(4))
CASES.add(
    "rows that are used already",
    "rows that were not reserved",
    (*rows(4), Advance(1, index(1))),
    (*rows(4), Reserve(1, index(1)), Advance(1, index(1))),
)
CASES.add(
    "rows reserved in one branch",
    "rows that were not reserved",
    (*BYTE, If(compare("gt", N, 7), (Reserve(1, index(4)),)), Advance(1, index(4))),
    (*BYTE, If(compare("gt", N, 7), (Reserve(1, index(4)),), (Reserve(1, index(5)),)), Advance(1, index(4))),
)
CASES.add("a count of rows that may be negative", "a count of rows that may be negative", (*between("n", -1, 5), Reserve(1, N)))
CASES.accept(
    "a count of rows that may be negative",
    (
        *between("n", 0, 5),
        Reserve(1, N),
        Advance(1, N),
    ),
)
CASES.add("an advance that may go back", "a count of rows that may be negative", (*rows(4), *between("n", -1, 0), Advance(1, N)))
CASES.add(
    "the rows that are left",
    "a row outside its lane",
    (Reserve(1, index(1)), SetField(Place(1, plus(Used(1), 1)), index(1))),
    (Reserve(1, index(1)), SetField(Place(1, Used(1)), index(1))),
)
CASES.add(
    "what was used is behind what is",
    "a row outside its lane",
    (*rows(1), SetField(Place(1, Used(1)), index(1))),
    (*rows(1), SetField(Place(1, sub(Used(1), 1)), index(1))),
)

SEVERAL = need(BEGIN, 4), *(Let(f"k_{k}", Convert("i64", Load("u8", add(BEGIN, k)))) for k in range(4))
TAKEN = tuple(stmt for k in range(4) for stmt in (Reserve(1, i64(f"k_{k}")), Advance(1, i64(f"k_{k}"))))
CASES.add(
    "rows behind those of several counts",
    "a row outside its lane",
    (*SEVERAL, *TAKEN, expect(compare("ge", Used(1), 1)), SetField(Place(1, Used(1)), index(1))),
    (*SEVERAL, *TAKEN, expect(compare("ge", Used(1), 1)), SetField(Place(1, sub(Used(1), 1)), index(1))),
)
CASES.add(
    "rows of several counts that may be none",
    "a row that may be negative",
    (*SEVERAL, *TAKEN, SetField(Place(1, sub(Used(1), 1)), index(1))),
    (*SEVERAL, *TAKEN, Reserve(1, index(1)), Let("c", Used(1)), Advance(1, index(1)), SetField(Place(1, sub(Used(1), 1)), index(1))),
)
CASES.add(
    "rows of several counts that nobody reserved",
    "rows that were not reserved",
    (*SEVERAL, *TAKEN, Advance(1, index(1))),
    (*SEVERAL, *TAKEN, Reserve(1, index(1)), Advance(1, index(1))),
)
CASES.accept("a copy between two lanes", (*rows(1), ROW_EXISTS, Copy(HERE, Place(1, i64("c")), index(8))))

# --- functions of the host ---------------------------------------------------------------------------------------------


def filled(offset, target=8, size=8):
    """A function that reads 8 bytes of row 0 and fills some of it."""
    return HostCall("f", (), i64("x"), fail(1), (Extent(HERE, index(8)),), Extent(Place(0, ROW, offset), index(target)))


CASES.add("a function that fills what it reads", "a function that fills what it reads", (ROW_EXISTS, filled(7)), (ROW_EXISTS, filled(8)))
CASES.add(
    "a function that reads what it fills",
    "a function that fills what it reads",
    (ROW_EXISTS, HostCall("f", (), i64("x"), fail(1), (Extent(Place(0, ROW, 7), index(8)),), Extent(HERE, index(8)))),
    (ROW_EXISTS, HostCall("f", (), i64("x"), fail(1), (Extent(Place(0, ROW, 8), index(8)),), Extent(HERE, index(8)))),
)
CASES.add(
    "a function that fills what it reads of the message",
    "a function that fills what it reads",
    (need(BEGIN, 16), HostCall("f", (), i64("x"), fail(1), (Extent(Wire(BEGIN), index(9)),), Extent(Wire(add(BEGIN, 8)), index(8)))),
    (need(BEGIN, 16), HostCall("f", (), i64("x"), fail(1), (Extent(Wire(BEGIN), index(8)),), Extent(Wire(add(BEGIN, 8)), index(8)))),
    direction="encode",
)
CASES.add(
    "a function that fills too much", "bytes outside the lane", (ROW_EXISTS, filled(8, target=57)), (ROW_EXISTS, filled(8, target=56))
)
CASES.add(
    "a function that reads too much",
    "bytes beyond the end of the message",
    (need(BEGIN, 7), HostCall("f", (), i64("x"), fail(1), (Extent(Wire(BEGIN), index(8)),))),
    (need(BEGIN, 8), HostCall("f", (), i64("x"), fail(1), (Extent(Wire(BEGIN), index(8)),))),
)
CASES.add(
    "what a function gives",
    "a row outside its lane",
    (*rows(4), HostCall("f", (), N, fail(1)), expect(both(compare("ge", N, 0), compare("le", N, 4))), put(N)),
    (*rows(4), HostCall("f", (), N, fail(1)), expect(both(compare("ge", N, 0), compare("lt", N, 4))), put(N)),
)
CASES.add("an argument of a function", "bytes beyond the end of the message", (HostCall("f", (Load("u8", BEGIN),), i64("x"), fail(1)),))
CASES.add("where a function fails", "bytes beyond the end of the message", (HostCall("f", (), i64("x"), fail(1, Load("i64", BEGIN))),))
CASES.add(
    "what the host tells",
    "a row that may be negative",
    (SetField(Place(1, HostValue("number")), index(1)),),
    (Let("x", HostValue("number")),),
)
CASES.accept(
    "a function that fills another lane",
    (*rows(1), ROW_EXISTS, HostCall("f", (), i64("x"), fail(1), (Extent(Place(1, i64("c")), index(8)),), Extent(HERE, index(8)))),
)
CASES.accept(
    "a function that fills a lane with the message",
    (need(BEGIN, 8), ROW_EXISTS, HostCall("f", (), i64("x"), fail(1), (Extent(Wire(BEGIN), index(8)),), Extent(HERE, index(8)))),
)
