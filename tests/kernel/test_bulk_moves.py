"""Where loops become moves, where they must not, and what it takes: memory read once, variables settled, checks of the last round."""

from __future__ import annotations

import pytest

from rosetta_jit.kernel import interpret
from rosetta_jit.kernel.nodes import (
    Assign,
    Binary,
    Capacity,
    Compare,
    Const,
    Convert,
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
    Return,
    SetField,
    Store,
    Var,
    While,
)
from rosetta_jit.kernel.passes import order as passes
from rosetta_jit.kernel.passes.bulk import bulk
from rosetta_jit.kernel.passes.drop import drop
from rosetta_jit.kernel.passes.hoist import hoist
from rosetta_jit.kernel.passes.reuse import reuse
from rosetta_jit.kernel.passes.simplify import simplify
from rosetta_jit.kernel.proof.verify import verify
from rosetta_jit.kernel.state import ERROR_INDICES
from rosetta_jit.kernel.terms import BEGIN, ROW, add, index, mul
from rosetta_jit.kernel.walk import statements
from tests.kernel import kernels
from tests.kernel.kernels import ROW_EXISTS, compare, expect, i64, kernel, need

N, I = i64("n"), i64("i")  # noqa: E741  # the loop's count and index
COUNT = (need(BEGIN, 1), Let("n", Convert("i64", Load("u8", BEGIN))))
FIRST = add(BEGIN, 1)


def found(kernel, *kinds):
    return [stmt for body in kernel.bodies for stmt, _ in statements(body) if isinstance(stmt, kinds)]


def same_outcomes(before, after, messages, **options):
    for message in messages:
        for length in range(len(message) + 1):
            assert kernels.outcome(after, message[:length], **options) == kernels.outcome(before, message[:length], **options)


def filling(value, *, target=None, step=8, stride=8):
    """A kernel that reads a count and fills lane 1, element by element, from what lies ``step`` bytes apart."""
    target = target or Place(1, I)
    loop = For("i", N, (SetField(target, value),))
    room = expect(Compare("le", N, Capacity(1)), 5)
    return kernel((ROW_EXISTS, *COUNT, room, need(FIRST, mul(N, step)), loop, Return(BEGIN)), strides=(64, stride))


def at(step):
    return Binary("add", FIRST, mul(I, step)) if step != 1 else Binary("add", FIRST, I)


@pytest.mark.parametrize(
    ("value", "step", "stride"),
    [
        (Load("i64", at(8)), 8, 8),
        (Load("f32", at(4)), 4, 4),
        (Load("u8", at(1)), 1, 1),
        (Load("i8", at(1), ">"), 1, 1),
        (Convert("i16", Load("u16", at(2))), 2, 2),
    ],
    ids=["i64", "f32", "u8", "one byte has no order", "another sign"],
)
def test_consecutive_elements_are_one_copy(value, step, stride):
    before = filling(value, step=step, stride=stride)
    after = bulk(before)
    verify(after)
    assert not found(after, For)
    assert len(found(after, Copy)) == 1
    same_outcomes(before, after, [bytes([3, *range(1, 30)]), bytes([0, 1]), bytes([2, *[255] * 16])])


@pytest.mark.parametrize(
    ("value", "step", "stride"),
    [
        (Load("i64", at(8), ">"), 8, 8),
        (Load("bool", at(1)), 1, 1),
        (Load("u8", at(3)), 3, 1),
        (Load("i32", at(4)), 4, 8),
        (Convert("i32", Load("f32", at(4))), 4, 4),
        (Convert("u16", Load("u8", at(1))), 1, 2),
        (Load("u8", FIRST), 1, 1),
    ],
    ids=["other order", "bool", "gaps in the message", "gaps in the lane", "float to int", "wider", "the same element"],
)
def test_other_elements_stay_a_loop(value, step, stride):
    before = filling(value, step=step, stride=stride)
    assert bulk(before) == before


@pytest.mark.parametrize(("value", "byte"), [(Const("f64", 0.0), 0), (Const("i16", -1), 255), (Const("u8", 7), 7), (Const("i32", 7), None)])
def test_a_constant_of_equal_bytes_is_a_fill(value, byte):
    stride = {"f64": 8, "i16": 2, "u8": 1, "i32": 4}[value.type]
    before = filling(value, step=0, stride=stride)
    after = bulk(before)
    verify(after)
    assert [fill.byte for fill in found(after, Fill)] == ([] if byte is None else [byte])
    same_outcomes(before, after, [bytes([5, 1])])


def points(*fields, step=16, stride=16):
    """A kernel whose elements are structs: of each field the type, and where it lies in the message and in the lane."""
    item = Let("item", at(step))
    moved = [SetField(Place(1, I, to), Load(type_, add(i64("item"), origin))) for type_, origin, to in fields]
    room = expect(Compare("le", N, Capacity(1)), 5)
    body = (ROW_EXISTS, *COUNT, room, need(FIRST, mul(N, step)), For("i", N, (item, *moved)), Return(BEGIN))
    return kernel(body, strides=(64, stride))


X, Y, Z = ("f64", 0, 0), ("i32", 8, 8), ("f32", 12, 12)


@pytest.mark.parametrize("fields", [(X, Y, Z), (Z, X, Y), (Y, Z, X)])
def test_structs_that_both_sides_have_alike_are_one_copy(fields):
    before = points(*fields)
    after = passes.run(before)
    assert not found(after, For)
    (copy,) = found(after, Copy)
    assert (copy.target, copy.size) == (Place(1, index(0)), mul(N, 16))
    same_outcomes(before, after, [bytes([3, *range(1, 60)]), bytes([0, 1]), bytes([1, *[255] * 16])])


@pytest.mark.parametrize(
    ("fields", "step", "stride"),
    [
        ((X, Y), 16, 16),
        ((X, Y, Z), 17, 16),
        ((X, Y, Z), 16, 24),
        ((("f64", 8, 0), ("i32", 4, 8), ("f32", 0, 12)), 16, 16),
        ((("i32", 0, 4), ("i32", 4, 0)), 8, 8),
        ((X, X, Y), 16, 16),
    ],
    ids=["a field is left out", "gaps in the message", "gaps in the lane", "another order", "exchanged", "twice"],
)
def test_other_structs_are_no_copy(fields, step, stride):
    before = points(*fields, step=step, stride=stride)
    assert bulk(before) == before


def test_structs_are_written_as_one_copy():
    stores = [Store(add(i64("item"), to), Get(type_, Place(1, I, to))) for type_, to, _ in (Y, X, Z)]
    loop = For("i", N, (Let("item", at(16)), *stores))
    room = expect(Compare("le", N, Capacity(1)), 5)
    before = kernel((ROW_EXISTS, *COUNT, room, need(FIRST, mul(N, 16)), loop, Return(BEGIN)), strides=(64, 16))
    after = bulk(before)
    verify(after)
    assert [copy.source for copy in found(after, Copy)] == [Place(1, index(0))]


def test_rows_without_padding_are_one_copy():
    w, h, step = i64("w"), i64("h"), i64("step")
    sizes = [Let(name, Convert("i64", Load("u8", add(BEGIN, k)))) for k, name in enumerate(["w", "h", "step"])]
    pixel = Binary("add", Binary("add", add(BEGIN, 3), mul(i64("y"), step)), i64("x"))
    into = Place(1, Binary("add", mul(i64("y"), w), i64("x")))
    rows = For("y", h, (For("x", w, (SetField(into, Load("u8", pixel)),)),))
    room = [expect(compare("ge", step, w)), expect(Compare("le", mul(h, w), Capacity(1)), 5)]
    body = (ROW_EXISTS, need(BEGIN, 3), *sizes, *room, need(add(BEGIN, 3), mul(h, step)), rows, Return(BEGIN))
    before = kernel(body, strides=(8, 1))
    verify(before)
    after = passes.run(before)
    whole, row_by_row = found(after, Copy)
    assert (whole.size, row_by_row.size) == (mul(h, w), w)
    assert len(found(after, For)) == 1
    same_outcomes(before, after, [bytes([3, 2, step, *range(20)]) for step in (2, 3, 4)] + [bytes([0, 9, 0]), bytes([9, 0, 9])])


def test_a_row_is_checked_once_where_the_message_has_it():
    (loop,) = found(passes.run(kernels.ALL["image"]), For)
    (row,) = found(kernel((loop,)), Copy)
    assert row.size == i64("w")
    assert len(found(kernel((loop,)), If)) == 1


def test_a_copy_moves_what_is_left_after_checks():
    after = passes.run(kernels.ALL["encode_list"])
    assert found(after, Copy)
    assert not found(after, For)


# --- reuse -------------------------------------------------------------------------------------------------------------

FLAG = Get("u64", Place(0, ROW))


def test_memory_is_read_once():
    twice = (SetField(Place(1, ROW), FLAG), SetField(Place(1, ROW), FLAG))
    after = reuse(kernel((ROW_EXISTS, *twice, Return(BEGIN))))
    assert [stmt.value for stmt in found(after, Let)] == [FLAG]
    assert {stmt.value for stmt in found(after, SetField)} == {Local("u64", found(after, Let)[0].name)}


@pytest.mark.parametrize(
    "write",
    [
        SetField(Place(0, ROW), Const("i64", 1)),
        SetField(Place(0, ROW, 7), Const("u8", 1)),
        SetField(Place(0, index(0)), Const("i64", 1)),
        Fill(Place(0, ROW), index(8)),
        If(compare("eq", ROW, 0), (Fill(Place(0, ROW), index(8)),)),
    ],
    ids=["field", "part of it", "field of another row", "fill", "in a branch"],
)
def test_what_is_written_is_read_again(write):
    before = kernel((ROW_EXISTS, Let("a", FLAG), write, Let("b", FLAG), SetField(Place(0, ROW, 16), Local("u64", "b")), Return(BEGIN)))
    assert [stmt.value for stmt in found(reuse(before), Let)] == [FLAG, FLAG]


@pytest.mark.parametrize("row", [ROW, index(0)], ids=["row", "another row"])
def test_other_fields_of_a_row_stay_as_they_are(row):
    write = SetField(Place(0, row, 8), Const("i64", 1))
    before = kernel((ROW_EXISTS, Let("a", FLAG), write, Let("b", FLAG), SetField(Place(0, ROW, 16), Local("u64", "b")), Return(BEGIN)))
    after = reuse(before)
    assert [stmt.value for stmt in found(after, Let)] == [FLAG, Local("u64", "a")]
    same_outcomes(before, after, [b""], seed=bytes(range(64)))


def test_a_loop_that_writes_forgets_before_its_first_round():
    loop = For("i", index(20), (SetField(Place(0, ROW, 8), FLAG), SetField(Place(0, ROW), Const("i64", 3))))
    before = kernel((ROW_EXISTS, Let("a", FLAG), SetField(Place(0, ROW, 16), Local("u64", "a")), loop, Return(BEGIN)))
    after = reuse(before)
    assert [stmt.value for stmt in found(after, SetField) if stmt.place.offset == 8] == [FLAG]
    same_outcomes(before, after, [b""], seed=bytes(range(64)))


def test_a_store_ends_what_was_loaded():
    load = Load("u8", BEGIN)
    body = (
        need(BEGIN, 1),
        Let("a", load),
        Store(BEGIN, Const("u8", 1)),
        Let("b", load),
        SetField(Place(0, ROW), Convert("i64", Local("u8", "b"))),
    )
    after = reuse(kernel((ROW_EXISTS, *body, Return(BEGIN)), direction="encode"))
    assert [stmt.value for stmt in found(after, Let)] == [load, load]


def test_one_read_needs_no_name():
    before = kernel((ROW_EXISTS, SetField(Place(1, ROW), FLAG), Return(BEGIN)))
    assert reuse(before) == before


# --- variables and last rounds -----------------------------------------------------------------------------------------


def test_a_variable_is_settled_behind_its_last_assignment():
    v = i64("v")
    body = (Var("v", index(0)), If(compare("eq", ROW, 0), (Assign("v", index(2)),)), Let("a", v), Let("b", mul(v, 3)), Let("c", mul(v, 3)))
    uses = (SetField(Place(0, ROW), i64("a")), SetField(Place(0, ROW, 8), i64("b")), SetField(Place(0, ROW, 16), i64("c")))
    after = simplify(kernel((ROW_EXISTS, *body, *uses, Return(BEGIN))))
    assert [stmt.name for stmt in found(after, Let)] == ["b"]
    assert [stmt.value for stmt in found(after, SetField)] == [v, i64("b"), i64("b")]


def test_a_number_that_was_checked_is_known():
    """Behind its check, and behind the block where it was, no more."""
    checked = expect(compare("eq", N, 9))
    inner = If(compare("gt", ROW, 0), (checked, SetField(Place(0, ROW), add(N, 1))))
    body = (ROW_EXISTS, *COUNT, SetField(Place(0, ROW, 8), mul(N, 8)), inner, SetField(Place(0, ROW, 16), add(N, 2)))
    before = kernel((*body, checked, SetField(Place(0, ROW, 24), mul(N, 8)), Return(add(FIRST, N))))
    after = simplify(before)
    verify(after)
    assert [stmt.value for stmt in found(after, SetField)] == [mul(N, 8), index(10), add(N, 2), index(72)]
    (end,) = found(after, Return)
    assert end.position == add(BEGIN, 10)
    same_outcomes(before, after, [bytes([9]), bytes([8])])


def test_positions_are_sums_with_one_constant():
    """So that the checks of fields behind an array of known length become one."""
    lets = (Let("a", Binary("add", FIRST, N)), Let("b", add(i64("a"), 8)), Let("c", add(i64("b"), 8)))
    fields = tuple(SetField(Place(0, ROW, 8 * k), Load("f64", i64(name))) for k, name in enumerate("abc"))
    needs = tuple(need(i64(name), 8) for name in "abc")
    before = kernel((ROW_EXISTS, *COUNT, *lets, *needs, *fields, Return(add(i64("c"), 8))))
    after = passes.run(before)
    assert [(stmt.at, stmt.size) for stmt in found(after, Require)] == [(BEGIN, index(1)), (i64("a"), index(24))]
    same_outcomes(before, after, [bytes(30), bytes([2, *range(40)])])


def test_a_variable_is_not_settled_from_round_to_round():
    v, old = i64("v"), i64("old")
    rounds = (Let("old", v), Assign("v", add(v, 1)), SetField(Place(0, ROW), old), SetField(Place(0, ROW, 8), v))
    loop = While(compare("lt", v, 5), rounds, (compare("ge", v, 0), compare("le", v, 5)), v)
    before = kernel((ROW_EXISTS, Var("v", index(0)), loop, Return(BEGIN)))
    after = simplify(before)
    verify(after)
    same_outcomes(before, after, [b""])
    assert [stmt.value for stmt in found(after, SetField)] == [old, v]


def limited(op, bound, step):
    """A loop that expects each of its values to keep a limit."""
    value = add(mul(I, step), 1) if step != 1 else add(I, 1)
    loop = For("i", N, (expect(Compare(op, value, bound), 3), SetField(Place(0, ROW), value)))
    return kernel((ROW_EXISTS, *COUNT, need(FIRST, 1), Let("m", Convert("i64", Load("u8", FIRST))), loop, Return(BEGIN)))


@pytest.mark.parametrize("op", ["lt", "le", "gt", "ge"])
@pytest.mark.parametrize("step", [1, 3, -2])
def test_the_round_closest_to_failing_is_checked_for_all(op, step):
    before = limited(op, i64("m"), step)
    verify(before)
    after = drop(hoist(before))
    verify(after)
    (loop,) = found(after, For)
    assert not any(isinstance(stmt, Expect) for stmt in loop.body)
    same_outcomes(before, after, [bytes([n, m]) for n in (0, 1, 2, 5) for m in (0, 1, 2, 4, 5, 6, 12, 13, 14)])


def test_a_check_that_depends_on_the_element_stays():
    element = Convert("i64", Load("u8", Binary("add", FIRST, I)))
    loop = For("i", N, (Let("e", element), expect(compare("lt", i64("e"), 9), 3)))
    before = kernel((ROW_EXISTS, *COUNT, need(FIRST, N), loop, Return(BEGIN)))
    assert found(hoist(before), For) == [loop]
    assert len(found(hoist(before), Require)) == 2


def test_zeros_of_both_signs_are_not_the_same():
    x = Local("f64", "x")
    body = (
        need(BEGIN, 8),
        Let("x", Load("f64", BEGIN)),
        Let("a", Binary("add", x, Const("f64", 0.0))),
        Let("b", Binary("add", x, Const("f64", -0.0))),
    )
    uses = (SetField(Place(0, ROW), Local("f64", "a")), SetField(Place(0, ROW, 8), Local("f64", "b")))
    before = kernel((ROW_EXISTS, *body, *uses, Return(BEGIN)))
    same_outcomes(before, simplify(before), [b"\0\0\0\0\0\0\0\x80"])


@pytest.mark.parametrize("name", kernels.ALL)
def test_simple_kernels_stay_as_they_are(name):
    simple = simplify(kernels.ALL[name])
    assert simplify(simple) is simple
    named = reuse(simple)
    assert reuse(named) is named


def reported(kernel, message):
    """The result of a kernel that fails, and the index that it reports."""
    holder = kernels.Holder(kernel.strides, 64)
    result = interpret.run(kernel, message, 0, len(message), holder.state, holder.lanes, 0)
    return result, int(holder.state[ERROR_INDICES])


@pytest.mark.parametrize("bound", [0, 1, 2, 7])
def test_the_element_that_is_missing_is_named(bound):
    element = add(I, 1)
    loop = For("i", N, (expect(compare("lt", element, bound), 4, BEGIN, element), SetField(Place(0, ROW), element)))
    before = kernel((ROW_EXISTS, *COUNT, loop, Return(BEGIN)))
    after = drop(hoist(before))
    verify(after)
    assert not any(isinstance(stmt, Expect) for stmt in found(after, For)[0].body)
    assert reported(after, b"\x08") == reported(before, b"\x08")
