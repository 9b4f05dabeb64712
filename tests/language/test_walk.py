"""Walks over typed expressions: all kinds have their parts, and what is rebuilt is made of the changed ones."""

from __future__ import annotations

from typing import get_args

import pytest

from rosetta_jit.language import typed
from rosetta_jit.language.typed import BOOL, INT64, Const, IndexStep, Local, Place
from rosetta_jit.language.walk import operands, parts, rebuilt, renamed
from rosetta_jit.model.types import Array, Int

A, B, C, D = (Local(name) for name in "abcd")
AT = Place("wire", (IndexStep(A),), INT64)
CHECK = typed.Binary("==", B, C, BOOL)
EXPRESSIONS = {
    Const: (Const(1, INT64), ""),
    Local: (A, ""),
    typed.StateVariable: (typed.StateVariable("s", 0, "holder", INT64), ""),
    typed.Access: (typed.Access(AT, INT64), "a"),
    typed.LenOf: (typed.LenOf(AT), "a"),
    typed.IsText: (typed.IsText(AT, "x"), "a"),
    typed.Has: (typed.Has(AT), "a"),
    typed.Search: (typed.Search(Place("wire", (IndexStep(A),), Array(INT64)), D, B, "x", required=True), "ab"),
    typed.Reduce: (typed.Reduce("sum", D, A, B, INT64, ((C, "no"),)), "abc"),
    typed.Unary: (typed.Unary("-", A, INT64), "a"),
    typed.Convert: (typed.Convert(A, Int(8), "exact"), "a"),
    typed.Binary: (typed.Binary("+", A, B, INT64), "ab"),
    typed.Nearest: (typed.Nearest(A, D, CHECK, INT64), "abc"),
    typed.Call: (typed.Call("max", (A, B), INT64), "ab"),
    typed.HostCall: (typed.HostCall("f", (A, B), INT64), "ab"),
    typed.Given: (typed.Given("p", (A,), INT64), "a"),
    typed.Choice: (typed.Choice(((A, B),), C, "no", INT64, pieces=(D,)), "abcd"),
    typed.Listed: (typed.Listed((A, B), C, INT64), "abc"),
}


def test_every_kind_of_expression_is_here():
    assert set(EXPRESSIONS) == set(get_args(typed.Expr))


@pytest.mark.parametrize("kind", EXPRESSIONS, ids=lambda kind: kind.__name__)
def test_parts_are_what_is_rebuilt(kind):
    expr, names = EXPRESSIONS[kind]
    inside = [part for each in operands(expr) for part in parts(each)]
    assert [part.name for part in inside if isinstance(part, Local)] == list(names)
    moved = renamed(expr, {name: Local(name.upper()) for name in names}) if kind is not Local else expr
    inside = [part for each in operands(moved) for part in parts(each)]
    assert [part.name for part in inside if isinstance(part, Local)] == list(names.upper())
    assert rebuilt(expr, lambda part: part) == expr
