"""Calls of the host in kernels: what must be proven of them, and that every backend runs them alike."""

from __future__ import annotations

import numpy as np
import pytest

from rosetta_jit.backends.python.function import compile_python
from rosetta_jit.kernel import interpret
from rosetta_jit.kernel.host import RefusedError
from rosetta_jit.kernel.ir import Kernel, Site
from rosetta_jit.kernel.nodes import (
    Advance,
    Binary,
    Capacity,
    Compare,
    Expect,
    Extent,
    Failure,
    HostCall,
    HostValue,
    Let,
    Local,
    Place,
    Reserve,
    Return,
    SetField,
    Used,
    Wire,
)
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.kernel.printer import to_text
from rosetta_jit.kernel.proof.verify import VerificationError, verify
from rosetta_jit.kernel.shape import shape_error
from rosetta_jit.kernel.state import CAPACITY, NOW, NUMBER, STRIDE, lane_word, state_words
from rosetta_jit.kernel.terms import BEGIN, END, ROW, index

FOUND = Local("i64", "found")
FAILED = Failure(1, BEGIN)
MESSAGE = Extent(Wire(BEGIN), Binary("sub", END, BEGIN))


def kernel(*body):
    sites = Site("grow", "", ""), Site("rejected", ".a", "no")
    fits = Expect(Compare("lt", ROW, Capacity(0)), FAILED)
    return Kernel("k", "decode", (16, 1), ((fits, *body, Return(END)),), sites)


REVERSED = kernel(
    Reserve(1, MESSAGE.size),
    Let("start", Used(1)),
    Advance(1, MESSAGE.size),
    HostCall("reverse", (index(3), HostValue("number")), FOUND, FAILED, (MESSAGE,), Extent(Place(1, Local("i64", "start")), MESSAGE.size)),
    SetField(Place(0, ROW), Binary("max", FOUND, index(0))),
    SetField(Place(0, ROW, 8), HostValue("now")),
)


def reverse(number, count, data, target):
    if not len(data):
        raise RefusedError
    target[:] = bytes(data)[::-1]
    return number + count


@pytest.mark.parametrize("changed", [lambda same: same, passes.run])
@pytest.mark.parametrize("run", [interpret.run, None])
def test_python_backends(changed, run):
    made = changed(REVERSED)
    verify(made)
    functions = {"reverse": reverse}
    state = np.zeros(state_words(2), np.int64)
    lanes = [np.zeros(32, np.uint8), np.zeros(8, np.uint8)]
    state[lane_word(0, CAPACITY)], state[lane_word(1, CAPACITY)], state[NOW], state[NUMBER] = 2, 8, 5, 7
    state[lane_word(0, STRIDE)], state[lane_word(1, STRIDE)] = 16, 1

    def ran(message, row):
        if run is None:
            return compile_python(made, functions)(message, 0, len(message), state, lanes, row)
        return run(made, message, 0, len(message), state, lanes, row, functions=functions)

    assert ran(b"abc", 1) == 3
    assert lanes[0].view(np.int64).tolist() == [0, 0, 3 + 7 + 1, 5]
    assert bytes(lanes[1][:3]) == b"cba"
    assert ran(b"", 0) == -2


def test_its_text():
    text = to_text(REVERSED)
    assert "let found = host reverse(3, number, [begin] (end - begin)) into lane 1[start].0 (end - begin) else 1 @ begin" in text


@pytest.mark.parametrize(
    ("call", "why"),
    [
        (HostCall("f", (), FOUND, FAILED, (Extent(Wire(BEGIN), index(1)),)), "beyond the end"),
        (HostCall("f", (), FOUND, FAILED, (), Extent(Place(1, Used(1)), index(1))), "outside the lane"),
        (HostCall("f", (), FOUND, FAILED, (Extent(Wire(BEGIN), index(-1)),)), "negative"),
        (HostCall("f", (), FOUND, FAILED, (MESSAGE,), MESSAGE), "fills what it reads"),
        (HostCall("f", (Local("i64", "no"),), FOUND, FAILED), "not visible"),
    ],
)
def test_what_cannot_be_proven(call, why):
    with pytest.raises(VerificationError, match=why):
        verify(kernel(call))


def test_nothing_is_known_of_a_result():
    call = HostCall("f", (), FOUND, FAILED)
    with pytest.raises(VerificationError, match="negative"):
        verify(kernel(call, SetField(Place(1, FOUND), index(0))))
    with pytest.raises(VerificationError, match="wrap"):
        verify(kernel(call, Let("more", Binary("add", FOUND, index(1)))))
    verify(kernel(Let("none", Binary("sub", HostValue("now"), HostValue("now")))))
    assert shape_error(kernel(call, call)) == "found is bound twice"
    assert shape_error(kernel(HostCall("f", (), FOUND, Failure(9, BEGIN)))) == "no site 9"
