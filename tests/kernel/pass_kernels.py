"""Kernels for the passes: one for each thing that a pass does, or must not do."""

from __future__ import annotations

from dataclasses import replace

from rosetta_jit.kernel.ir import Routine
from rosetta_jit.kernel.nodes import (
    Advance,
    Assign,
    Binary,
    Call,
    Compare,
    Const,
    Convert,
    Copy,
    Extent,
    Fill,
    Fits,
    For,
    Get,
    HostCall,
    If,
    IsText,
    Let,
    Load,
    Nearest,
    Place,
    Require,
    Reserve,
    Return,
    Select,
    SetField,
    Store,
    Used,
    Var,
    Wire,
)
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index, mul
from tests.kernel import kernels
from tests.kernel.kernels import ROW_EXISTS, SITES, compare, expect, fail, i64, kernel, need


def each_round(*body, strides=(64, 8), count=8):
    """A loop over so many rows of lane 1, and one of lane 2 where there is one."""
    rows = [stmt for lane in range(1, len(strides)) for stmt in _rows(lane, count)]
    return kernel((ROW_EXISTS, *rows, For("i", index(count), body), Return(BEGIN)), strides=strides)


def _rows(lane, count):
    return Reserve(lane, index(count)), Let(f"start_{lane}", Used(lane)), Advance(lane, index(count))


def _bit(number, offset, type_="u64"):
    place = Place(0, ROW, offset)
    return SetField(place, Binary("or", Get(type_, place), Const(type_, 1 << number)))


I8 = mul(i64("i"), 8)
THERE = Binary("add", BEGIN, I8)
WIDE = Binary("add", BEGIN, mul(i64("i"), 16))
ELEMENT = Binary("add", i64("start_1"), i64("i"))


def two_fields(type_, first, second):
    """Rows of two fields that lie end to end, from two places of the message."""
    fields = (SetField(Place(1, ELEMENT), Load(type_, first)), SetField(Place(1, ELEMENT, 8), Load(type_, second)))
    return each_round(need(WIDE, 16, 4, i64("i")), *fields, strides=(64, 16))


COUNTED = (
    ROW_EXISTS,
    need(BEGIN, 1),
    Let("n", Convert("i64", Load("u8", BEGIN))),
    Reserve(1, i64("n")),
    Let("start_1", Used(1)),
    Advance(1, i64("n")),
)


def _written(name):
    return ROW_EXISTS, SetField(Place(0, ROW), i64(name)), SetField(Place(0, ROW, 8), i64(name))


def straight(*body):
    """Statements about row 0 and 24 bytes of the message, without a loop."""
    return kernel((ROW_EXISTS, need(BEGIN, 24), *body, Return(BEGIN)), strides=(24,))


def moved(offset, at, order="<"):
    return SetField(Place(0, ROW, offset), Load("i64", add(BEGIN, at), order))


PASSED = {
    "a check that no round changes, reported of the first": each_round(
        Require(BEGIN, index(64), fail(4, THERE, i64("i"))), SetField(Place(1, ELEMENT), Load("i64", THERE))
    ),
    "a check whose last index is none of the loop": each_round(
        need(THERE, 8, 4, i64("i"), index(3)), SetField(Place(1, ELEMENT), Load("i64", THERE))
    ),
    "reads of which each begins within the one before": each_round(
        need(THERE, 16, 4, i64("i")), SetField(Place(1, ELEMENT), Load("i64", add(THERE, 8)))
    ),
    "two lanes that are no one place": each_round(
        need(WIDE, 16, 4, i64("i")),
        SetField(Place(1, i64("i")), Load("i64", WIDE)),
        SetField(Place(2, i64("i"), 8), Load("i64", add(WIDE, 8))),
        strides=(64, 16, 16),
    ),
    "rows emptied, and set one by one": kernel(
        (
            ROW_EXISTS,
            need(BEGIN, 1),
            Let("n", Convert("i64", Load("u8", BEGIN))),
            Reserve(1, i64("n")),
            Let("start_1", Used(1)),
            Advance(1, i64("n")),
            Fill(Place(1, i64("start_1")), mul(i64("n"), 8)),
            For("i", i64("n"), (need(THERE, 8, 4, i64("i")), SetField(Place(1, ELEMENT), Load("i64", THERE, ">")))),
            Return(BEGIN),
        )
    ),
    "choices that are made, and comparisons with what is known": kernel(
        (
            ROW_EXISTS,
            need(BEGIN, 16),
            Let("low", Load("i64", BEGIN)),
            Let("high", Load("i64", add(BEGIN, 8))),
            expect(Compare("eq", compare("lt", i64("low"), i64("high")), Const("bool", value=False)), 2),
            expect(Compare("eq", compare("lt", i64("low"), 7), Const("bool", value=True)), 2),
            SetField(Place(0, ROW), Select(Const("bool", value=True), i64("low"), i64("high"))),
            Return(BEGIN),
        ),
        strides=(8,),
    ),
    "comparisons of what grows": each_round(
        expect(compare("lt", THERE, 1 << 40), 4, THERE, i64("i")),
        expect(Compare("ge", index(1 << 20), I8), 4, BEGIN, i64("i")),
        expect(Fits("add", BEGIN, I8), 4, BEGIN, i64("i")),
        expect(Compare("gt", END, BEGIN), 3),
        need(THERE, 8, 4, i64("i")),
        SetField(Place(1, ELEMENT), Load("i64", THERE, ">")),
    ),
    "what is read twice": kernel(
        (
            ROW_EXISTS,
            need(BEGIN, 16),
            SetField(Place(0, ROW), Load("i64", BEGIN)),
            SetField(Place(0, ROW, 8), Load("i64", BEGIN)),
            SetField(Place(0, ROW, 16), Binary("xor", Get("i64", Place(0, ROW)), Load("i64", add(BEGIN, 8)))),
            SetField(Place(0, ROW), Get("i64", Place(0, ROW, 16))),
            SetField(Place(0, ROW, 24), Get("i64", Place(0, ROW))),
            Return(BEGIN),
        )
    ),
    "fields that lie end to end on both sides": two_fields("i64", WIDE, add(WIDE, 8)),
    "fields that lie the other way round": two_fields("i64", add(WIDE, 8), WIDE),
    "fields with a gap between them": two_fields("i32", WIDE, add(WIDE, 8)),
    "what a branch has found out": kernel(
        (
            ROW_EXISTS,
            need(BEGIN, 2),
            Let("n", Convert("i64", Load("u8", BEGIN))),
            Let("m", Convert("i64", Load("u8", add(BEGIN, 1)))),
            If(compare("gt", i64("m"), 7), (expect(compare("eq", i64("n"), 3)), SetField(Place(0, ROW), i64("n")))),
            SetField(Place(0, ROW, 8), i64("n")),
            Return(BEGIN),
        )
    ),
    "lines with padding": kernel(
        (
            ROW_EXISTS,
            need(BEGIN, 12),
            *(Let(name, Convert("i64", Load("i32", add(BEGIN, at)))) for name, at in (("w", 0), ("h", 4), ("pad", 8))),
            *(expect(Binary("and", compare("ge", i64(name), 0), compare("le", i64(name), 999)), 3) for name in ("w", "h", "pad")),
            Let("step", Binary("add", i64("w"), i64("pad"))),
            need(add(BEGIN, 12), mul(i64("h"), i64("step"))),
            Reserve(1, mul(i64("h"), i64("w"))),
            Let("start", Used(1)),
            Advance(1, mul(i64("h"), i64("w"))),
            For(
                "y",
                i64("h"),
                (
                    Let("line", Binary("add", add(BEGIN, 12), mul(i64("y"), i64("step")))),
                    expect(Compare("lt", i64("line"), index(1 << 50)), 3),
                    Copy(Place(1, Binary("add", i64("start"), mul(i64("y"), i64("w")))), Wire(i64("line")), i64("w")),
                ),
            ),
            Return(BEGIN),
        ),
        strides=(8, 1),
    ),
    "fewer rows emptied than set": kernel(
        (
            *COUNTED,
            Fill(Place(1, i64("start_1")), mul(i64("n"), 4)),
            For("i", i64("n"), (need(THERE, 8, 4, i64("i")), SetField(Place(1, ELEMENT), Load("i64", THERE, ">")))),
            Return(BEGIN),
        )
    ),
    "checks before a loop of which the count is read": kernel(
        (
            *COUNTED,
            need(BEGIN, 24),
            Let("b", Load("i64", BEGIN)),
            Let("m", Load("i64", add(BEGIN, 8))),
            For(
                "i",
                i64("n"),
                (
                    expect(Fits("add", i64("b"), I8), 4, BEGIN, i64("i")),
                    expect(Binary("and", Compare("lt", i64("i"), i64("m")), Compare("le", I8, i64("b"))), 4, BEGIN, i64("i")),
                    SetField(Place(1, ELEMENT), Binary("add", i64("b"), I8)),
                ),
            ),
            Return(BEGIN),
        )
    ),
    "fewer rows emptied than numbered": kernel(
        (
            *COUNTED,
            Fill(Place(1, i64("start_1")), mul(i64("n"), 4)),
            For("i", i64("n"), (SetField(Place(1, ELEMENT), i64("i")),)),
            Return(BEGIN),
        )
    ),
    "checks from a place that changes between them": kernel(
        (
            ROW_EXISTS,
            need(BEGIN, 1),
            Let("n", Convert("i64", Load("u8", BEGIN))),
            need(add(BEGIN, 1), i64("n")),
            Var("p", Binary("add", add(BEGIN, 1), i64("n"))),
            need(i64("p"), 8),
            SetField(Place(0, ROW), Load("i64", i64("p"))),
            Assign("p", add(i64("p"), 8)),
            need(i64("p"), 16),
            SetField(Place(0, ROW, 8), Load("i64", add(i64("p"), 8))),
            Return(BEGIN),
        )
    ),
    "a check behind a branch that returns": kernel(
        (need(BEGIN, 1), If(compare("gt", END, 99), (Return(BEGIN),)), need(add(BEGIN, 1), 8), Return(BEGIN))
    ),
    "what a loop writes and reads": kernel(
        (
            ROW_EXISTS,
            Let("old", Get("i64", Place(0, ROW))),
            For("i", index(99), (SetField(Place(0, ROW, 8), Get("i64", Place(0, ROW))), SetField(Place(0, ROW), i64("i")))),
            SetField(Place(0, ROW, 16), i64("old")),
            Return(BEGIN),
        )
    ),
    "a copy of what a routine gives": replace(
        kernel((Call("same", (BEGIN,), (i64("after"),), ()), Let("copy", i64("after")), *_written("copy"), Return(BEGIN))),
        routines=(Routine("same", (i64("at"),), (i64("next"),), (Let("next", i64("at")),), (), (), SITES[:1]),),
    ),
    "rows emptied from a place that the loop changes": kernel(
        (
            *COUNTED,
            Var("s", i64("start_1")),
            Fill(Place(1, i64("s")), mul(i64("n"), 8)),
            For(
                "i",
                i64("n"),
                (
                    expect(Compare("le", i64("s"), i64("start_1")), 3),
                    SetField(Place(1, Binary("add", i64("s"), i64("i"))), i64("i")),
                    Assign("s", i64("start_1")),
                ),
            ),
            Return(BEGIN),
        )
    ),
    "rows of a constant, of numbers, and of bytes": kernel(
        (
            *COUNTED,
            need(BEGIN, mul(i64("n"), 8)),
            For("j", i64("n"), (SetField(Place(1, Binary("add", i64("start_1"), i64("j"))), index(0)),)),
            For("i", i64("n"), (SetField(Place(1, ELEMENT), Load("i64", THERE)),)),
            Reserve(2, i64("n")),
            Let("start_2", Used(2)),
            Advance(2, i64("n")),
            For("k", i64("n"), (SetField(Place(2, Binary("add", i64("start_2"), i64("k"))), Load("u8", Binary("add", BEGIN, i64("k")))),)),
            Return(BEGIN),
        ),
        strides=(64, 8, 1),
    ),
    "a variable that grows by way of two names": kernel(
        (
            *COUNTED[:3],
            Var("k", i64("n")),
            For(
                "i",
                i64("n"),
                (
                    expect(compare("lt", i64("k"), 999), 3),
                    expect(Compare("ge", i64("k"), i64("n")), 3),
                    Let("once", add(i64("k"), 1)),
                    Let("twice", Binary("max", i64("once"), index(5))),
                    *(SetField(Place(0, ROW, 8 * at), i64(name)) for at, name in enumerate(("once", "twice"))),
                    Assign("k", i64("twice")),
                ),
            ),
            Return(BEGIN),
        )
    ),
    "bytes and a field that are left and never read": kernel(
        (
            *(ROW_EXISTS, need(BEGIN, 16)),
            *(*_rows(1, 1), *_rows(2, 16)),
            Fill(Place(1, i64("start_1")), index(24)),
            Copy(Place(2, i64("start_2")), Wire(BEGIN), index(16)),
            SetField(Place(1, i64("start_1")), i64("start_2")),
            SetField(Place(1, i64("start_1"), 8), Load("i64", BEGIN)),
            SetField(Place(0, ROW), Get("i64", Place(1, i64("start_1"), 8))),
            Return(BEGIN),
        ),
        strides=(64, 24, 1),
        hidden=2,
    ),
    "elements that must be there, of which one shows what is found between them": kernel(
        (
            *(ROW_EXISTS, need(BEGIN, 16), Let("count", Convert("i64", Load("u8", BEGIN)))),
            *(expect(Compare("lt", index(number), i64("count")), 4, add(BEGIN, number), index(number)) for number in range(3)),
            Let("found", Load("i64", add(BEGIN, 8))),
            *(expect(Compare("lt", index(number), i64("count")), 4, BEGIN, i64("found")) for number in range(3, 5)),
            SetField(Place(0, ROW), i64("found")),
            Return(BEGIN),
        )
    ),
    "bits of a row that is emptied, and of one that is read between": kernel(
        (
            *(ROW_EXISTS, need(BEGIN, 8), Fill(Place(0, ROW), index(24))),
            *(_bit(number, 0) for number in range(3)),
            *(_bit(3, 40), SetField(Place(0, ROW, 16), Get("i64", Place(0, ROW, 40))), _bit(4, 40)),
            If(compare("gt", Convert("i64", Load("u8", BEGIN)), 3), (_bit(5, 0),)),
            *(_bit(6, 0), _bit(7, 8), SetField(Place(0, ROW, 12), Const("i32", 9)), _bit(8, 8)),
            Return(BEGIN),
        )
    ),
    "bits of a row that was emptied, and then copied": kernel(
        (
            *(ROW_EXISTS, need(BEGIN, 8), Fill(Place(0, ROW), index(24)), Copy(Place(0, ROW), Wire(BEGIN), index(8))),
            *(_bit(1, 0), _bit(2, 0), Return(BEGIN)),
        )
    ),
    "bits before and after a row is emptied": kernel(
        (*(ROW_EXISTS, need(BEGIN, 8)), _bit(1, 0), Fill(Place(0, ROW), index(24)), _bit(2, 0), Return(BEGIN))
    ),
    "bits of bytes that keep the others": kernel(
        (*(ROW_EXISTS, need(BEGIN, 8)), *(_bit(number, 0, "u8") for number in (1, 2)), Return(BEGIN))
    ),
    "the same in lanes of the holder": kernel(
        (ROW_EXISTS, need(BEGIN, 16), *_rows(1, 16), Copy(Place(1, i64("start_1")), Wire(BEGIN), index(16)), Return(BEGIN)),
        strides=(64, 1),
    ),
    "bytes that are looked at as a text, as a number, and copied": kernel(
        (
            *(ROW_EXISTS, need(BEGIN, 24)),
            *(*_rows(1, 8), *_rows(2, 8), *_rows(3, 8)),
            *(Copy(Place(lane, i64(f"start_{lane}")), Wire(add(BEGIN, 8 * (lane - 1))), index(8)) for lane in (1, 2, 3)),
            expect(IsText(Place(1, i64("start_1")), index(8)), 3),
            SetField(Place(0, ROW), Nearest(Place(2, i64("start_2")), index(8), index(0))),
            Copy(Place(0, ROW, 8), Place(3, i64("start_3")), index(8)),
            Return(BEGIN),
        ),
        strides=(64, 1, 1, 1),
        hidden=3,
    ),
    "bytes that the host reads, and others that it fills": kernel(
        (
            *(ROW_EXISTS, need(BEGIN, 8)),
            *(*_rows(1, 8), *_rows(2, 8)),
            Copy(Place(1, i64("start_1")), Wire(BEGIN), index(8)),
            HostCall(
                "f",
                (),
                i64("given"),
                fail(3),
                (Extent(Place(1, i64("start_1")), index(8)),),
                Extent(Place(2, index(0)), index(8)),
            ),
            SetField(Place(0, ROW), i64("given")),
            Return(BEGIN),
        ),
        strides=(64, 1, 1),
        hidden=2,
    ),
    "a row that is emptied, and set in one go": straight(Fill(Place(0, ROW), index(24)), *(moved(8 * at, 8 * at) for at in range(3))),
    "a row that is emptied, and set in pieces": straight(
        Fill(Place(0, ROW), index(24)), moved(8, 8, ">"), Let("a", index(1)), moved(0, 16, ">"), moved(16, 0, ">")
    ),
    "a row that is emptied, and set but for its end": straight(Fill(Place(0, ROW), index(24)), moved(8, 8, ">"), moved(0, 0, ">")),
    "a row that is emptied, and set but for its begin": straight(Fill(Place(0, ROW), index(24)), moved(8, 8, ">"), moved(16, 0, ">")),
    "a field that is emptied and set": straight(Fill(Place(0, ROW, 8), index(8)), moved(8, 8)),
    "bytes that are emptied and copied": straight(Fill(Place(0, ROW), index(16)), Copy(Place(0, ROW), Wire(BEGIN), index(16))),
    "a field that is emptied, read and set": straight(
        Fill(Place(0, ROW), index(8)), SetField(Place(0, ROW), Binary("xor", Get("i64", Place(0, ROW)), Load("i64", BEGIN)))
    ),
    "fields that are written end to end": kernel(
        (ROW_EXISTS, need(BEGIN, 24), *(Store(add(BEGIN, 8 * at), Get("i64", Place(0, ROW, 8 * at))) for at in range(3)), Return(BEGIN)),
        direction="encode",
    ),
    "attempts, behind which another kernel goes on": replace(kernels.ALL["attempts"], goes_on=True),
}
"""What a pass does, or must not do."""
