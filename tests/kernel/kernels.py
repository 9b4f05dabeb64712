"""Small kernels, written as the lowering writes them: a check before each access, and no thought of speed."""

from __future__ import annotations

import numpy as np

from rosetta_jit.kernel import interpret, nodes
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
    Expect,
    Expr,
    Failure,
    Fits,
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
from rosetta_jit.kernel.state import CAPACITY, STRIDE, USED, lane_word, state_words
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index, mul

SITES = (
    Site("grow", "", ""),
    Site("truncated", ".a", "the message ends here"),
    Site("tag", ".a", "another tag"),
    Site("length", ".a", "a negative length"),
    Site("truncated", ".a[{}]", "the message ends here"),
    Site("row", "", "no such row"),
)


def i64(name: str) -> Local:
    return Local("i64", name)


def fail(site: int, at: Expr = BEGIN, *indices: Expr) -> Failure:
    return Failure(site, at, indices)


def need(at: Expr, size: Expr | int, site: int = 1, *indices: Expr) -> Require:
    return Require(at, index(size) if isinstance(size, int) else size, Failure(site, at, indices))


def compare(op: str, left: Expr, right: Expr | int) -> Compare:
    return Compare(op, left, index(right) if isinstance(right, int) else right)


def expect(condition: Expr, site: int = 2, at: Expr = BEGIN, *indices: Expr) -> Expect:
    return Expect(condition, Failure(site, at, indices))


ROW_EXISTS = expect(Compare("lt", ROW, Capacity(0)), 5)


def kernel(
    *bodies: Block,
    strides: tuple[int, ...] = (64, 8),
    sites: tuple[Site, ...] = SITES,
    direction: str = "decode",
    registers: int = 0,
    hidden: int = 0,
) -> Kernel:
    return Kernel("test", direction, strides, bodies, sites, registers=registers, hidden=hidden)


def tagged_doubles(count: int) -> Kernel:
    """``count`` doubles, each after its tag, into the fields of row 0."""
    body: list[nodes.Stmt] = [ROW_EXISTS]
    at: Expr = BEGIN
    for k in range(count):
        tag = Local("i32", f"tag_{k}")
        body += [need(at, 4), Let(tag.name, Load("i32", at)), expect(Compare("eq", tag, Const("i32", 10)), 2, at)]
        at = add(at, 4)
        body += [need(at, 8), SetField(Place(0, ROW, 8 * k), Load("f64", at))]
        at = add(at, 8)
    return kernel((*body, Return(at)), strides=(8 * count,))


def counted_list() -> Kernel:
    """An i32 count and as many i64, into lane 1."""
    n, start, i = i64("n"), i64("start"), i64("i")
    first = add(BEGIN, 4)
    element = i64("element")
    body = (
        ROW_EXISTS,
        need(BEGIN, 4),
        Let("n", Convert("i64", Load("i32", BEGIN))),
        expect(compare("ge", n, 0), 3),
        Reserve(1, n),
        Let("start", Used(1)),
        Advance(1, n),
        SetField(Place(0, ROW, 0), start),
        SetField(Place(0, ROW, 8), n),
        For(
            "i",
            n,
            (
                expect(Fits("mul", i, index(8)), 4, first, i),
                Let("offset", mul(i, 8)),
                expect(Fits("add", first, i64("offset")), 4, first, i),
                Let("element", Binary("add", first, i64("offset"))),
                need(element, 8, 4, i),
                SetField(Place(1, Binary("add", start, i), 0), Load("i64", element)),
            ),
        ),
        expect(Fits("mul", n, index(8)), 3),
        Let("bytes", mul(n, 8)),
        expect(Fits("add", first, i64("bytes")), 3),
        Let("after", Binary("add", first, i64("bytes"))),
        Return(i64("after")),
    )
    return kernel(body)


def strings() -> Kernel:
    """An i32 count and as many strings, each an i32 length and bytes: the position is a variable."""
    n, at, size, start, i = i64("n"), i64("at"), i64("size"), i64("start"), i64("i")
    body = (
        ROW_EXISTS,
        need(BEGIN, 4),
        Let("n", Convert("i64", Load("i32", BEGIN))),
        Var("at", add(BEGIN, 4)),
        Reserve(1, Binary("max", n, index(0))),
        Let("start", Used(1)),
        Advance(1, Binary("max", n, index(0))),
        For(
            "i",
            n,
            (
                need(at, 4, 4, i),
                Let("size", Convert("i64", Load("i32", at))),
                need(add(at, 4), size, 4, i),
                expect(IsText(Wire(add(at, 4)), size), 2, at, i),
                Reserve(2, size),
                Let("text", Used(2)),
                Advance(2, size),
                Copy(Place(2, i64("text")), Wire(add(at, 4)), size),
                SetField(Place(1, Binary("add", start, i), 0), i64("text")),
                SetField(Place(1, Binary("add", start, i), 8), size),
                Assign("at", Binary("add", add(at, 4), size)),
            ),
        ),
        Return(at),
    )
    return kernel(body, strides=(64, 16, 1))


def varints() -> Kernel:
    """Varints to the end of the message; their sum modulo 2 ** 64 into the row."""
    at, byte, shift, value = i64("at"), Local("u64", "byte"), i64("shift"), Local("u64", "value")
    total, more = Local("u64", "total"), Local("bool", "more")
    inner = (
        need(at, 1),
        expect(compare("lt", shift, 64), 3, at),
        Let("byte", Convert("u64", Load("u8", at))),
        Assign(
            "value",
            Binary(
                "or",
                value,
                Binary("shl", Binary("and", byte, Const("u64", 127)), Convert("u64", shift)),
            ),
        ),
        Assign("shift", add(shift, 7)),
        Assign("more", Compare("ge", byte, Const("u64", 128))),
        Assign("at", add(at, 1)),
    )
    body = (
        ROW_EXISTS,
        Var("at", BEGIN),
        Var("total", Const("u64", 0)),
        While(
            compare("lt", at, END),
            (
                Let("first", at),
                Var("value", Const("u64", 0)),
                Var("shift", index(0)),
                Var("more", Const("bool", value=True)),
                While(more, inner, (compare("le", at, END), compare("ge", at, BEGIN), compare("ge", shift, 0)), at),
                expect(Compare("gt", at, i64("first")), 3, at),
                Assign("total", Binary("xor", total, value)),
            ),
            (compare("le", at, END), compare("ge", at, BEGIN)),
            at,
        ),
        SetField(Place(0, ROW, 0), total),
        Return(at),
    )
    return kernel(body, strides=(8,))


def image() -> Kernel:
    """Width, height and padding (i32), then rows of bytes with padding after each; the rows go to lane 1 without it."""
    w, h, pad, step, start = i64("w"), i64("h"), i64("pad"), i64("step"), i64("start")
    y, x, line, first = i64("y"), i64("x"), i64("line"), add(BEGIN, 12)
    small = [expect(Binary("and", compare("ge", v, 0), compare("le", v, 1 << 10)), 3) for v in (w, h, pad)]
    body = (
        ROW_EXISTS,
        need(BEGIN, 12),
        Let("w", Convert("i64", Load("i32", BEGIN))),
        Let("h", Convert("i64", Load("i32", add(BEGIN, 4)))),
        Let("pad", Convert("i64", Load("i32", add(BEGIN, 8)))),
        *small,
        Let("step", Binary("add", w, pad)),
        Let("pixels", Binary("mul", h, w)),
        Reserve(1, i64("pixels")),
        Let("start", Used(1)),
        Advance(1, i64("pixels")),
        For(
            "y",
            h,
            (
                Let("line", Binary("add", first, Binary("mul", y, step))),
                Let("out", Binary("add", start, Binary("mul", y, w))),
                For(
                    "x",
                    w,
                    (
                        need(Binary("add", line, x), 1, 4, y),
                        SetField(Place(1, Binary("add", i64("out"), x), 0), Load("u8", Binary("add", line, x))),
                    ),
                ),
            ),
        ),
        Return(add(BEGIN, 12)),
    )
    return kernel(body, strides=(8, 1))


def choice() -> Kernel:
    """A tag, then a value whose width the tag tells."""
    at = i64("at")
    widths = {1: "i8", 2: "i16", 4: "i32", 8: "i64"}
    cases = tuple(
        (
            tag,
            (
                need(at, tag),
                SetField(Place(0, ROW, 0), Convert("i64", Load(type_, at, ">"))),
                Assign("at", add(at, tag)),
            ),
        )
        for tag, type_ in widths.items()
    )
    body = (
        ROW_EXISTS,
        need(BEGIN, 1),
        Var("at", add(BEGIN, 1)),
        Switch(Load("u8", BEGIN), cases, (expect(Const("bool", value=False), 2),)),
        If(compare("lt", at, END), (need(at, 1), SetField(Place(0, ROW, 8), Load("u8", at)), Assign("at", add(at, 1)))),
        Return(at),
    )
    return kernel(body, strides=(16,))


def encode_list() -> Kernel:
    """The counted list, back to bytes; the span in the row is not trusted."""
    n, start, i = i64("n"), i64("start"), i64("i")
    room = Binary("sub", Used(1), start)
    first = add(BEGIN, 4)
    body = (
        ROW_EXISTS,
        Let("start", Get("i64", Place(0, ROW, 0))),
        Let("n", Get("i64", Place(0, ROW, 8))),
        expect(Binary("and", compare("ge", start, 0), Compare("le", start, Used(1))), 3),
        expect(Binary("and", compare("ge", n, 0), Compare("le", n, room)), 3),
        expect(compare("le", n, (1 << 31) - 1), 3),
        need(BEGIN, 4),
        Store(BEGIN, Convert("i32", n)),
        For(
            "i",
            n,
            (
                Let("element", Binary("add", first, mul(i, 8))),
                need(i64("element"), 8, 4, i),
                Store(i64("element"), Get("i64", Place(1, Binary("add", start, i), 0))),
            ),
        ),
        Return(Binary("add", first, mul(n, 8))),
    )
    return kernel(body, direction="encode")


ALL = {
    "tagged_doubles": tagged_doubles(3),
    "counted_list": counted_list(),
    "strings": strings(),
    "varints": varints(),
    "image": image(),
    "choice": choice(),
    "encode_list": encode_list(),
    "attempts": Kernel("attempts", "decode", (24,), (*tagged_doubles(3).bodies, choice().bodies[0]), SITES),
}


class Holder:
    """State and lanes for the interpreter, grown by hand."""

    def __init__(self, strides: tuple[int, ...], rows: int = 64) -> None:
        self.strides = strides
        self.lanes = [bytearray(stride * rows) for stride in strides]
        self.state = np.zeros(state_words(len(strides)), np.int64)
        for lane, stride in enumerate(strides):
            self.state[lane_word(lane, CAPACITY)] = rows
            self.state[lane_word(lane, STRIDE)] = stride

    @property
    def used(self) -> list[int]:
        return [int(self.state[lane_word(k, USED)]) for k in range(len(self.strides))]


def outcome(kernel: Kernel, message: bytes, *, rows: int = 64, begin: int = 0, seed: bytes = b"") -> tuple[object, ...]:
    """What a kernel does with a message: the result, and on success the holder and the buffer. How it fails may change with a pass."""
    holder = Holder(kernel.strides, rows)
    for lane in holder.lanes:
        lane[: len(seed)] = seed[: len(lane)]
    holder.state[[lane_word(k, USED) for k in range(len(kernel.strides))]] = min(2, rows) if kernel.direction == "encode" else 0
    buffer = bytearray(message)
    result = interpret.run(kernel, buffer, begin, len(buffer), holder.state, holder.lanes, 0)
    if result < 0:
        return ("failed",)
    return (result, holder.used, holder.lanes, buffer)
