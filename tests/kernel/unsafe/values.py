"""Kernels whose arithmetic may go wrong, or says more than it should."""

from __future__ import annotations

from rosetta_jit.kernel.arithmetic import LARGEST_SCALE
from rosetta_jit.kernel.nodes import (
    Assign,
    Binary,
    Bits,
    Compare,
    Const,
    Convert,
    Digits,
    Fits,
    For,
    If,
    Let,
    Load,
    Local,
    Lookup,
    Return,
    Scale,
    Select,
    Switch,
    Unary,
    Var,
)
from rosetta_jit.kernel.terms import BEGIN, END, index
from tests.kernel.kernels import compare, expect, i64, need
from tests.kernel.unsafe.cases import FALSE, TRUE, TWO, WORD, Cases, M, N, between, both, plus, put, rows, sub, times

CASES = Cases()

# --- arithmetic --------------------------------------------------------------------------------------------------------

OCTET = Local("u8", "o")
LOADED = need(BEGIN, 1), Let("o", Load("u8", BEGIN))
CASES.add(
    "a sum that wraps",
    "u8 arithmetic that may wrap",
    (*LOADED, Let("x", Binary("add", OCTET, Const("u8", 1)))),
    (*LOADED, expect(Compare("le", OCTET, Const("u8", 254))), Let("x", Binary("add", OCTET, Const("u8", 1)))),
)
CASES.add(
    "a difference that wraps",
    "u8 arithmetic that may wrap",
    (*LOADED, Let("x", Binary("sub", OCTET, Const("u8", 1)))),
    (*LOADED, expect(Compare("ge", OCTET, Const("u8", 1))), Let("x", Binary("sub", OCTET, Const("u8", 1)))),
)
CASES.add(
    "a product that wraps",
    "u8 arithmetic that may wrap",
    (*LOADED, expect(Compare("le", OCTET, Const("u8", 86))), Let("x", Binary("mul", OCTET, Const("u8", 3)))),
    (*LOADED, expect(Compare("le", OCTET, Const("u8", 85))), Let("x", Binary("mul", OCTET, Const("u8", 3)))),
)
TABLE = (3, 5, 250)
CASES.add(
    "a value beyond its table",
    "a value that the table may not have",
    (*LOADED, Let("x", Lookup("u8", TABLE, Convert("i64", OCTET)))),
    (*LOADED, expect(Compare("le", OCTET, Const("u8", 2))), Let("x", Lookup("u8", TABLE, Convert("i64", OCTET)))),
)
CASES.add(
    "a value before its table",
    "a value that the table may not have",
    (*WORD, expect(compare("le", N, 2)), Let("x", Lookup("u8", TABLE, N))),
    (*WORD, expect(compare("le", N, 2)), expect(compare("ge", N, 0)), Let("x", Lookup("u8", TABLE, N))),
)
CASES.add(
    "a sum with a value of a table that wraps",
    "u8 arithmetic that may wrap",
    (*WORD, Let("x", Binary("add", Lookup("u8", TABLE, index(1)), Const("u8", 6)))),
    (*WORD, Let("x", Binary("add", Lookup("u8", TABLE, index(1)), Const("u8", 5)))),
)
CASES.add(
    "a difference with a value of a table that wraps",
    "u8 arithmetic that may wrap",
    (*WORD, Let("x", Binary("sub", Lookup("u8", TABLE, index(1)), Const("u8", 4)))),
    (*WORD, Let("x", Binary("sub", Lookup("u8", TABLE, index(1)), Const("u8", 3)))),
)
CASES.add("a value that a table cannot have", "a value that is no u8", (*WORD, Let("x", Lookup("u8", (256,), index(0)))))
CASES.add("a table without a value", "a value among none", (*WORD, Let("x", Lookup("u8", (), index(0)))))
CASES.add("a position that wraps", "i64 arithmetic that may wrap", (*WORD, Let("x", plus(N, 1))))
CASES.accept(
    "a position that wraps",
    (
        *WORD,
        expect(compare("lt", N, (1 << 63) - 1)),
        Let("x", plus(N, 1)),
    ),
)
CASES.add("a square that wraps", "i64 arithmetic that may wrap", (*WORD, Let("x", times(N, N))))
CASES.add(
    "a product that was not asked to fit",
    "i64 arithmetic that may wrap",
    (*WORD, expect(Fits("mul", N, index(7))), Let("x", times(N, 8))),
    (*WORD, expect(Fits("mul", N, index(8))), Let("x", times(N, 8))),
)
CASES.add(
    "a sum that was asked to fit as a difference",
    "i64 arithmetic that may wrap",
    (*WORD, expect(Fits("sub", N, index(8))), Let("x", plus(N, 8))),
    (*WORD, expect(Fits("add", N, index(8))), Let("x", plus(N, 8))),
)
LEAST = -(1 << 31)
INT = need(BEGIN, 4), Let("s", Load("i32", BEGIN))
S = Local("i32", "s")
for function in ("neg", "abs"):
    CASES.add(
        f"{function} of the least number",
        "i32 arithmetic that may wrap",
        (*INT, Let("x", Unary(function, S))),
        (*INT, expect(Compare("gt", S, Const("i32", LEAST))), Let("x", Unary(function, S))),
    )
for op in ("div", "rem"):
    CASES.add(
        f"{op} by zero",
        "a division that may be by zero",
        (*between("n", 0, 9), Let("x", Binary(op, END, N))),
        (*between("n", 1, 9), Let("x", Binary(op, END, N))),
    )
    CASES.add(
        f"{op} of the least number",
        "a division that may overflow",
        (*INT, Let("x", Binary(op, S, Const("i32", -1)))),
        (*INT, expect(Compare("gt", S, Const("i32", LEAST))), Let("x", Binary(op, S, Const("i32", -1)))),
    )
    CASES.add(
        f"{op} of the least number by one that may be -1",
        "a division that may overflow",
        (*INT, *between("n", -1, 0), expect(compare("ne", N, 0)), Let("x", Binary(op, S, Convert("i32", N)))),
        (*INT, *between("n", -2, -2), Let("x", Binary(op, S, Convert("i32", N)))),
    )
for op in ("shl", "shr"):
    CASES.add(
        f"{op} by the width",
        "a shift by the width or more",
        (*between("n", 0, 64), Let("x", Binary(op, index(1), N))),
        (*between("n", 0, 63), Let("x", Binary(op, index(1), N))),
    )
    CASES.add(
        f"{op} by less than nothing",
        "a shift by the width or more",
        (*between("n", -1, 3), Let("x", Binary(op, index(1), N))),
        (*between("n", 0, 3), Let("x", Binary(op, index(1), N))),
    )
    CASES.add(
        f"{op} of a byte",
        "a shift by the width or more",
        (*LOADED, Let("x", Binary(op, OCTET, Const("u8", 8)))),
        (*LOADED, Let("x", Binary(op, OCTET, Const("u8", 7)))),
    )


def of(expr, low, high, n, m=(0, 0)):
    """An expression of two numbers between bounds, and what it lies between."""
    ranges = [compare(op, i64(name), end) for name, ends in (("n", n), ("m", m)) for op, end in zip(("ge", "le"), ends, strict=True)]
    return (*TWO, expect(both(*ranges))), expr, low, high


ANY = (-(1 << 63), (1 << 63) - 1)
OPERATIONS = {
    "a number": of(N, -3, 5, (-3, 5)),
    "sum": of(plus(N, M), -1, 9, (-3, 5), (2, 4)),
    "difference": of(sub(N, M), -7, 3, (-3, 5), (2, 4)),
    "three times": of(times(N, 3), -9, 15, (-3, 5)),
    "minus twice": of(times(N, -2), -10, 6, (-3, 5)),
    "product": of(times(N, M), -12, 20, (-3, 5), (2, 4)),
    "product of two below zero": of(times(N, M), 6, 20, (-5, -3), (-4, -2)),
    "product of sums": of(times(plus(N, 2), plus(M, 3)), 12, 42, (1, 4), (1, 4)),
    "half": of(Binary("div", N, index(2)), 0, 3, (0, 7)),
    "half of what may be negative": of(Binary("div", N, index(2)), -4, 4, (-7, 7)),
    "division": of(Binary("div", N, M), 0, 20, (0, 20), (1, 4)),
    "division by what may be negative": of(Binary("div", N, M), -20, 20, (-20, 20), (-4, -1)),
    "remainder": of(Binary("rem", N, index(4)), 0, 3, (0, 100)),
    "remainder of what may be negative": of(Binary("rem", N, index(4)), -3, 3, (-100, 100)),
    "remainder by less than nothing": of(Binary("rem", N, index(-4)), -3, 3, (-100, 100)),
    "remainder by a sum": of(Binary("rem", N, plus(M, 2)), 0, 4, (0, 100), (1, 3)),
    "remainder by another": of(Binary("rem", N, M), 0, 4, (0, 100), (1, 5)),
    "remainder by what may be negative": of(Binary("rem", N, M), -4, 4, (-100, 100), (-5, -2)),
    "low bits": of(Binary("and", N, index(7)), 0, 7, ANY),
    "all but low bits": of(Binary("and", N, index(-8)), 0, 23, (0, 23)),
    "and": of(Binary("and", N, M), 0, 6, (0, 6), ANY),
    "or": of(Binary("or", N, M), 0, 7, (0, 5), (0, 4)),
    "xor": of(Binary("xor", N, M), 0, 7, (0, 5), (0, 4)),
    "sum that may wrap": of(Convert("i64", Binary("wrapping_add", Convert("u8", N), Convert("u8", M))), 0, 255, ANY, ANY),
    "sum that does not wrap": of(Convert("i64", Binary("wrapping_add", Convert("u8", N), Convert("u8", M))), 2, 9, (0, 5), (2, 4)),
    "shl": of(Binary("shl", N, index(2)), -12, 20, (-3, 5)),
    "shr": of(Binary("shr", N, index(2)), 0, 5, (0, 23)),
    "shr of what may be negative": of(Binary("shr", N, index(2)), -6, 5, (-23, 23)),
    "shr by another": of(Binary("shr", N, M), 0, 23, (0, 23), (0, 63)),
    "min": of(Binary("min", N, M), -3, 4, (-3, 5), (2, 4)),
    "max": of(Binary("max", N, M), 2, 5, (-3, 5), (2, 4)),
    "neg": of(Unary("neg", N), -5, 3, (-3, 5)),
    "abs": of(Unary("abs", N), 0, 5, (-3, 5)),
    "not": of(Unary("not", N), -6, 2, (-3, 5)),
    "not of bits": of(Convert("i64", Unary("not", Convert("u8", N))), 250, 255, (0, 5)),
    "choice": of(Select(compare("ge", N, 0), N, M), 0, 5, (-3, 5), (2, 4)),
    "choice of its condition": of(Select(compare("ge", N, 0), N, index(0)), 0, 5, (-3, 5)),
    "u8": of(Convert("i64", Convert("u8", N)), 0, 255, ANY),
    "i8": of(Convert("i64", Convert("i8", N)), -128, 127, ANY),
    "what fits": of(Convert("i64", Convert("i8", N)), -3, 5, (-3, 5)),
    "bool": of(Convert("i64", compare("ge", N, 3)), 0, 1, ANY),
    "float": of(Convert("i64", Convert("u8", Convert("f64", N))), 0, 255, ANY),
    "bits": of(Convert("i64", Convert("u8", Bits("u64", Convert("f64", N)))), 0, 255, ANY),
    "digits": of(Convert("i64", Convert("u8", Digits(Convert("f64", N), 3))), 0, 255, ANY),
    "scale": of(Scale(Convert("f64", N)), -LARGEST_SCALE, LARGEST_SCALE, ANY),
}
"""Each between two bounds that it reaches, or that are the best that the proof knows."""

for what, (given, expr, low, high) in OPERATIONS.items():
    CASES.accept(f"{what}: rows", (*given, *rows(high - low + 1), put(sub(expr, low))))
    CASES.add(f"{what}: one row too few", "a row outside its lane", (*given, *rows(high - low), put(sub(expr, low))))
    from_one = put(sub(expr, low + 1))
    CASES.add(f"{what}: one row before the first", "a row that may be negative", (*given, *rows(high - low + 1), from_one))

for what, condition, accepted in (
    ("lt", compare("lt", N, 4), True),
    ("le", compare("le", N, 4), False),
    ("le 3", compare("le", N, 3), True),
    ("twice le 7", compare("le", times(N, 2), 7), True),
    ("twice le 8", compare("le", times(N, 2), 8), False),
    ("gt", Compare("gt", index(4), N), True),
    ("ge", Compare("ge", index(4), N), False),
    ("eq", compare("eq", N, 3), True),
    ("eq 4", compare("eq", N, 4), False),
    ("ne", compare("ne", N, 4), False),
    ("not ge", Unary("not", compare("ge", N, 4)), True),
    ("not gt", Unary("not", compare("gt", N, 4)), False),
    ("not ne", Unary("not", compare("ne", N, 3)), True),
    ("and", both(compare("lt", N, 4), compare("ge", M, 0)), True),
    ("or", Binary("or", compare("lt", N, 4), compare("ge", M, 0)), False),
    ("either way", Binary("or", compare("lt", N, 4), compare("eq", N, 2)), True),
    ("xor", Binary("xor", compare("lt", N, 4), FALSE), False),
    ("not or", Unary("not", Binary("or", compare("ge", N, 4), compare("ge", M, 0))), True),
    ("not and", Unary("not", Binary("and", compare("ge", N, 4), compare("ge", M, 0))), False),
    ("eq of bools", Compare("eq", compare("lt", N, 4), TRUE), False),
    ("of floats", Compare("lt", Convert("f64", N), Const("f64", 4.0)), False),
    ("of its low bits", Compare("lt", Convert("u8", N), Const("u8", 4)), False),
    ("to bool", Convert("bool", N), False),
    ("not to bool", Unary("not", Convert("bool", N)), True),
    ("bool of bool", Convert("bool", compare("lt", N, 4)), True),
):
    body = (*TWO, expect(both(compare("ge", N, 0), compare("le", N, 999))), expect(condition), *rows(4), put(N))
    if accepted:
        CASES.accept(f"condition: {what}", body)
    else:
        CASES.add(f"condition: {what}", "a row outside its lane", body)

OPAQUE = Compare("lt", Convert("f64", N), Const("f64", 1.0)), Compare("lt", Convert("f64", M), Const("f64", 2.0))
CASES.add(
    "two choices that look the same",
    "a row that may be negative",
    (*TWO, *rows(2), put(sub(Select(OPAQUE[0], index(0), index(1)), Select(OPAQUE[1], index(0), index(1))))),
    (*TWO, *rows(2), put(Select(OPAQUE[0], index(0), index(1)))),
)
CASES.add(
    "the number of a bool",
    "a row that may be negative",
    (*between("n", 0, 1), expect(Unary("not", Convert("bool", N))), *rows(2), put(sub(N, 1))),
    (*between("n", 0, 1), expect(Convert("bool", N)), *rows(2), put(sub(N, 1))),
)
CASES.add("digits of zero", "u64 arithmetic that may wrap", (*WORD, Let("x", Binary("sub", Digits(Convert("f64", N)), Const("u64", 1)))))

# --- types -------------------------------------------------------------------------------------------------------------

for name, words, stmt, twin in (
    ("a position of 32 bits", "i32 where i64 belongs", Let("x", Load("u8", Const("i32", 0))), None),
    ("a condition that is a number", "i64 where bool belongs", expect(index(1)), expect(TRUE)),
    ("a local that is not there", "y is not visible here", Let("x", i64("y")), None),
    ("a local of another type", "begin is no i32", Let("x", Local("i32", "begin")), Let("x", BEGIN)),
    ("digits of an integer", "digits of an integer", Let("x", Digits(index(1))), Let("x", Digits(Const("f64", 1.0)))),
    ("too many decimals", "too many decimals", Let("x", Digits(Const("f64", 1.0), 18)), Let("x", Digits(Const("f64", 1.0), 17))),
    ("fewer than no decimals", "too many decimals", Let("x", Digits(Const("f64", 1.0), -1)), Let("x", Digits(Const("f64", 1.0), 0))),
    ("the scale of an integer", "the scale of an integer", Let("x", Scale(index(1))), Let("x", Scale(Const("f64", 1.0)))),
    ("a constant too large", "256 is no u8", Let("x", Const("u8", 256)), Let("x", Const("u8", 255))),
    ("a constant too small", "-129 is no i8", Let("x", Const("i8", -129)), Let("x", Const("i8", -128))),
    ("a constant that is no integer", "1.0 is no i64", Let("x", Const("i64", 1.0)), Let("x", Const("i64", 1))),
    ("a sum of two types", "add of i64 and i32", Let("x", Binary("add", index(1), Const("i32", 1))), None),
    ("bits of floats", "and of floats", Let("x", Binary("and", Const("f64", 1.0), Const("f64", 1.0))), None),
    ("atan2 of f32", "atan2 of f32", Let("x", Binary("atan2", Const("f32", 1.0), Const("f32", 1.0))), None),
    ("a sum of bools", "add of bools", Let("x", Binary("add", TRUE, TRUE)), Let("x", Binary("xor", TRUE, TRUE))),
    ("atan2 of integers", "atan2 of integers", Let("x", Binary("atan2", index(1), index(1))), None),
    (
        "a sum of integers with a sign that may wrap",
        "wrapping_add of i64",
        Let("x", Binary("wrapping_add", index(1), index(1))),
        Let("x", Binary("wrapping_add", Const("u64", 1), Const("u64", 1))),
    ),
    ("a root of an integer", "sqrt of i64", Let("x", Unary("sqrt", index(1))), Let("x", Unary("sqrt", Const("f32", 1.0)))),
    ("a sine of f32", "sin of f32", Let("x", Unary("sin", Const("f32", 1.0))), Let("x", Unary("sin", Const("f64", 1.0)))),
    ("not of a float", "no integer", Let("x", Unary("not", Const("f64", 1.0))), None),
    ("a comparison of two types", "lt of i64 and i32", Let("x", Compare("lt", index(1), Const("i32", 1))), None),
    ("bits of another width", "a i64 has not the bits of a f32", Let("x", Bits("f32", index(1))), Let("x", Bits("f64", index(1)))),
    ("bits of a bool", "a bool has not the bits of a u8", Let("x", Bits("u8", TRUE)), None),
    ("a choice of two types", "a choice between i64 and i32", Let("x", Select(TRUE, index(1), Const("i32", 1))), None),
    ("a choice by a number", "i64 where bool belongs", Let("x", Select(index(1), index(1), index(2))), None),
    ("a switch on a bool", "a switch on a bool", Switch(TRUE, ((1, ()),), ()), Switch(index(1), ((1, ()),), ())),
    ("a switch on a float", "no integer", Switch(Const("f64", 1.0), ((1, ()),), ()), None),
    ("a case twice", "a case that stands twice", Switch(BEGIN, ((1, ()), (1, ())), ()), Switch(BEGIN, ((1, ()), (2, ())), ())),
    ("a case too large", "a case that is no u8", Switch(Const("u8", 1), ((256, ()),), ()), Switch(Const("u8", 1), ((255, ()),), ())),
    ("a case too small", "a case that is no u8", Switch(Const("u8", 1), ((-1, ()),), ()), Switch(Const("u8", 1), ((0, ()),), ())),
):
    CASES.add(name, words, (stmt,), None if twin is None else (twin,))

CASES.add("a change of what does not change", "x is no variable", (Let("x", index(1)), Assign("x", index(2))))
CASES.accept(
    "a change of what does not change",
    (
        Var("x", index(1)),
        Assign("x", index(2)),
    ),
)
CASES.add("a change of a parameter", "end is no variable", (Assign("end", index(2)),))
CASES.add("a change to another type", "x is no i32", (Var("x", index(1)), Assign("x", Const("i32", 2))))
IN_BRANCH = If(compare("gt", END, 0), (Var("x", index(1)), Assign("x", index(2))))
CASES.add("a variable of a branch", "x is no variable", (IN_BRANCH, Assign("x", index(3))), (IN_BRANCH,))
CASES.add("a local of a branch", "x is not visible here", (IN_BRANCH, Return(i64("x")), None), (IN_BRANCH, Return(END), None))
CASES.add("a local of a loop", "i is not visible here", (For("i", index(3), ()), Return(i64("i")), None))
