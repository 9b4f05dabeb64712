"""What is computed for stores side by side is computed in vectors, and to the same bits as one number at a time."""

from __future__ import annotations

import math
import re
import struct
from dataclasses import replace

import pytest
from llvmlite import ir

from rosetta_jit.backends.llvm import function as llvm
from rosetta_jit.kernel.ir import Routine
from rosetta_jit.kernel.nodes import (
    Advance,
    Assign,
    Binary,
    Call,
    Compare,
    Const,
    Convert,
    Expect,
    Get,
    Let,
    Load,
    Local,
    Place,
    Require,
    Reserve,
    Return,
    SetField,
    Unary,
    Used,
    Var,
)
from rosetta_jit.kernel.nodes import Store as StoreIn
from rosetta_jit.kernel.terms import BEGIN, ROW, add, index
from tests.backends.engines import ENGINES, outcome
from tests.backends.holders import rows
from tests.backends.kernels import failure, kernel, row_fits

NUMBERS = (
    0.0,
    -0.0,
    1.5,
    -2.25,
    1e300,
    -1e300,
    1e-320,
    math.inf,
    -math.inf,
    math.nan,
    3.0e38,
    4.0e38,
    123456789.125,
    -7.0,
    0.1,
    1e-46,
    2.0,
    9.0,
)
"""Usual ones, and those at which conversions and products end."""

HALF = Const("f64", 0.5)


def local(type_, name):
    return Local(type_, name)


def decoder(count, value, *, between=(), stride=8, order="<"):
    """A kernel that stores ``value`` of each number of a message in a row of its own; ``between`` stand other statements."""
    loads = [Let(f"n{at}", Load("f64", add(BEGIN, index(8 * at)), order)) for at in range(count)]
    stores = [SetField(Place(1, add(local("i64", "start"), index(at))), value(local("f64", f"n{at}"), at)) for at in range(count)]
    body = (
        row_fits(),
        Require(BEGIN, index(8 * count), failure(0)),
        *loads,
        *between,
        Reserve(1, index(count)),
        Let("start", Const("i64", 0)),
        Advance(1, index(count)),
        *stores,
        Return(add(BEGIN, index(8 * count))),
    )
    return kernel(body, strides=(8, stride))


def single(number, _):
    return Convert("f32", Binary("mul", number, HALF))


VALUES = {
    "product": (single, 4),
    "another constant each": (lambda number, at: Binary("sub", Binary("add", number, Const("f64", float(at))), Const("f64", 3.0)), 8),
    "quotient": (lambda number, _: Binary("div", number, Const("f64", 3.0)), 8),
    "negative": (lambda number, _: Unary("neg", Unary("abs", Binary("mul", number, HALF))), 8),
    "root": (lambda number, _: Unary("sqrt", Unary("abs", Binary("mul", number, HALF))), 8),
    "square": (lambda number, _: Binary("mul", Binary("mul", number, number), HALF), 8),
    "single and back": (lambda number, _: Convert("f64", Convert("f32", number)), 8),
    "single of a constant": (lambda number, _: Binary("add", Convert("f32", number), Const("f32", 0.1)), 4),
}


def text_of(kernel):
    module = ir.Module()
    llvm.emit(module, kernel, "kernel")
    return str(module)


def sizes(kernel):
    """How many numbers the vectors have that a kernel stores."""
    return [int(size) for size in re.findall(r"store <(\d+) x", text_of(kernel))]


@pytest.mark.parametrize("name", VALUES)
@pytest.mark.parametrize("count", [1, 2, 3, 7, 8, 11, 18])
def test_the_same_bits_as_one_by_one(name, count):
    value, stride = VALUES[name]
    made = decoder(count, value, stride=stride)
    singles = {1: [], 2: [2], 3: [2], 7: [4, 2], 8: [8], 11: [8, 2], 18: [8, 8, 2]}
    doubles = singles | {8: [4, 4], 11: [4, 4, 2], 18: [4, 4, 4, 4, 2]}  # 32 bytes at most
    wanted = (singles if stride == 4 else doubles)[count]
    assert sizes(made) == wanted
    assert text_of(made).count("load double") == count - sum(wanted)
    for shift in range(0, len(NUMBERS), 5):
        numbers = [NUMBERS[(shift + at) % len(NUMBERS)] for at in range(count)]
        for message in (struct.pack(f"<{count}d", *numbers), b"", struct.pack(f"<{count}d", *numbers)[:-1]):
            expected = outcome("interpreter", made, message, rows(made), 3)
            for backend in ENGINES[1:]:
                assert outcome(backend, made, message, rows(made), 3) == expected, (backend, message)


def test_integers_become_floats_together():
    loads = [Let(f"n{at}", Load("i16", add(BEGIN, index(2 * at)))) for at in range(4)]
    stores = [SetField(Place(0, ROW, 8 * at), Binary("mul", Convert("f64", local("i16", f"n{at}")), HALF)) for at in range(4)]
    made = kernel((row_fits(), Require(BEGIN, index(8), failure(0)), *loads, *stores, Return(add(BEGIN, index(8)))), strides=(32,))
    assert sizes(made) == [4]
    message = struct.pack("<4h", -32768, 32767, -1, 0)
    assert outcome("llvm", made, message, rows(made)) == outcome("interpreter", made, message, rows(made))


def test_fields_become_numbers_of_a_message_together():
    reads = [Let(f"n{at}", Get("f32", Place(0, ROW, 4 * at))) for at in range(4)]
    stores = [StoreIn(add(BEGIN, index(8 * at)), Binary("mul", Convert("f64", local("f32", f"n{at}")), HALF)) for at in range(4)]
    pairs = [each for pair in zip(reads, stores, strict=True) for each in pair]
    made = kernel(
        (row_fits(), Require(BEGIN, index(32), failure(0)), *pairs, Return(add(BEGIN, index(32)))), strides=(16,), direction="encode"
    )
    assert sizes(made) == [4]
    holder = rows(made)
    holder.lanes[0][:16] = list(struct.pack("<4f", 1.5, math.nan, -math.inf, 0.1))
    assert outcome("llvm", made, bytes(32), holder.copy()) == outcome("interpreter", made, bytes(32), holder.copy())


NOT_TOGETHER = {
    "in the other byte order": decoder(4, single, stride=4, order=">"),
    "computed differently": decoder(4, lambda number, at: Binary("mul" if at % 2 else "add", number, HALF)),
    "with room between them": decoder(4, single, stride=8),
    "by a function of a library": decoder(4, lambda number, _: Unary("sin", Binary("mul", number, HALF))),
    "the rest of a division": decoder(4, lambda number, _: Binary("rem", number, HALF)),
    "the larger of two": decoder(4, lambda number, _: Binary("max", number, HALF)),
    "only copied": decoder(4, lambda number, at: number if at < 3 else Binary("mul", number, HALF)),
    "what is not known before": decoder(
        4,
        lambda number, _: Binary("mul", number, local("f64", "scale")),
        between=(Var("scale", HALF), Assign("scale", Const("f64", 2.0))),
    ),
}


@pytest.mark.parametrize("name", NOT_TOGETHER)
def test_what_is_stored_one_by_one(name):
    made = NOT_TOGETHER[name]
    assert sizes(made) == []
    message = struct.pack("<4d", *NUMBERS[2:6])
    assert outcome("llvm", made, message, rows(made)) == outcome("interpreter", made, message, rows(made))


def test_what_is_read_where_something_is_written_stays_in_its_place():
    """Each number is the one before it, which was stored just now, and some more."""
    first = SetField(Place(0, ROW, 0), Load("f64", BEGIN))
    following = [
        each
        for at in range(1, 5)
        for each in (
            Let(f"n{at}", Get("f64", Place(0, ROW, 8 * at - 8))),
            SetField(Place(0, ROW, 8 * at), Binary("add", local("f64", f"n{at}"), HALF)),
        )
    ]
    made = kernel((row_fits(), Require(BEGIN, index(8), failure(0)), first, *following, Return(add(BEGIN, index(8)))), strides=(40,))
    assert sizes(made) == []
    message = struct.pack("<d", 1.25)
    result = outcome("llvm", made, message, rows(made))
    assert result == outcome("interpreter", made, message, rows(made))
    assert struct.unpack("<5d", result[2][0][:40]) == (1.25, 1.75, 2.25, 2.75, 3.25)


def test_a_place_that_moves_is_asked_for_where_it_stands():
    """The message is read at a place that changes between the loads and the stores."""
    loads = [Let(f"n{at}", Load("f64", add(local("i64", "pos"), index(8 * at)))) for at in range(4)]
    stores = [SetField(Place(0, ROW, 8 * at), Binary("mul", local("f64", f"n{at}"), HALF)) for at in range(4)]
    moves = (Assign("pos", add(BEGIN, index(8))),)
    made = kernel(
        (row_fits(), Require(BEGIN, index(40), failure(0)), Var("pos", BEGIN), *loads, *moves, *stores, Return(add(BEGIN, index(40)))),
        strides=(32,),
    )
    assert sizes(made) == []
    message = struct.pack("<5d", *NUMBERS[2:7])
    assert outcome("llvm", made, message, rows(made)) == outcome("interpreter", made, message, rows(made))


def test_locals_that_others_ask_for_stay():
    stores = [SetField(Place(0, ROW, 8 * at), Binary("mul", local("f64", f"n{at}"), HALF)) for at in range(2)]
    loads = [Let(f"n{at}", Load("f64", add(BEGIN, index(8 * at)))) for at in range(2)]
    again = SetField(Place(0, ROW, 24), local("f64", "n1"))
    made = kernel((row_fits(), Require(BEGIN, index(16), failure(0)), *loads, *stores, again, Return(add(BEGIN, index(16)))), strides=(32,))
    assert sizes(made) == [2]
    message = struct.pack("<2d", 1.5, 2.5)
    assert outcome("llvm", made, message, rows(made)) == outcome("interpreter", made, message, rows(made))


def test_a_number_that_all_are_computed_with_is_read_once():
    scale = Let("scale", Binary("mul", Load("f64", BEGIN), HALF))
    made = decoder(8, lambda number, _: Convert("f32", Binary("div", number, local("f64", "scale"))), stride=4, between=(scale,))
    assert sizes(made) == [8]
    assert text_of(made).count("load double") == 1
    message = struct.pack("<8d", *NUMBERS[2:10])
    assert outcome("llvm", made, message, rows(made)) == outcome("interpreter", made, message, rows(made))


def test_numbers_of_other_types_are_read_one_by_one():
    """Floats and integers side by side, of the same size, that all become doubles."""
    types = ("f32", "i32", "f32", "i32")
    loads = [Let(f"n{at}", Load(type_, add(BEGIN, index(4 * at)))) for at, type_ in enumerate(types)]
    stores = [SetField(Place(0, ROW, 8 * at), Convert("f64", local(type_, f"n{at}"))) for at, type_ in enumerate(types)]
    made = kernel((row_fits(), Require(BEGIN, index(16), failure(0)), *loads, *stores, Return(add(BEGIN, index(16)))), strides=(32,))
    assert sizes(made) == []
    message = struct.pack("<fifi", 1.5, 7, -2.5, -9)
    result = outcome("llvm", made, message, rows(made))
    assert result == outcome("interpreter", made, message, rows(made))
    assert struct.unpack("<4d", result[2][0][:32]) == (1.5, 7.0, -2.5, -9.0)


def test_a_message_is_read_before_it_is_written():
    loads = [Let(f"n{at}", Load("f64", add(BEGIN, index(8 * at)))) for at in range(2)]
    stores = [StoreIn(add(BEGIN, index(8 * at)), Binary("mul", local("f64", f"n{1 - at}"), HALF)) for at in range(2)]
    again = [SetField(Place(0, ROW, 8 * at), Binary("mul", local("f64", f"n{at}"), HALF)) for at in range(2)]
    body = (row_fits(), Require(BEGIN, index(16), failure(0)), *loads, *stores, *again, Return(add(BEGIN, index(16))))
    made = kernel(body, strides=(16,), direction="encode")
    assert sizes(made) == []
    message = struct.pack("<2d", 1.5, 5.0)
    assert outcome("llvm", made, message, rows(made)) == outcome("interpreter", made, message, rows(made))


def test_a_row_behind_those_in_use_is_read_where_it_stands():
    """Between the reads and the stores more rows come in use."""
    reads = [Let(f"n{at}", Get("f64", Place(2, add(Used(1), index(at))))) for at in range(2)]
    stores = [SetField(Place(0, ROW, 8 * at), Binary("mul", local("f64", f"n{at}"), HALF)) for at in range(2)]
    room = Expect(Compare("lt", add(Used(1), index(3)), Used(2)), failure(1))
    body = (row_fits(), Reserve(1, index(1)), room, *reads, Advance(1, index(1)), *stores, Return(BEGIN))
    made = kernel(body, strides=(16, 1, 8))
    assert sizes(made) == []


def test_nothing_is_moved_across_what_a_routine_does():
    routine = Routine("waits", (), (local("i64", "none"),), (Let("none", Const("i64", 0)),), (), (), ())
    loads = [Let(f"n{at}", Load("f64", add(BEGIN, index(8 * at)))) for at in range(2)]
    stores = [SetField(Place(0, ROW, 8 * at), Binary("mul", local("f64", f"n{at}"), HALF)) for at in range(2)]
    call = Call("waits", (), (local("i64", "waited"),), ())
    body = (row_fits(), Require(BEGIN, index(16), failure(0)), *loads, call, *stores, Return(add(BEGIN, index(16))))
    made = kernel(body, strides=(16,))
    assert sizes(replace(made, routines=(routine,))) == []


def test_squares_of_squares_are_followed_once():
    """Each of them is used twice, so that what is looked at again for each use would double with each."""
    steps = [Let(f"s0_{at}", Binary("mul", Load("f64", add(BEGIN, index(8 * at))), HALF)) for at in range(2)]
    for deep in range(1, 13):
        steps += [
            Let(f"s{deep}_{at}", Binary("mul", local("f64", f"s{deep - 1}_{at}"), local("f64", f"s{deep - 1}_{at}"))) for at in range(2)
        ]
    stores = [SetField(Place(0, ROW, 8 * at), local("f64", f"s12_{at}")) for at in range(2)]
    made = kernel((row_fits(), Require(BEGIN, index(16), failure(0)), *steps, *stores, Return(add(BEGIN, index(16)))), strides=(16,))
    assert text_of(made).count("fmul <2 x double>") == 13
    message = struct.pack("<2d", 1.0000001, 0.9999999)
    assert outcome("llvm", made, message, rows(made)) == outcome("interpreter", made, message, rows(made))
