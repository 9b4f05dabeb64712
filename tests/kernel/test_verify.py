"""Canaries: good kernels verify, and a kernel with one thing planted in it or taken out of it does not."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

from rosetta_jit.kernel.nodes import (
    Advance,
    Binary,
    Const,
    Copy,
    Expect,
    Fill,
    For,
    Get,
    If,
    Let,
    Load,
    Local,
    Place,
    Require,
    Reserve,
    Return,
    SetField,
    Switch,
    Used,
    Var,
    While,
    Wire,
)
from rosetta_jit.kernel.proof.loops import Guess, needless
from rosetta_jit.kernel.proof.verify import VerificationError, verify
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index, mul
from tests.kernel import kernels
from tests.kernel.kernels import ROW_EXISTS, compare, expect, i64, kernel, need


@pytest.mark.parametrize("name", kernels.ALL)
def test_good_kernels_verify(name):
    verify(kernels.ALL[name])


# --- mutants ---


def without(block, target):
    """The block without one statement, wherever it stands."""
    return rewritten(block, lambda stmt: () if stmt is target else (stmt,))


def rewritten(block, change):
    result = []
    for stmt in block:
        match stmt:
            case For(_, _, body):
                changed = replace(stmt, body=rewritten(body, change))
            case While(_, body, _, _):
                changed = replace(stmt, body=rewritten(body, change))
            case If(_, then, otherwise):
                changed = replace(stmt, then=rewritten(then, change), otherwise=rewritten(otherwise, change))
            case Switch(_, cases, default):
                inner = tuple((n, rewritten(b, change)) for n, b in cases)
                changed = replace(stmt, cases=inner, default=rewritten(default, change))
            case _:
                result += change(stmt)
                continue
        result.append(changed)
    return tuple(result)


def mutants(original):
    """Each kernel that differs in one check: left out, or off by one."""
    for number, body in enumerate(original.bodies):
        found = []
        rewritten(body, lambda stmt: (found.append(stmt), (stmt,))[1])  # noqa: B023  # called at once
        for stmt in found:
            if isinstance(stmt, Require | Expect | Reserve):
                yield f"without {stmt}", number, without(body, stmt), stmt
            if isinstance(stmt, Require):
                smaller = replace(stmt, size=Binary("sub", stmt.size, index(1)))
                yield f"smaller {stmt}", number, rewritten(body, lambda s: (smaller,) if s is stmt else (s,)), stmt  # noqa: B023  # called at once
            if isinstance(stmt, Reserve):
                fewer = replace(stmt, count=Binary("sub", stmt.count, index(1)))
                yield f"fewer {stmt}", number, rewritten(body, lambda s: (fewer,) if s is stmt else (s,)), stmt  # noqa: B023  # called at once


def is_safe(kernel, seed):
    """Whether the interpreter finds no broken obligation on messages made for the purpose."""
    random = Random(seed)  # no secret depends on it
    try:
        for _ in range(60):
            size = random.choice((0, 1, 3, 4, 5, 8, 12, 13, 20, 36, 50))
            message = bytes(random.choice((0, 0, 0, 1, 2, 3, 8, 10, 128, 255)) for _ in range(size))
            kernels.outcome(kernel, message, seed=message[::-1], rows=random.choice((1, 2, 40)))
    except AssertionError:
        return False
    return True


@pytest.mark.parametrize("name", kernels.ALL)
def test_no_unsafe_mutant_verifies(name):
    original = kernels.ALL[name]
    refusals = 0
    for what, number, body, _ in mutants(original):
        mutant = replace(original, bodies=(*original.bodies[:number], body, *original.bodies[number + 1 :]))
        try:
            verify(mutant)
        except VerificationError:
            refusals += 1
        else:
            assert is_safe(mutant, what), what
    assert refusals >= 3


def test_missing_requires_are_refused():
    """Every Require of these kernels guards an access, so that none can go."""
    for name in ("tagged_doubles", "counted_list", "varints", "image", "encode_list"):
        original = kernels.ALL[name]
        for _, _, body, stmt in mutants(original):
            if isinstance(stmt, Require | Reserve):
                with pytest.raises(VerificationError):
                    verify(replace(original, bodies=(body,)))


def test_smaller_strides_are_refused():
    for name, original in kernels.ALL.items():
        for lane, stride in enumerate(original.strides):
            if name in {"choice", "attempts"} or (name in {"counted_list", "encode_list"} and lane == 0) or (name, lane) in WIDE:
                continue
            strides = (*original.strides[:lane], stride - 1, *original.strides[lane + 1 :])
            with pytest.raises(VerificationError):
                verify(replace(original, strides=strides))


WIDE = {("strings", 0), ("image", 0)}
"""Lanes whose rows hold more than the kernel uses."""


# --- one refusal a rule ---


def refused(*body, match, **options):
    with pytest.raises(VerificationError, match=match):
        verify(kernel(body, **options))


DONE = Return(index(0))


def test_locals():
    refused(Let("x", i64("y")), DONE, match="y is not visible")
    refused(Let("x", index(1)), Let("x", index(2)), DONE, match="bound twice")
    refused(Let("end", index(1)), DONE, match="bound twice")
    refused(If(compare("gt", END, 0), (Let("x", index(1)),)), Return(i64("x")), match="x is not visible")
    refused(Let("x", index(1)), kernels.Assign("x", index(2)), DONE, match="no variable")
    refused(Var("x", index(1)), kernels.Assign("x", Const("i32", 2)), DONE, match="no i32")


def test_types():
    refused(Let("x", Binary("add", index(1), Const("i32", 1))), DONE, match="add of i64 and i32")
    refused(Let("x", Const("u8", 256)), DONE, match="no u8")
    refused(Expect(index(1), kernels.fail(1)), DONE, match="where bool belongs")
    refused(Let("x", Load("i64", Const("i32", 0))), DONE, match="where i64 belongs")


def test_arithmetic():
    n = i64("n")
    load = (need(BEGIN, 8), Let("n", Load("i64", BEGIN)))
    for op in ("add", "sub", "mul"):
        refused(*load, Let("x", Binary(op, n, index(7))), DONE, match="may wrap")
        refused(*load, Let("x", Binary(op, n, n)), *((DONE,) if op != "sub" else (Return(n),)), match="may" if op != "sub" else "negative")
    refused(*load, Let("x", Binary("div", index(1), n)), DONE, match="by zero")
    refused(*load, expect(compare("ne", n, 0)), Let("x", Binary("div", n, index(-1))), DONE, match="overflow")
    verify(kernel((*load, expect(compare("ne", n, 0)), Let("x", Binary("div", END, n)), DONE)))
    refused(*load, Let("x", Binary("shl", index(1), n)), DONE, match="shift")
    refused(*load, Let("x", Binary("wrapping_add", n, index(1))), DONE, match="wrapping_add of i64")
    verify(kernel((*load, expect(compare("gt", n, 0)), Let("x", Binary("rem", END, n)), DONE)))
    verify(kernel((*load, expect(compare("ne", n, 0)), expect(compare("gt", n, -2)), Let("x", Binary("div", END, n)), DONE)))


def test_paths():
    refused(Let("x", index(1)), match="without Return")
    refused(DONE, Let("x", index(1)), match="after the end")
    refused(If(compare("gt", END, 0), (DONE,)), match="without Return")
    refused(Return(Binary("sub", BEGIN, index(1))), match="negative")
    verify(kernel((If(compare("gt", END, 0), (DONE,), (expect(Const("bool", value=False)),)),)))
    refused(Switch(BEGIN, ((1, ()), (1, ())), ()), DONE, match="stands twice")
    refused(match="without Return")


def test_bools_that_change():
    """What is known of a bool is no number: behind a branch that changes it, both of its values may be."""
    load = (need(BEGIN, 16), Let("n", Load("i64", BEGIN)), Let("m", Load("i64", add(BEGIN, 8))))
    ok = Local("bool", "ok")
    change = kernels.Assign("ok", compare("ge", i64("m"), 5))
    for changed in (
        If(compare("ge", i64("m"), 0), (change,)),
        For("k", Binary("min", Binary("max", i64("m"), index(0)), index(9)), (change,)),
    ):
        start = (*load, Var("ok", compare("ge", i64("n"), 0)), changed)
        wild = Let("x", Binary("div", index(1), Binary("sub", BEGIN, BEGIN)))
        refused(*start, If(ok, (), (wild,)), DONE, match="by zero")
        refused(*start, If(ok, (wild,), ()), DONE, match="by zero")
        verify(kernel((*start, If(ok, (), ()), DONE)))
    compared = Binary("or", compare("lt", i64("n"), 0), compare("gt", i64("m"), 3))
    verify(kernel((*load, Var("ok", compare("ge", i64("n"), 0)), If(ok, (kernels.Assign("ok", compared),)), DONE)))


def test_sites():
    refused(need(BEGIN, 4, 99), DONE, match="no site 99")
    refused(need(BEGIN, 4, 0), DONE, match="no site 0")


def test_copies():
    n = i64("n")
    load = (ROW_EXISTS, need(BEGIN, 8), Let("n", Load("i64", BEGIN)))
    rows = (expect(compare("ge", n, 0)), Reserve(1, n), Let("start", Used(1)), Advance(1, n))
    to_lane = Copy(Place(1, i64("start")), Wire(BEGIN), mul(n, 8))
    refused(*load, *rows, to_lane, DONE, match="beyond the end")
    refused(
        *load, need(BEGIN, n), *rows, Copy(Place(1, i64("start")), Wire(BEGIN), n), Fill(Place(1, i64("start")), END), DONE, match="lane"
    )
    verify(kernel((*load, *rows, Require(BEGIN, mul(n, 8), kernels.fail(1)), to_lane, DONE)))
    refused(need(BEGIN, 8), Copy(Wire(BEGIN), Wire(BEGIN), index(8)), DONE, match="within the message")
    refused(ROW_EXISTS, Copy(Place(0, ROW), Place(0, ROW, 4), index(8)), DONE, match="onto itself")
    verify(kernel((ROW_EXISTS, Copy(Place(0, ROW), Place(0, ROW, 8), index(8)), DONE)))
    refused(ROW_EXISTS, SetField(Place(0, ROW, 4), index(8)), DONE, match="aligned")
    refused(ROW_EXISTS, SetField(Place(2, ROW, 4), index(8)), DONE, match="no such lane")


def test_loops():
    at = i64("at")
    start = Var("at", BEGIN)
    inside = (compare("le", at, END), compare("ge", at, BEGIN))
    step = kernels.Assign("at", add(at, 1))
    verify(kernel((start, While(compare("lt", at, END), (step,), inside, at), DONE)))
    refused(start, While(compare("lt", at, END), (), inside, at), DONE, match="no progress")
    refused(start, While(compare("lt", at, END), (kernels.Assign("at", add(at, 2)),), inside, at), DONE, match="a round breaks")
    refused(start, While(compare("gt", at, END), (step,), (compare("ge", at, END),), at), DONE, match="at first")
    refused(start, While(compare("ge", at, 0), (step,), (compare("ge", at, 0),), at), DONE, match="bounds")
    body = (need(at, 1), step)
    verify(kernel((start, For("i", END, body), need(at, 1), Let("x", Load("u8", at)), DONE)))
    refused(start, For("i", END, body), Let("x", Load("u8", at)), DONE, match="beyond the end")


def test_what_rounds_count_is_no_more_than_there_were():
    """So a count does not wrap, and what is kept of so many rows has room in as many."""
    n, found = i64("n"), i64("found")
    load = (ROW_EXISTS, need(BEGIN, 8), Let("n", Load("i64", BEGIN)), expect(compare("ge", n, 0)))
    rows = (Reserve(1, n), Let("start", Used(1)), Advance(1, n), Var("found", index(0)))
    positive = compare("gt", Load("i64", BEGIN), 0)
    keep = SetField(Place(1, Binary("add", i64("start"), found), 0), index(1))
    count = kernels.Assign("found", add(found, kernels.Convert("i64", positive)))
    verify(kernel((*load, *rows, For("i", n, (keep, count)), DONE)))
    verify(
        kernel((*load, *rows, For("i", n, (Let("more", add(found, 1)), If(positive, (keep, kernels.Assign("found", i64("more")))))), DONE))
    )
    behind = SetField(Place(1, Binary("add", i64("start"), Binary("sub", found, index(1))), 0), index(1))
    verify(kernel((*load, *rows, For("i", n, (count,)), If(compare("ge", found, 1), (behind,)), DONE)))
    refused(*load, *rows, For("i", n, (count,)), keep, DONE, match="outside its lane|wrap")
    refused(*load, *rows, For("i", n, (keep, kernels.Assign("found", add(found, 2)))), DONE, match="outside its lane|wrap")
    refused(*load, *rows, For("i", n, (keep, For("j", n, (count,)))), DONE, match="outside its lane|wrap")
    refused(*load, *rows, For("i", n, (count, keep)), DONE, match="outside its lane|wrap")
    refused(*load[:-1], Var("found", index(0)), For("i", n, (kernels.Assign("found", add(found, index(2))),)), DONE, match="wrap")


def test_sums_of_so_many_integers_of_few_bits_do_not_wrap():
    """Those of any number of them may."""
    part, n = i64("part"), i64("n")
    load = (need(BEGIN, 16), Let("n", Load("i64", BEGIN)), expect(compare("ge", n, 0)), Var("part", index(0)))

    def adds(value):
        return (kernels.Assign("part", Binary("add", part, kernels.Convert("i64", value))),)

    few = Binary("min", n, index(1 << 16))
    for scalar in ("i32", "u32", "i8"):
        verify(kernel((*load, For("i", few, adds(Load(scalar, add(BEGIN, 8)))), DONE)))
        refused(*load, For("i", n, adds(Load(scalar, add(BEGIN, 8)))), DONE, match="wrap")
    refused(*load, For("i", few, (For("j", n, adds(Load("i32", add(BEGIN, 8)))),)), DONE, match="wrap")
    refused(*load, For("i", few, (*adds(Load("i32", BEGIN)), *adds(Load("i32", BEGIN)), *adds(part))), DONE, match="wrap")
    wide = For("i", few, adds(Binary("mul", kernels.Convert("i64", Load("i32", BEGIN)), index(1 << 20))))
    refused(*load, wide, DONE, match="wrap")


def test_a_body_that_the_usual_guesses_do_not_prove_is_walked_with_all(monkeypatch):
    at = i64("at")
    body = (need(at, 1), kernels.Assign("at", add(at, 1)))
    every = {Guess("at", anchor, sign) for anchor in range(4) for sign in (1, -1)}
    asked = []
    monkeypatch.setattr("rosetta_jit.kernel.proof.verify.loops.needless", lambda *_: asked.append(1) or every)
    verify(kernel((Var("at", BEGIN), For("i", END, body), need(at, 1), Let("x", Load("u8", at)), DONE)))
    assert asked
    refused(Var("at", BEGIN), For("i", END, body), Let("x", Load("u8", at)), DONE, match="beyond the end")


def test_a_variable_is_not_expected_to_grow_by_what_memory_holds_alone():
    """Wherever the place came from: to walk a large loop again for that would double its proof."""
    at, held = i64("at"), Get("i64", Place(1, i64("at")))
    chained, added = kernels.Assign("at", held), kernels.Assign("at", add(at, held))
    assert needless((chained,), (), None, {"at"}, {}) == {Guess("at", 2, 1)}
    assert needless((If(compare("gt", held, 0), (Let("next", held), kernels.Assign("at", i64("next"))), (added,)),), (), None, {"at"}, {})
    assert not needless((added,), (), None, {"at"}, {})


def test_memory_is_read_once():
    length = Load("i32", BEGIN)
    size = kernels.Convert("i64", length)
    refused(need(BEGIN, 4), need(add(BEGIN, 4), size), Fill(Wire(add(BEGIN, 4)), size), DONE, match="negative|beyond")


def test_deep_kernels_are_refused_and_do_not_overflow_the_stack():
    expr = BEGIN
    for _ in range(99):
        expr = Binary("min", expr, END)
    block = (Let("x", expr),)
    for _ in range(98):
        block = (If(compare("gt", END, 0), block),)
    verify(kernel((*block, DONE)))
    for _ in range(2000):
        expr = Binary("min", expr, END)
    refused(Let("x", expr), DONE, match="too deep")
    for _ in range(2000):
        block = (If(compare("gt", END, 0), block),)
    refused(*block, DONE, match="too deep")


def test_boolean_towers_cost_little():
    body = [Let("b_0", compare("gt", END, 0))]
    for k in range(80):
        b = Local("bool", f"b_{k}")
        body.append(Let(f"b_{k + 1}", Binary("and", b, Binary("or", b, b))))
    verify(kernel((*body, expect(Local("bool", "b_80")), DONE)))
