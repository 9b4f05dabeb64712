"""The cost of kernels, against kernels that are counted by hand, and against bytes that an interpreter touches."""

from __future__ import annotations

import pytest

from rosetta_jit.explain.cost import Cost, Repeated, cost_of, plus
from rosetta_jit.kernel.ir import Kernel, Site
from rosetta_jit.kernel.nodes import (
    Binary,
    Const,
    Convert,
    Copy,
    Expect,
    Failure,
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
    Switch,
    Wire,
)
from rosetta_jit.kernel.terms import BEGIN, ROW, add, index

SITES = (Site("grow", "", ""), Site("truncated", "", ""), Site("length", ".angles", "must not be negative"))
FAIL = Failure(1, BEGIN)


def cost(*body, **fields):
    return cost_of(Kernel("k", "decode", (32, 8), (body,), SITES), fields)


def test_loads_and_stores_are_counted_by_width():
    at = add(BEGIN, 4)
    turned = Binary("mul", Convert("f64", Load("f32", at)), Const("f64", 0.5))
    assert cost(Require(BEGIN, index(8), FAIL), SetField(Place(0, ROW), turned), Return(BEGIN)) == Cost(4, 8, 2, 1)
    assert cost(Store(at, Get("u16", Place(0, ROW, 8)))) == Cost(2, 2, 0, 0)
    assert cost(Fill(Place(0, ROW), index(32))) == Cost(0, 32, 0, 0)


def test_positions_are_not_counted_but_what_they_read_is():
    assert cost(Copy(Place(1, ROW), Wire(add(BEGIN, Load("i64", BEGIN))), index(16))) == Cost(24, 16, 0, 0)


def test_a_loop_of_a_known_count_is_multiplied():
    each = SetField(Place(0, ROW, 8), Binary("add", Load("i32", BEGIN), Const("i32", 1)))
    assert cost(For("i", index(10), (each,))) == Cost(40, 40, 10, 0)


def test_a_loop_of_an_unknown_count_is_named_by_its_check():
    count, step = Local("i64", "count"), SetField(Place(1, Local("i64", "i")), Load("f64", BEGIN))
    body = (
        Let("count", Convert("i64", Load("i32", BEGIN))),
        Expect(Binary("and", Const("bool", True), Const("bool", True)), FAIL),
        Require(BEGIN, Binary("mul", count, index(8)), Failure(2, BEGIN)),
        For("i", count, (step,)),
    )
    assert cost(*body) == Cost(4, 0, 1, 2, (Repeated("len(.angles)", Cost(8, 8)),))


def test_a_loop_is_named_by_the_fields_in_its_count():
    height, width = Local("i64", "size_height"), Local("i64", "width_2")
    product = Let("product", Binary("mul", height, width))
    copy = Copy(Place(1, ROW), Wire(BEGIN), Binary("mul", Local("i64", "product"), index(3)))
    found = cost(product, copy, size_height=".size.height", width=".width")
    assert found.repeated == (Repeated(".size.height * .width", Cost(3, 3)),)


def test_a_loop_whose_count_is_no_product_of_fields_is_not_named_by_locals():
    size = Binary("sub", Binary("add", Local("i64", "text"), index(21)), Local("i64", "first_digit"))
    assert cost(Copy(Place(1, ROW), Wire(BEGIN), size)).repeated == (Repeated("round of a loop", Cost(1, 1)),)


def test_of_branches_the_dearest_counts():
    cheap, dear = SetField(Place(0, ROW), Const("u8", 1)), SetField(Place(0, ROW), Const("u64", 1))
    assert cost(If(Const("bool", True), (cheap,), (dear,))) == Cost(0, 8, 0, 0)
    assert cost(Switch(index(1), ((1, (dear,)), (2, (cheap,))), ())) == Cost(0, 8, 0, 0)


def test_sums_join_what_is_repeated_as_often():
    one = Cost(1, 2, 3, 4, (Repeated("n", Cost(1)), Repeated("m", Cost(2))))
    assert plus(one, one) == Cost(2, 4, 6, 8, (Repeated("n", Cost(2)), Repeated("m", Cost(4))))


@pytest.mark.parametrize(("size", "count"), [(24, 3), (240, 30)])
def test_the_bytes_of_a_message_are_what_a_decoder_reads(size, count):
    """A decoder of a fixed message reads each byte once."""
    import rosetta_jit as rj
    from rosetta_jit.pipeline.build import Build
    from rosetta_jit.pipeline.request import Request

    text = f'"m" ({" ".join(f"""("f{n}" :double)""" for n in range(count))})'
    request = Request("decode", type="m", files=(("m.bottle-schema", text),), encoding="yarp4", backend="python")
    holder = rj.Encoder.of("m", schema={"m.bottle-schema": text}, encoding="yarp4")
    assert cost_of(Build(request).kernels[0]).read == len(holder(holder.holder_type())) == size + 8
