"""Kernels whose routines break their promises, and those whose text is wrong."""

from __future__ import annotations

from dataclasses import replace

from rosetta_jit.kernel.ir import Kernel, Routine
from rosetta_jit.kernel.nodes import (
    Advance,
    Binary,
    Call,
    Capacity,
    Compare,
    Const,
    Fill,
    For,
    HostCall,
    HostValue,
    If,
    Let,
    Load,
    Local,
    Register,
    Reserve,
    Return,
    Used,
    Wire,
)
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index
from tests.kernel.kernels import SITES, compare, expect, fail, i64, need
from tests.kernel.unsafe.cases import AT, DONE, TRUE, Cases, plus, sub

CASES = Cases()

# --- routines ----------------------------------------------------------------------------------------------------------

NEXT = i64("next")


def skip(**changes):
    """A routine that skips a byte."""
    parts = {
        "name": "skip",
        "parameters": (AT,),
        "results": (NEXT,),
        "body": (need(AT, 1), Let("next", add(AT, 1))),
        "requires": (compare("ge", AT, BEGIN), compare("le", AT, END)),
        "ensures": (Compare("le", NEXT, END), Compare("gt", NEXT, AT)),
        "sites": SITES[:2],
    }
    return Routine(**{**parts, **changes})


AFTER = i64("after")
CALL = Call("skip", (BEGIN,), (AFTER,), (1,))


def routine_case(name, words, unsafe, safe, body=(CALL,), safe_body=None):
    """Routines that are refused, or whose call is."""
    CASES.add(name, words, body, None if safe is None else safe_body or body, unsafe, safe)


routine_case(
    "a promise that is broken", "a routine that may break its promise", (skip(ensures=(Compare("gt", NEXT, add(AT, 1)),)),), (skip(),)
)
routine_case(
    "a demand that is not met",
    "a call that asks for what may not be there",
    (skip(),),
    (skip(),),
    (expect(compare("ge", BEGIN, 1)), Call("skip", (sub(BEGIN, 1),), (AFTER,), (1,))),
    (expect(compare("ge", BEGIN, 1)), Call("skip", (BEGIN,), (AFTER,), (1,))),
)
routine_case(
    "a routine that reads without a check",
    "bytes beyond the end of the message",
    (skip(body=(Let("x", Load("u8", AT)), Let("next", AT))),),
    None,
)
routine_case(
    "a routine that relies on what it does not require",
    "bytes before the begin of the message",
    (skip(body=(need(AT, 1), Let("x", Load("u8", AT)), Let("next", add(AT, 1))), requires=(compare("ge", AT, 0),), ensures=()),),
    (skip(body=(need(AT, 1), Let("x", Load("u8", AT)), Let("next", add(AT, 1))), ensures=()),),
)
routine_case(
    "what a routine does not promise",
    "bytes beyond the end of the message",
    (skip(ensures=(Compare("gt", NEXT, AT),)),),
    (skip(),),
    (CALL, Fill(Wire(AFTER), index(0))),
)
routine_case(
    "more than a routine promises",
    "bytes beyond the end of the message",
    (skip(),),
    (skip(),),
    (CALL, Let("x", Load("u8", AFTER))),
    (CALL, Let("x", Load("u8", sub(AFTER, 1)))),
)
routine_case("a result that is not there", "no i64 next", (skip(body=(need(AT, 1), Let("other", add(AT, 1))), ensures=()),), (skip(),))
routine_case("a result of another type", "no u64 next", (skip(results=(Local("u64", "next"),), ensures=()),), None)
routine_case(
    "an argument of another type",
    "i32 where i64 belongs",
    (skip(),),
    (skip(),),
    (Call("skip", (Const("i32", 1),), (AFTER,), (1,)),),
    (CALL,),
)
routine_case("the row in a routine", "row is not visible here", (skip(body=(Let("next", ROW),), ensures=()),), None)

# --- the text ----------------------------------------------------------------------------------------------------------

routine_case("two routines of a name", "routine skip: a name that another one has", (skip(), skip()), (skip(), skip(name="skip_2")))
routine_case("a result of 32 bits", "routine skip: a result that is no integer of 64 bits", (skip(results=(Local("i32", "next"),)),), None)
ONLY_BODIES = "routine skip: something that only a body can do"
for what, stmt in {
    "a Return": DONE,
    "a Reserve": Reserve(0, index(1)),
    "an Advance": Advance(0, index(0)),
    "a HostCall": HostCall("f", (), i64("x"), fail(1)),
    "a used length": Let("x", Used(0)),
    "what the host tells": Let("x", plus(HostValue("now"), 1)),
}.items():
    routine_case(f"{what} in a routine", ONLY_BODIES, (skip(body=(If(TRUE, (stmt,)), need(AT, 1), Let("next", add(AT, 1)))),), None)
CASES.accept("a capacity in a routine", (CALL,), (skip(body=(Let("x", Capacity(0)), need(AT, 1), Let("next", add(AT, 1)))),))
routine_case("a parameter named twice", "routine skip: a parameter that is named twice", (skip(parameters=(AT, AT)),), None)
routine_case("a parameter named as the end", "routine skip: a parameter that is named twice", (skip(parameters=(END,)),), None)
routine_case("a routine that calls itself", "routine skip: no routine skip before", (skip(body=(CALL, Let("next", AT))),), None)
routine_case("a routine that is not there", "no routine skip before", (skip(name="other"),), None)
routine_case(
    "a call with an argument too many", "a call that does not fit skip", (skip(),), None, (Call("skip", (BEGIN, END), (AFTER,), (1,)),)
)
routine_case("a call with a result too few", "a call that does not fit skip", (skip(),), None, (Call("skip", (BEGIN,), (), (1,)),))
routine_case("a call with a site too many", "a call that does not fit skip", (skip(),), None, (Call("skip", (BEGIN,), (AFTER,), (1, 2)),))
routine_case("a call at no site", "no site 99", (skip(),), None, (Call("skip", (BEGIN,), (AFTER,), (99,)),))
routine_case("a site that a routine has not", "routine skip: no site 2", (skip(body=(need(AT, 1, 2), Let("next", add(AT, 1)))),), None)
CASES.refused["no bodies"] = "a kernel without bodies", Kernel("test", "decode", (64,), (), SITES)
CASES.add("a name twice", "x is bound twice", (Let("x", index(1)), Let("x", index(2))))
CASES.add("a name twice, in two branches", "x is bound twice", (If(TRUE, (Let("x", index(1)),), (Let("x", index(2)),)),))
CASES.add("a parameter's name", "end is bound twice", (Let("end", index(1)),))
CASES.add(
    "a loop's name", "i is bound twice", (For("i", index(1), (For("i", index(1), ()),)),), (For("i", index(1), (For("j", index(1), ()),)),)
)
CASES.add("a function's name", "x is bound twice", (Let("x", index(1)), HostCall("f", (), i64("x"), fail(1))))
CASES.add("no site of that number", f"no site {len(SITES)}", (need(BEGIN, 4, len(SITES)),), (need(BEGIN, 4, len(SITES) - 1),))
CASES.add("the site of growing", "no site 0", (need(BEGIN, 4, 0),), (need(BEGIN, 4, 1),))
CASES.add("a site of a condition", "no site 99", (expect(TRUE, 99),))
CASES.add("a site of a function", "no site 99", (HostCall("f", (), i64("x"), fail(99)),))
CASES.add("too many indices", "too many indices", (need(BEGIN, 4, 1, *[index(0)] * 5),), (need(BEGIN, 4, 1, *[index(0)] * 4),))


def tower(depth):
    """An expression that is nested so deep."""
    expr = END
    for _ in range(depth - 1):
        expr = Binary("min", expr, BEGIN)
    return expr


def nest(depth):
    """Blocks that are nested so deep."""
    block = (Let("x", index(1)),)
    for _ in range(depth - 1):
        block = (If(compare("gt", END, 0), block),)
    return block


CASES.add("a deep expression", "an expression is nested too deep", (Let("x", tower(101)),), (Let("x", tower(100)),))
routine_case(
    "a deep expression in a routine",
    "routine skip: an expression is nested too deep",
    (skip(body=(Let("x", tower(101)), need(AT, 1), Let("next", add(AT, 1)))),),
    (skip(body=(Let("x", tower(100)), need(AT, 1), Let("next", add(AT, 1)))),),
)
CASES.add("deep blocks", "blocks are nested too deep", nest(101), nest(100))
CASES.add("a negative stride", "a lane whose rows have less than no bytes", (), strides=(8, -8))
CASES.accept("a negative stride", (), strides=(8, 0))
CASES.refused["more hidden lanes than lanes"] = "2 of 1 lanes are hidden", Kernel("test", "decode", (8,), ((DONE,),), SITES, (), 2)
CASES.accepted["more hidden lanes than lanes"] = Kernel("test", "decode", (8,), ((DONE,),), SITES, (), 1)

KEPT = "it keeps lanes that it cannot keep"
KEEPS = Kernel("test", "decode", (8, 8), ((DONE,),), SITES, kept=(0, 1))
CASES.accepted["a lane kept"] = KEEPS
CASES.refused["a lane kept that is not there"] = KEPT, replace(KEEPS, kept=(0, 2))
CASES.refused["a lane kept without the first"] = KEPT, replace(KEEPS, kept=(1,))
CASES.refused["a lane kept when encoding"] = KEPT, replace(KEEPS, direction="encode")

# --- registers ---------------------------------------------------------------------------------------------------------

ONCE, TWICE = ((number, index(0)) for number in range(2)), ((0, index(0)), (0, index(0)))
CASES.add("a register beyond the last", "no register 2", (Let("x", Register(2)),), (Let("x", Register(1)),), registers=2)
CASES.add("a register set twice", "a register that is set twice", (Return(END, TWICE), None), (Return(END, tuple(ONCE)), None), registers=2)
