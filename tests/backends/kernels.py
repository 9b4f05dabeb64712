"""Kernels made by hand, one for each thing that a backend must get right."""

from __future__ import annotations

import math

from rosetta_jit.kernel.ir import Kernel, Site
from rosetta_jit.kernel.nodes import (
    Advance,
    Assign,
    Binary,
    Block,
    Capacity,
    Compare,
    Const,
    Convert,
    Copy,
    Direction,
    Expect,
    Expr,
    Failure,
    Fill,
    For,
    Get,
    If,
    IsText,
    Let,
    Load,
    Local,
    Place,
    Require,
    Reserve,
    Return,
    SetField,
    Store,
    Switch,
    Used,
    Var,
    While,
    Wire,
)
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index, mul

POS, COUNT, AT, START = (Local("i64", name) for name in ("pos", "count", "i", "start"))


def kernel(*bodies: Block, strides: tuple[int, ...], sites: int = 9, direction: Direction = "decode", name: str = "test") -> Kernel:
    return Kernel(name, direction, strides, bodies, tuple(Site("truncated", f".{number}", "") for number in range(sites)))


def failure(site: int, at: Expr = BEGIN, *indices: Expr) -> Failure:
    return Failure(site, at, indices)


def row_fits() -> Expect:
    return Expect(Compare("lt", ROW, Capacity(0)), failure(8))


def i64(expr: Expr) -> Expr:
    return Convert("i64", expr)


def fixed(fields: int) -> Kernel:
    """``fields`` tagged doubles, degrees to radians, into a row of floats."""
    body: Block = (Require(BEGIN, index(12 * fields), failure(1)), row_fits())
    for field in range(fields):
        at = add(BEGIN, 12 * field)
        body += (
            Expect(Compare("eq", Load("i32", at), Const("i32", 10)), failure(2, at)),
            SetField(Place(0, ROW, 4 * field), Convert("f32", Binary("mul", Load("f64", add(at, 4)), Const("f64", math.pi / 180)))),
        )
    return kernel((*body, Return(add(BEGIN, 12 * fields))), strides=(4 * fields,), name="fixed")


def specialised(count: int = 24) -> Kernel:
    """A bottle of doubles under one header, in a loop, into a row of floats."""
    radians = Convert("f32", Binary("mul", Load("f64", add(Binary("add", BEGIN, mul(AT, 8)), 8)), Const("f64", math.pi / 180)))
    body = (
        Require(BEGIN, index(8 + 8 * count), failure(1)),
        row_fits(),
        Expect(Compare("eq", Load("i32", BEGIN), Const("i32", 266)), failure(2)),
        Expect(Compare("eq", Load("i32", add(BEGIN, 4)), Const("i32", count)), failure(3, add(BEGIN, 4))),
        Expect(Compare("eq", END, add(BEGIN, 8 + 8 * count)), failure(4, add(BEGIN, 8 + 8 * count))),
        Reserve(1, index(count)),
        Let("start", Used(1)),
        SetField(Place(0, ROW, 0), START),
        SetField(Place(0, ROW, 8), index(count)),
        For("i", index(count), (SetField(Place(1, Binary("add", START, AT)), radians),)),
        Advance(1, index(count)),
        Return(add(BEGIN, 8 + 8 * count)),
    )
    return kernel(body, strides=(16, 4), name="specialised")


def counted() -> Kernel:
    """An int32 count, then so many big-endian int16, each of which must not be negative."""
    at = add(Binary("add", BEGIN, mul(AT, 2)), 4)
    body = (
        Require(BEGIN, index(4), failure(1)),
        row_fits(),
        Let("count", i64(Load("i32", BEGIN))),
        Expect(Compare("ge", COUNT, index(0)), failure(2)),
        Require(add(BEGIN, 4), mul(COUNT, 2), failure(3, add(BEGIN, 4))),
        Reserve(1, COUNT),
        Let("start", Used(1)),
        For(
            "i",
            COUNT,
            (
                Let("value", Load("i16", at, ">")),
                Expect(Compare("ge", Local("i16", "value"), Const("i16", 0)), failure(4, at, AT)),
                SetField(Place(1, Binary("add", START, AT)), Convert("f64", Local("i16", "value"))),
            ),
        ),
        SetField(Place(0, ROW, 0), START),
        SetField(Place(0, ROW, 8), COUNT),
        Advance(1, COUNT),
        Return(Binary("add", add(BEGIN, 4), mul(COUNT, 2))),
    )
    return kernel(body, strides=(16, 8), name="counted")


def varints() -> Kernel:
    """Varints to the end of the message, of at most ten bytes each, into a lane of u64."""
    value, shift, byte = Local("u64", "value"), Local("i64", "shift"), Local("u64", "byte")
    step = (
        Require(POS, index(1), failure(1, POS, Used(0))),
        Expect(Compare("le", shift, index(63)), failure(2, POS, Used(0))),
        Let("byte", Convert("u64", Load("u8", POS))),
        Assign("value", Binary("or", value, Binary("shl", Binary("and", byte, Const("u64", 127)), Convert("u64", shift)))),
        Assign("pos", add(POS, 1)),
        Assign("shift", add(shift, 7)),
        Assign("more", Compare("ge", byte, Const("u64", 128))),
    )
    body = (
        Var("pos", BEGIN),
        While(
            Compare("lt", POS, END),
            (
                Var("value", Const("u64", 0)),
                Var("shift", index(0)),
                Var("more", Const("bool", True)),
                While(Local("bool", "more"), step, (), shift),
                Reserve(0, index(1)),
                SetField(Place(0, Used(0)), value),
                Advance(0, index(1)),
            ),
            (),
            POS,
        ),
        Return(POS),
    )
    return kernel(body, strides=(8,), name="varints")


def attempts() -> Kernel:
    """Three dialects of one message, told apart by their second byte; the failure that came farthest is reported."""

    def dialect(number: int) -> Block:
        return (
            Require(BEGIN, index(2), failure(1)),
            row_fits(),
            Reserve(1, index(1)),
            SetField(Place(1, Used(1)), Const("u8", number)),
            Advance(1, index(1)),
            Expect(Compare("eq", Load("u8", BEGIN), Const("u8", 7)), failure(2, BEGIN, index(number))),
            Expect(
                Compare("eq", Load("u8", add(BEGIN, 1)), Const("u8", number)), failure(3 + number, add(BEGIN, number), index(number), ROW)
            ),
            SetField(Place(0, ROW), index(number)),
            Return(add(BEGIN, 2)),
        )

    return kernel(dialect(2), dialect(1), dialect(0), strides=(8, 1), name="attempts")


def tagged() -> Kernel:
    """A tag byte, then an i32, an f32, text of 5 bytes, or, for any other tag, nothing; Copy and Fill of the rest."""
    rest = Binary("sub", END, POS)
    text = add(BEGIN, 1)
    body = (
        Require(BEGIN, index(1), failure(1)),
        row_fits(),
        Var("pos", add(BEGIN, 1)),
        Fill(Place(0, ROW), index(16), 0xAB),
        Switch(
            Load("u8", BEGIN),
            (
                (1, (Require(POS, index(4), failure(2)), SetField(Place(0, ROW, 4), Load("i32", POS)), Assign("pos", add(POS, 4)))),
                (2, (Require(POS, index(4), failure(3)), SetField(Place(0, ROW, 8), Load("f32", POS, ">")), Assign("pos", add(POS, 4)))),
                (
                    200,
                    (
                        Require(POS, index(5), failure(4)),
                        Expect(IsText(Wire(text), index(5)), failure(5, text)),
                        Copy(Place(0, ROW, 8), Wire(text), index(5)),
                        Assign("pos", add(POS, 5)),
                    ),
                ),
            ),
            (SetField(Place(0, ROW), Compare("gt", rest, index(2))),),
        ),
        Let("rest", rest),
        If(
            Compare("gt", Local("i64", "rest"), index(0)),
            (
                Reserve(1, Local("i64", "rest")),
                Copy(Place(1, Used(1)), Wire(POS), Local("i64", "rest")),
                Advance(1, Local("i64", "rest")),
            ),
        ),
        Return(END),
    )
    return kernel(body, strides=(16, 1), name="tagged")


def text() -> Kernel:
    """Whether the whole message is text, as an error or not."""
    size = Binary("sub", END, BEGIN)
    return kernel((Require(BEGIN, size, failure(1)), Expect(IsText(Wire(BEGIN), size), failure(2)), Return(END)), strides=(8,), name="text")


def encoder() -> tuple[Kernel, Kernel]:
    """Doubles of lane 1 behind a count, as `counted_doubles` reads them; and its size."""
    start, count = Get("i64", Place(0, ROW, 0)), Get("i64", Place(0, ROW, 8))
    known = (
        row_fits(),
        Let("start", start),
        Let("count", count),
        Expect(Compare("ge", START, index(0)), failure(2)),
        Expect(Compare("ge", COUNT, index(0)), failure(3)),
        Expect(Compare("le", START, Used(1)), failure(4)),
        Expect(Compare("le", COUNT, Binary("sub", Used(1), START)), failure(5)),
    )
    behind = Binary("add", add(BEGIN, 4), mul(COUNT, 8))
    write = (
        *known,
        Require(BEGIN, add(mul(COUNT, 8), 4), failure(1)),
        Store(BEGIN, Convert("i32", COUNT)),
        For("i", COUNT, (Store(add(Binary("add", BEGIN, mul(AT, 8)), 4), Get("f64", Place(1, Binary("add", START, AT)))),)),
        Return(behind),
    )
    return (
        kernel(write, strides=(16, 8), direction="encode", name="encoder"),
        kernel((*known, Return(behind)), strides=(16, 8), direction="size", name="size"),
    )


def swapped(width: int = 320, height: int = 240) -> Kernel:
    """An image of RGB pixels, its channels swapped."""
    at = Binary("add", BEGIN, mul(AT, 3))
    size = 3 * width * height
    start = mul(AT, 3)
    body = (
        Require(BEGIN, index(size), failure(1)),
        Reserve(1, index(size)),
        For(
            "i",
            index(width * height),
            tuple(SetField(Place(1, add(start, channel)), Load("u8", add(at, 2 - channel))) for channel in range(3)),
        ),
        Return(add(BEGIN, size)),
    )
    return kernel(body, strides=(16, 1), name="swapped")


DECODERS = (fixed(10), specialised(), counted(), varints(), attempts(), tagged(), text())
