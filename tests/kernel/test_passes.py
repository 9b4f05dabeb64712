"""What a kernel does is the same after each pass, for whole, damaged and cut messages; and what the passes are for, they do."""

from __future__ import annotations

import struct
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rosetta_jit.kernel.ir import Routine
from rosetta_jit.kernel.nodes import (
    Advance,
    Assign,
    Binary,
    Compare,
    Const,
    Copy,
    Expect,
    Fill,
    For,
    Get,
    If,
    IsText,
    Let,
    Load,
    Local,
    Place,
    Register,
    Require,
    Reserve,
    Return,
    SetField,
    Store,
    Used,
    Var,
    Wire,
)
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.kernel.passes.collect import collect
from rosetta_jit.kernel.passes.drop import drop
from rosetta_jit.kernel.passes.gather import gather
from rosetta_jit.kernel.passes.hoist import hoist
from rosetta_jit.kernel.passes.join import join
from rosetta_jit.kernel.passes.merge import merge
from rosetta_jit.kernel.passes.seldom_needed import forget
from rosetta_jit.kernel.passes.simplify import simplify
from rosetta_jit.kernel.passes.unroll import unroll
from rosetta_jit.kernel.printer import to_text
from rosetta_jit.kernel.proof.verify import verify
from rosetta_jit.kernel.terms import BEGIN, ROW, add, index, mul
from rosetta_jit.kernel.walk import statements
from tests.golden import GOLDEN, check_golden
from tests.kernel import kernels
from tests.kernel.kernels import ROW_EXISTS, compare, expect, i64, kernel, need
from tests.kernel.pass_kernels import PASSED
from tests.kernel.random_kernels import random_kernel


def stages(original):
    """The kernel after each pass, each proven."""
    current = original
    for transform in passes.PASSES:
        current = transform(current)
        verify(current)
        yield current


STAGES = {name: tuple(stages(original)) for name, original in kernels.ALL.items()}

GOOD = {
    "tagged_doubles": [struct.pack("<idid", 10, 1.0, 10, 2.0) + struct.pack("<id", 10, -3.5)],
    "counted_list": [struct.pack("<i3q", 3, 1, 2, 3), struct.pack("<i", 0)],
    "strings": [struct.pack("<ii3si", 2, 3, b"abc", 0), struct.pack("<i", -5)],
    "varints": [bytes([1, 0x80, 1, 5]), b""],
    "image": [struct.pack("<3i", 3, 2, 1) + bytes(range(8)), struct.pack("<3i", 4, 2, 0) + bytes(range(8)), struct.pack("<3i", 0, 9, 0)],
    "choice": [b"\x01\x05\x09", b"\x08" + bytes(8)],
    "encode_list": [bytes(40)],
    "attempts": [b"\x04\x01\x02\x03\x04"],
}


def same(name, message, **options):
    expected = kernels.outcome(kernels.ALL[name], message, **options)
    for transform, stage in zip(passes.PASSES, STAGES[name], strict=True):
        assert kernels.outcome(stage, message, **options) == expected, transform.__name__


@pytest.mark.parametrize("name", kernels.ALL)
def test_good_and_cut_messages(name):
    for message in GOOD[name]:
        for length in range(len(message) + 1):
            for rows in (1, 3, 64):
                same(name, message[:length], rows=rows)
        same(name, b"\xff" * 5 + message, begin=5)


@pytest.mark.parametrize("name", kernels.ALL)
@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_damaged_messages(name, data):
    message = bytearray(data.draw(st.sampled_from(GOOD[name])))
    for _ in range(data.draw(st.integers(0, 3))):
        if message:
            message[data.draw(st.integers(0, len(message) - 1))] = data.draw(st.sampled_from([0, 1, 2, 3, 10, 127, 128, 255]))
    seed = struct.pack("<2q", *data.draw(st.tuples(st.integers(-1, 4), st.integers(-1, 4))))
    same(name, bytes(message), rows=data.draw(st.sampled_from([1, 8, 64])), seed=seed)


# --- random kernels ---


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10**9), message=st.binary(max_size=80), rows=st.sampled_from([1, 64]))
def test_random_kernels(seed, message, rows):
    original = random_kernel(seed)
    verify(original)
    expected = kernels.outcome(original, message, rows=rows)
    for transform, stage in zip(passes.PASSES, stages(original), strict=True):
        assert kernels.outcome(stage, message, rows=rows) == expected, transform.__name__
    assert kernels.outcome(passes.run(original), message, rows=rows) == expected


# --- what the passes are for ---


@pytest.mark.parametrize("name", kernels.ALL)
def test_text_after_all_passes(name):
    check_golden(GOLDEN / "kernel" / f"{name}_optimised.txt", to_text(passes.run(kernels.ALL[name])))


def checks(kernel, kind):
    return [stmt for body in kernel.bodies for stmt, _ in statements(body) if isinstance(stmt, kind)]


def test_a_struct_is_required_once():
    merged = merge(kernels.tagged_doubles(16))
    (only,) = checks(merged, Require)
    assert (only.at, only.size) == (BEGIN, index(192))
    parts = merged.sites[only.failure.site].parts
    assert [(part.offset, part.size) for part in parts] == [(o + d, s) for o in range(0, 192, 12) for d, s in ((0, 4), (4, 8))]


def test_attempts_stay_behind_what_tells_them_apart():
    merged = merge(kernels.ALL["attempts"])
    first = [stmt for stmt in merged.bodies[0] if isinstance(stmt, Require)]
    assert [stmt.size for stmt in first] == [index(4), index(32)]


def test_a_loop_checks_before_its_first_round():
    hoisted = drop(hoist(drop(simplify(kernels.counted_list()))))
    (loop,) = checks(hoisted, For)
    assert not any(isinstance(stmt, Require | Expect) for stmt in loop.body)
    sites = [hoisted.sites[stmt.failure.site] for stmt in checks(hoisted, Require)]
    assert [(part.path, part.size, part.step) for site in sites for part in site.parts] == [(".a[{}]", 8, 8)]


def test_a_return_is_not_crossed():
    early = If(compare("eq", Local("i64", "n"), 0), (Return(BEGIN),))
    body = (need(BEGIN, 8), Let("n", Load("i64", BEGIN)), early, need(add(BEGIN, 8), 8), Return(BEGIN))
    assert len(checks(merge(kernel(body)), Require)) == 2


def test_short_loops_are_unrolled():
    loop = For("i", index(3), (SetField(Place(0, ROW, 0), i64("i")),))
    unrolled = simplify(unroll(kernel((ROW_EXISTS, loop, Return(BEGIN)))))
    assert [stmt.value for stmt in checks(unrolled, SetField)] == [index(0), index(1), index(2)]


def test_a_loop_whose_values_nobody_reads_goes():
    """In one pass: passes that change nothing afterwards do not make it run again."""
    loop = For("i", i64("n"), (Let("read", Load("u8", BEGIN)), Let("twice", add(Local("u8", "read"), index(1)))))
    assert not checks(simplify(kernel((need(BEGIN, 8), Let("n", Load("i64", BEGIN)), loop, Return(BEGIN)))), For)


def test_the_same_value_is_computed_once():
    n = i64("n")
    body = (need(BEGIN, 4), Let("n", kernels.Convert("i64", Load("i32", BEGIN))), Let("a", mul(n, 12)), Let("b", mul(n, 12)))
    after = simplify(kernel((*body, SetField(Place(0, ROW), i64("a")), SetField(Place(0, ROW), i64("b")), Return(BEGIN))))
    assert [stmt.name for stmt in checks(after, Let)] == ["n", "a"]


# --- fields side by side become one move ---


def fields(*places):
    """A row is emptied, and set from the message: `places` are offset in the row, type, offset in the message, byte order."""
    moves = (SetField(Place(0, ROW, offset), Load(type_, add(BEGIN, at), order)) for offset, type_, at, order in places)
    return kernel((ROW_EXISTS, need(BEGIN, 24), Fill(Place(0, ROW), index(24)), *moves, Return(BEGIN)), strides=(24,))


def copies(joined):
    return [(stmt.target, stmt.source, stmt.size) for stmt in checks(joined, Copy)]


def test_a_row_that_lies_in_the_message_is_one_move_and_is_not_emptied():
    joined = join(fields((0, "u32", 0, "<"), (4, "u32", 4, "<"), (8, "f64", 8, "<"), (16, "u8", 16, ">"), (17, "u8", 17, "<")))
    assert copies(joined) == [(Place(0, ROW), Wire(BEGIN), index(18))]
    assert len(checks(joined, Fill)) == 1, "six bytes of the row are not set"
    whole = join(fields(*((8 * number, "f64", 8 * number, "<") for number in range(3))))
    assert copies(whole) == [(Place(0, ROW), Wire(BEGIN), index(24))]
    assert not checks(whole, Fill)
    verify(whole)


@pytest.mark.parametrize(
    "second", [(8, "f64", 8, ">"), (16, "f64", 8, "<"), (8, "f64", 16, "<"), (8, "bool", 8, "<")], ids=["order", "gap", "wire", "bool"]
)
def test_what_lies_otherwise_is_moved_alone(second):
    assert not copies(join(fields((0, "f64", 0, "<"), second)))


def test_fields_are_written_by_one_move():
    writes = (Store(add(BEGIN, 4 * number), Get("f32", Place(0, ROW, 4 * number))) for number in range(3))
    joined = join(kernel((ROW_EXISTS, need(BEGIN, 12), *writes, Return(BEGIN)), direction="encode", strides=(24,)))
    assert copies(joined) == [(Wire(BEGIN), Place(0, ROW), index(12))]
    verify(joined)


def test_what_hidden_lanes_hold_and_nobody_reads_is_forgotten():
    left = forget(PASSED["bytes and a field that are left and never read"])
    assert not checks(left, Copy)
    assert [stmt.place for stmt in checks(left, SetField)] == [Place(1, Local("i64", "start_1"), 8), Place(0, ROW)]
    assert [stmt.lane for stmt in checks(left, Reserve)] == [1, 2], "start_2 asks for how many rows there are"
    again = forget(simplify(left))
    assert [stmt.lane for stmt in checks(again, Reserve)] == [1]
    verify(again)


@pytest.mark.parametrize("name", ["the same in lanes of the holder", "bytes that are looked at as a text, as a number, and copied"])
def test_what_is_the_holders_or_is_read_stays(name):
    assert forget(PASSED[name]) is PASSED[name]


def test_what_a_report_shows_stays():
    kernel = PASSED["bytes and a field that are left and never read"]
    shown = replace(kernel.sites[3], detail_lane=2)
    assert checks(forget(replace(kernel, sites=(*kernel.sites[:3], shown, *kernel.sites[4:]))), Copy)


def test_what_a_routine_reads_stays():
    kernel = PASSED["bytes and a field that are left and never read"]
    body = (expect(IsText(Place(2, BEGIN), index(1)), 1),)
    reader = Routine("reader", (), (), body, (), (), (kernel.sites[0], kernel.sites[1]))
    assert checks(forget(replace(kernel, routines=(reader,))), Copy)


def test_a_row_is_emptied_where_it_is_read_before_it_is_set():
    body = (
        *(ROW_EXISTS, need(BEGIN, 24), Fill(Place(0, ROW), index(24))),
        SetField(Place(0, ROW, 8), Get("f64", Place(0, ROW))),
        *(SetField(Place(0, ROW, 8 * number), Load("f64", add(BEGIN, 8 * number))) for number in range(3)),
    )
    assert len(checks(join(kernel((*body, Return(BEGIN)), strides=(24,))), Fill)) == 1


def test_a_row_is_not_emptied_where_the_message_alone_is_looked_at_before_it_is_set():
    """What is between may check the message, and keep a value for a register; a row that is read is emptied."""

    def run(seen):
        between = (expect(Compare("eq", seen, index(1)), 1), Var("kept", Register(0)), Assign("kept", seen))
        sets = (SetField(Place(0, ROW, 8 * number), Load("f64", add(BEGIN, 8 * number))) for number in range(3))
        body = (ROW_EXISTS, need(BEGIN, 24), Fill(Place(0, ROW), index(24)), *between, *sets)
        return replace(kernel((*body, Return(BEGIN, ((0, i64("kept")),))), strides=(24,)), registers=1)

    of_message, of_row = join(run(Load("i64", BEGIN))), join(run(Get("i64", Place(0, ROW))))
    assert not checks(of_message, Fill)
    assert len(checks(of_row, Fill)) == 1
    verify(of_message)


def test_a_long_run_is_cut_for_processors_and_a_vast_one_is_one_loop():
    def run(count):
        moves = (SetField(Place(0, ROW, 8 * number), Load("f64", add(BEGIN, 8 * number))) for number in range(count))
        return kernel((ROW_EXISTS, need(BEGIN, 8 * count), *moves, Return(BEGIN)), strides=(8 * count,))

    assert [int(size.value) for _, _, size in copies(join(run(37)))] == [128, 128, 40]
    assert [int(size.value) for _, _, size in copies(join(run(1000)))] == [8000]


def test_what_a_size_kernel_leaves_is_not_forgotten():
    """The encoder runs on the same lanes, and reads the lengths there."""
    taken = (ROW_EXISTS, Reserve(2, index(1)), Let("first", Used(2)), Advance(2, index(1)))
    body = (*taken, SetField(Place(2, i64("first")), index(5)), Return(BEGIN))
    sizes, encoder = (replace(kernel(body, strides=(64, 8, 16), direction=direction), hidden=1) for direction in ("size", "encode"))
    assert forget(sizes) is sizes
    assert not any(isinstance(stmt, SetField) for stmt in forget(encoder).bodies[0])


# --- bits that are set one after another ---


def bit(number, offset=0, row=ROW):
    place = Place(0, row, offset)
    return SetField(place, Binary("or", Get("u64", place), Const("u64", 1 << number)))


EMPTIED = Fill(Place(0, ROW), index(16))
A_CHECK = expect(Compare("eq", Load("u8", BEGIN), Const("u8", 1)))


def collected(*body):
    made = collect(kernel((ROW_EXISTS, need(BEGIN, 8), *body, Return(BEGIN)), strides=(16,)))
    verify(made)
    return [stmt.value for stmt in checks(made, SetField)]


def test_bits_of_an_emptied_row_are_written_once():
    assert collected(EMPTIED, bit(0), A_CHECK, bit(1), SetField(Place(0, ROW, 8), index(5)), bit(5)) == [index(5), Const("u64", 35)]


def test_bits_of_a_row_that_has_others_are_added_at_once():
    assert collected(bit(0), A_CHECK, bit(1)) == [Binary("or", Get("u64", Place(0, ROW)), Const("u64", 3))]


@pytest.mark.parametrize(
    "between",
    [
        Let("seen", Get("u64", Place(0, ROW))),
        Let("seen", Get("u8", Place(0, ROW, 7))),
        SetField(Place(0, ROW, 4), index(1)),
        SetField(Place(0, i64("other")), index(1)),
        Copy(Place(0, ROW), Wire(BEGIN), index(8)),
        Copy(Place(0, i64("other"), 8), Place(0, ROW), index(8)),
        Fill(Place(0, i64("other")), index(16)),
        If(compare("gt", i64("other"), 0), (bit(7),)),
        If(compare("gt", i64("other"), 0), (Return(BEGIN),)),
        expect(IsText(Place(0, ROW), index(4))),
    ],
    ids=lambda stmt: type(stmt).__name__,
)
def test_bits_that_somebody_may_see_or_write_between_stay(between):
    body = (EMPTIED, bit(0), between, bit(1))
    found = checks(collect(kernel((ROW_EXISTS, *body, Return(BEGIN)), strides=(16,))), SetField)
    assert found[0].value == Const("u64", 1)
    assert found[-1].value == Binary("or", Get("u64", Place(0, ROW)), Const("u64", 2))


def test_bits_of_a_row_whose_number_changes_stay():
    step = Assign("at", add(i64("at"), 1))
    body = (Var("at", ROW), bit(0, row=i64("at")), step, bit(1, row=i64("at")))
    assert len(checks(collect(kernel((*body, Return(BEGIN)), strides=(16,))), SetField)) == 2


# --- checks that become one ---


def word(at, value, order="<"):
    return expect(Compare("eq", Load("i32", at, order), Const("i32", value)), 2, at)


def element(number, count="count", at=None):
    return expect(Compare("lt", index(number), i64(count)), 4, at or add(BEGIN, 8 * number), index(number))


def gathered(*body):
    start = (ROW_EXISTS, need(BEGIN, 16), Let("count", Get("i64", Place(0, ROW))))
    made = gather(kernel((*start, *body, Return(BEGIN)), strides=(16,)))
    verify(made)
    return [stmt for stmt in made.bodies[0] if stmt not in start][:-1]


def test_two_words_of_a_message_are_compared_at_once():
    first, second, third = (word(add(BEGIN, 4 * number), -1 - number) for number in range(3))
    both, alone = gathered(first, second, third)
    assert both.condition.operand == Compare("eq", Load("u64", BEGIN), Const("u64", 0xFFFF_FFFE_FFFF_FFFF))
    assert (both.then, alone) == ((first, second), third)


@pytest.mark.parametrize("second", [word(add(BEGIN, 8), 1), word(add(BEGIN, 4), 1, ">"), word(BEGIN, 1)])
def test_words_that_lie_otherwise_are_compared_alone(second):
    assert gathered(word(BEGIN, 1), second) == [word(BEGIN, 1), second]


def test_the_last_element_is_asked_for_first():
    sets = [SetField(Place(0, ROW, 8), index(number)) for number in range(3)]
    looked, *rest = gathered(*(each for number in range(3) for each in (element(number), sets[number])))
    assert looked.condition.operand == element(2).condition
    assert (looked.then, rest) == ((element(0), element(1), element(2)), sets)


@pytest.mark.parametrize(
    "between",
    [
        need(BEGIN, 12),
        A_CHECK,
        If(compare("gt", i64("count"), 9), (Return(BEGIN),)),
        Reserve(0, index(1)),
        element(7, at=Get("i64", Place(0, ROW))),
    ],
    ids=lambda stmt: type(stmt).__name__,
)
def test_nothing_that_may_fail_or_end_is_crossed(between):
    body = (element(0), element(1), between, element(2))
    assert gathered(*body) == list(body)


def test_elements_of_different_lists_are_asked_for_alone():
    other = Let("other", Get("i64", Place(0, ROW, 8)))
    body = (other, element(0), element(0, "other"), element(1), element(1, "other"), element(2))
    assert gathered(*body) == list(body)


def test_a_check_stays_behind_what_its_failure_shows():
    known = Let("at", Load("i64", BEGIN))
    body = (element(0), element(1), known, element(2, at=i64("at")))
    assert gathered(*body) == list(body)
