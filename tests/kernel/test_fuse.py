"""Loops that go through the same memory become one, where a round of each after the other does what all rounds of each did."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rosetta_jit.kernel.limits import MAX_STREAMS
from rosetta_jit.kernel.nodes import (
    Advance,
    Assign,
    Binary,
    Convert,
    Copy,
    Fill,
    For,
    Get,
    If,
    Let,
    Load,
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
from rosetta_jit.kernel.passes.seldom_needed import fuse
from rosetta_jit.kernel.proof.verify import verify
from rosetta_jit.kernel.terms import BEGIN, ROW, add, index, mul
from rosetta_jit.kernel.walk import flat
from tests.kernel.kernels import ROW_EXISTS, compare, expect, i64, kernel, need, outcome

COUNT = 6
N = index(COUNT)
STRIDES = (64, 1, 8, 8)
NEEDED = need(BEGIN, 256)
ROWS = tuple(
    stmt
    for lane in (1, 2, 3)
    for stmt in (Reserve(lane, index(2 * COUNT)), Let(f"start_{lane}", Used(lane)), Advance(lane, index(2 * COUNT)))
)
SUM = Var("sum", index(0))
END = (SetField(Place(0, ROW, 0), i64("sum")), Return(BEGIN))


def row(lane, number="i", further=0):
    return Place(lane, Binary("add", add(i64(f"start_{lane}"), further), i64(number)))


def at(number="i", step=8, offset=0):
    return Binary("add", add(BEGIN, offset), mul(i64(number), step))


def added(value, name="sum"):
    return Assign(name, Binary("xor", i64(name), Convert("i64", value)))


def decoder(*stmts):
    return kernel((ROW_EXISTS, NEEDED, *ROWS, SUM, *stmts, *END), strides=STRIDES)


def loops(made):
    return [stmt for stmt in flat(made.bodies[0]) if isinstance(stmt, For)]


def moves(made):
    return [stmt for stmt in flat(made.bodies[0]) if isinstance(stmt, Copy)]


def same(before, after):
    verify(before)
    verify(after)
    message = Random(1).randbytes(300)
    for length in (0, 40, 255, 256, 300):
        assert outcome(after, message[:length]) == outcome(before, message[:length])


COPIED = Copy(Place(1, i64("start_1")), Wire(add(BEGIN, 3)), N)
SUMMED = For("i", N, (added(Load("u8", Binary("add", add(BEGIN, 3), i64("i")))),))
FIRST = For("i", N, (SetField(row(2), Load("i64", at())),))
SECOND = For("k", N, (SetField(row(3, "k"), Load("i64", at("k"))),))


JOINED = {
    "a copy, and a loop that reads its source": (COPIED, SUMMED),
    "a copy, and a loop that reads its target": (COPIED, For("i", N, (added(Get("u8", row(1))),))),
    "a copy where there is something": (If(compare("gt", N, 0), (COPIED,)), SUMMED),
    "two that read the same": (FIRST, SECOND),
    "fields side by side": (
        For("i", N, (SetField(row(2), Load("i64", at(step=16))),)),
        For("k", N, (SetField(row(3, "k"), Load("i64", at("k", 16, 8))),)),
    ),
    "with something else between them": (FIRST, Let("x", Load("u8", BEGIN)), Var("y", i64("sum")), SetField(Place(0, ROW, 8), N), SECOND),
    "a row that the one fills and the other reads": (FIRST, For("k", N, (SetField(row(3, "k"), Get("i64", row(2, "k"))),))),
    "three": (FIRST, SECOND, For("m", N, (added(Load("i64", at("m"))),))),
}


@pytest.mark.parametrize("name", JOINED)
def test_loops_become_one(name):
    made = decoder(*JOINED[name])
    fused = fuse(made)
    assert len(loops(fused)) == 1
    assert not moves(fused)
    same(made, fused)


def test_arrays_of_a_loop_are_no_more_than_a_cache_has_room_for():
    """Where all begin at the same place of a page, each further one would throw out the one before."""
    every = range(MAX_STREAMS + 2)
    copies = tuple(For(f"i{k}", N, (SetField(row(2, f"i{k}"), Load("u8", at(f"i{k}"))),)) for k in every)
    lanes = tuple(
        replace(each, body=(replace(each.body[0], place=replace(each.body[0].place, lane=k + 1)),)) for k, each in enumerate(copies)
    )
    made = replace(kernel(lanes), strides=(64, *[8 for _ in every]))
    assert [len(loop.body) for loop in loops(fuse(made))] == [MAX_STREAMS - 1, len(every) - MAX_STREAMS + 1]


APART = {
    "another count": (FIRST, For("k", index(COUNT - 1), SECOND.body)),
    "other memory": (FIRST, For("k", N, (SetField(row(3, "k"), Load("i64", at("k", 8, 64))),))),
    "a row that the one fills and the other reads later": (FIRST, For("k", N, (SetField(row(3, "k"), Get("i64", row(2, "k", 1))),))),
    "a row that the one reads and the other fills later": (
        For("k", N, (SetField(row(3, "k"), Get("i64", row(2, "k", 1))),)),
        For("i", N, (SetField(row(2), Load("i64", at())), added(Get("i64", row(3))))),
    ),
    "a sum that the other one reads": (
        For("i", N, (added(Load("i64", at())),)),
        For("k", N, (SetField(row(3, "k"), Binary("xor", Load("i64", at("k")), i64("sum"))),)),
    ),
    "a sum that is read between them": (For("i", N, (added(Load("i64", at())),)), Let("x", i64("sum")), SECOND),
    "a row that is read between them": (FIRST, Let("x", Get("i64", Place(2, i64("start_2")))), SECOND),
    "a row that is set between them": (FIRST, SetField(Place(2, i64("start_2")), index(7)), SECOND),
    "rows that are emptied between them": (FIRST, Fill(Place(2, i64("start_2")), index(8)), SECOND),
    "a check in one of them": (FIRST, For("k", N, (expect(compare("ne", Load("i64", at("k")), 0)), *SECOND.body))),
    "another loop between them": (FIRST, For("m", index(2), (SetField(Place(0, ROW, 8), i64("m")),)), SECOND),
    "places that are read from a row": (
        FIRST,
        For("k", N, (added(Load("u8", Binary("add", BEGIN, Convert("i64", Load("u8", at("k")))))),)),
    ),
    "a copy of other bytes": (COPIED, For("i", N, (added(Load("u8", Binary("add", add(BEGIN, 4), i64("i")))),))),
    "a copy of fewer bytes": (Copy(COPIED.target, COPIED.source, index(COUNT - 1)), SUMMED),
    "a copy in other steps": (COPIED, For("i", N, (added(Load("u8", at(step=2, offset=3))),))),
    "a copy onto what is read later": (
        Copy(Place(1, add(i64("start_1"), 1)), Wire(BEGIN), N),
        For("i", N, (added(Get("u8", row(1))), added(Load("u8", Binary("add", BEGIN, i64("i")))))),
    ),
}


@pytest.mark.parametrize("name", APART)
def test_others_stay(name):
    made = decoder(*APART[name])
    assert fuse(made) is made


def encoder(first, second, *, gap, step=8):
    """Two arrays of as many numbers in a message: where the second begins depends on where the first ends, and on a gap."""
    n = i64("n")
    body = (
        ROW_EXISTS,
        Let("n", Convert("i64", Get("u8", Place(0, ROW, 32)))),
        expect(compare("le", n, Used(2))),
        expect(compare("le", n, Used(3))),
        Let("gap", gap),
        need(BEGIN, 256),
        Let("there", Binary("add", Binary("add", add(BEGIN, 4), mul(n, step)), i64("gap"))),
        Require(i64("there"), mul(n, 8), need(BEGIN, 1).failure),
        Require(add(BEGIN, 4), mul(n, 8), need(BEGIN, 1).failure),
        For("i", n, (Store(Binary("add", i64("there"), mul(i64("i"), 8)), first),)),
        For("k", n, (Store(Binary("add", add(BEGIN, 4), mul(i64("k"), step)), second),)),
        Return(BEGIN),
    )
    return kernel(body, strides=STRIDES, direction="encode")


def read(name):
    return Binary("xor", Get("i64", Place(2, i64(name))), Get("i64", Place(3, i64(name))))


GAP = Select(compare("gt", i64("n"), 0), Binary("and", Get("i64", Place(0, ROW, 8)), index(7)), index(0))


@pytest.mark.parametrize(
    "gap", [index(0), index(4), Binary("and", i64("n"), index(7)), Select(compare("gt", i64("n"), 0), index(4), index(0))]
)
def test_arrays_behind_each_other_are_written_at_once(gap):
    made = encoder(read("i"), read("k"), gap=gap)
    fused = fuse(made)
    assert len(loops(fused)) == 1
    same(made, fused)
    for n in range(4):
        seed = bytes(32) + bytes([n]) + bytes(31)
        assert outcome(fused, bytes(300), seed=seed) == outcome(made, bytes(300), seed=seed)


@pytest.mark.parametrize("gap", [index(-4), Get("i64", Place(0, ROW, 8)), Select(compare("gt", i64("n"), 0), index(-1), index(0))])
def test_arrays_that_may_overlap_are_not(gap):
    made = encoder(read("i"), read("k"), gap=gap)
    assert len(loops(fuse(made))) == 2


def test_numbers_that_overlap_themselves_reach_further():
    assert len(loops(fuse(encoder(read("i"), read("k"), gap=index(0), step=4)))) == 2


@settings(max_examples=200, deadline=None)
@given(seed=st.integers(0, 10**9), message=st.binary(min_size=256, max_size=256))
def test_random_loops_do_the_same(seed, message):
    random = Random(seed)  # no secret depends on it
    made = decoder(*(stmt for number in range(random.randint(2, 5)) for stmt in _random_part(random, number)))
    verify(made)
    fused = fuse(made)
    verify(fused)
    assert outcome(fused, message) == outcome(made, message)


def _random_part(random, number):
    """A loop or a copy, and perhaps something behind it."""
    name = f"i{number}"
    body = tuple(_random_round(random, name) for _ in range(random.randint(1, 2)))
    copy = Copy(Place(1, add(i64("start_1"), random.choice([0, 1]))), Wire(add(BEGIN, random.choice([0, 1]))), N)
    yield random.choice([For(name, N, body), For(name, N, body), copy])
    if random.random() < 0.3:
        lane = random.choice([2, 3])
        place = Place(lane, add(i64(f"start_{lane}"), random.choice([0, 1])))
        yield random.choice([SetField(place, index(number)), Let(f"x{number}", Get("i64", place)), Let(f"y{number}", i64("sum"))])


def _random_round(random, name):
    lane, further = random.choice([1, 2, 3]), random.choice([0, 0, 0, 1])
    type_ = "u8" if lane == 1 else "i64"
    from_lane = Get(type_, row(lane, name, random.choice([0, 0, 1])))
    step = random.choice([1, 8, 16]) if type_ == "u8" else random.choice([8, 16])
    value = random.choice([Load(type_, at(name, step, random.choice([0, 1, 8]))), from_lane])
    return random.choice([SetField(row(lane, name, further), value), SetField(row(lane, name, further), value), added(value)])
