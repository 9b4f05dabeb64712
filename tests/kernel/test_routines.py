"""Which lanes a routine names, and that a proof of one holds for kernels of other lanes, and for no other strides of those it names."""

from __future__ import annotations

from dataclasses import replace

import pytest

from rosetta_jit.kernel.ir import Routine, Site
from rosetta_jit.kernel.nodes import (
    Advance,
    Call,
    Capacity,
    Compare,
    Copy,
    Expect,
    Extent,
    Failure,
    Fill,
    Get,
    HostCall,
    If,
    IsText,
    Let,
    Local,
    Nearest,
    Place,
    Reserve,
    Return,
    SetField,
    Switch,
    Used,
    While,
    Wire,
)
from rosetta_jit.kernel.proof import verify as proof
from rosetta_jit.kernel.proof.verify import VerificationError, verify
from rosetta_jit.kernel.routines import called_routines, named_lanes
from rosetta_jit.kernel.terms import BEGIN, END, index
from tests.backends.kernels import kernel

FAILED = Failure(1, BEGIN)
SITES = (Site("grow", "", ""),)
HERE, THERE = Place(3, index(0)), Place(5, index(0))
TRUE = Compare("le", BEGIN, END)


def routine(*body, requires=(), ensures=(), name="one"):
    return Routine(name, (), (), body, requires, ensures, SITES)


@pytest.mark.parametrize(
    ("body", "lanes"),
    [
        ((Let("x", BEGIN),), set()),
        ((Let("x", Get("i64", HERE)),), {3}),
        ((Let("x", Get("i64", Place(3, Get("i64", THERE)))),), {3, 5}),
        ((Let("x", Used(4)),), {4}),
        ((Let("x", Capacity(4)),), {4}),
        ((SetField(HERE, index(1)),), {3}),
        ((Copy(HERE, THERE, index(1)),), {3, 5}),
        ((Copy(HERE, Wire(BEGIN), index(1)),), {3}),
        ((Fill(HERE, index(1)),), {3}),
        ((Reserve(2, index(1)), Advance(6, index(1))), {2, 6}),
        ((Expect(IsText(HERE, index(1)), FAILED),), {3}),
        ((Expect(IsText(Wire(BEGIN), index(1)), FAILED),), set()),
        ((Let("x", Nearest(HERE, index(1), index(0))),), {3}),
        ((Expect(TRUE, Failure(1, BEGIN, (Get("i64", HERE),))),), {3}),
        ((HostCall("f", (), Local("i64", "x"), FAILED, (Extent(HERE, index(1)),), Extent(THERE, index(1))),), {3, 5}),
        ((If(TRUE, (SetField(HERE, index(1)),), (SetField(THERE, index(1)),)),), {3, 5}),
        ((Switch(BEGIN, ((1, (SetField(HERE, index(1)),)),), ()),), {3}),
        ((While(TRUE, (SetField(HERE, index(1)),), (Compare("ge", Used(9), index(0)),), BEGIN),), {3, 9}),
        ((Call("other", (Get("i64", HERE),), (), (), ()),), {3}),
    ],
    ids=str,
)
def test_lanes_that_are_named(body, lanes):
    assert named_lanes(routine(*body)) == lanes


def test_a_contract_names_lanes():
    claim = Compare("ge", Capacity(7), index(0))
    assert named_lanes(routine(requires=(claim,))) == named_lanes(routine(ensures=(claim,))) == {7}


def test_routines_that_are_called():
    inside = If(TRUE, (Call("a", (), (), (), ()),), (Call("b", (), (), (), ()), Call("a", (), (), (), ())))
    assert called_routines((Call("b", (), (), (), ()), inside)) == ("b", "a")
    assert called_routines((Return(BEGIN),)) == ()


def noting(lane):
    """A routine that needs eight bytes in the rows of a lane."""
    return routine(SetField(Place(lane, index(0)), index(1)), requires=(Compare("ge", Capacity(lane), index(1)),))


def calling(one, strides):
    room = Expect(Compare("ge", Capacity(len(strides) - 1), index(1)), FAILED)
    return replace(kernel((room, Call(one.name, (), (), (), ()), Return(END)), strides=strides, sites=2), routines=(one,))


def test_a_proof_holds_for_other_lanes_that_are_not_named():
    proof._prove_routine.cache_clear()
    for strides in ((16, 24, 8), (32, 40, 8), (8, 8, 8)):
        verify(calling(noting(2), strides))
    assert proof._prove_routine.cache_info().misses == 1


def test_a_proof_does_not_hold_for_other_strides_of_lanes_that_are_named():
    verify(calling(noting(1), (16, 8)))
    with pytest.raises(VerificationError, match="routine one"):
        verify(calling(noting(1), (16, 4)))
    with pytest.raises(VerificationError):
        verify(calling(noting(1), (16,)))


def test_a_proof_does_not_hold_for_other_promises_of_what_is_called():
    """The routine that is called has the same name."""
    asked = Local("i64", "found")
    there = Routine("there", (), (asked,), (Let("found", index(3)),), (), (Compare("ge", asked, index(3)),), SITES)
    silent = replace(there, ensures=())
    bound = Local("i64", "bound")
    relying = Routine("relying", (), (bound,), (Call("there", (), (bound,), (), ()),), (), (Compare("ge", bound, index(3)),), SITES)
    body = (Call("relying", (), (Local("i64", "x"),), (), ()), Return(END))
    verify(replace(kernel(body, strides=(8,), sites=2), routines=(there, relying)))
    with pytest.raises(VerificationError, match="routine relying"):
        verify(replace(kernel(body, strides=(8,), sites=2), routines=(silent, relying)))


def test_what_is_called_may_name_lanes_that_its_caller_does_not():
    room = Compare("ge", Capacity(1), index(1))
    inner = routine(Expect(room, FAILED), ensures=(room,), name="inner")
    outer = Routine("outer", (), (), (Call("inner", (), (), (1,), ()),), (), (), SITES)
    body = (Call("outer", (), (), (1,), ()), Return(END))
    two = (*SITES, Site("truncated", "", ""))
    verify(replace(kernel(body, strides=(8, 8), sites=2), routines=(replace(inner, sites=two), replace(outer, sites=two))))
