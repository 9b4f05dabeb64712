"""Generated C compares no position twice, and waits for no padding to know what is behind it."""

from __future__ import annotations

from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import generated
from rosetta_jit.generate.passes.aligned import aligned, as_printed
from rosetta_jit.generate.passes.positions import NONE, after_binding, after_call, after_require, forget, is_position, joined, said_by
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import END, add, index

AT, PADDING, COUNT = (nodes.Local("i64", name) for name in ("at", "padding", "count"))


def test_a_sum_that_was_asked_for_is_a_position_and_so_is_what_lies_before_it():
    known = after_require(NONE, AT, add(COUNT, 8))
    assert all(is_position(known, each) for each in (AT, add(AT, add(COUNT, 8)), add(add(COUNT, AT), 8)))
    assert not any(is_position(known, each) for each in (add(AT, 8), COUNT, add(add(AT, COUNT), 9)))
    known = after_require(NONE, AT, index(8))
    assert is_position(known, add(AT, 4))
    assert not is_position(known, add(AT, 9))
    assert not is_position(known, add(AT, -1))
    known = after_require(NONE, index(2), index(8))
    assert is_position(known, index(0))
    assert is_position(known, index(10))
    assert not is_position(known, index(11))


def test_a_local_is_one_until_it_is_bound_anew():
    known = after_binding(after_require(NONE, AT, COUNT), "next", add(AT, COUNT))
    following = nodes.Local("i64", "next")
    assert is_position(known, following)
    assert is_position(forget(known, ("at",)), following)
    assert not is_position(forget(known, ("count",)), add(AT, COUNT))
    assert not is_position(after_binding(known, "next", COUNT), following)
    assert is_position(after_binding(known, "at", add(AT, COUNT)), AT)
    assert not is_position(after_binding(known, "at", add(AT, COUNT)), add(AT, COUNT))


def test_what_memory_holds_is_no_position_that_is_known():
    loaded = nodes.Convert("i64", nodes.Load("u32", AT, "<"))
    known = after_require(NONE, AT, loaded)
    assert is_position(known, AT)
    assert not is_position(known, add(AT, loaded))
    assert not is_position(after_require(NONE, loaded, index(4)), loaded)


def test_loops_say_what_they_keep():
    within = nodes.Compare("ge", AT, index(0)), nodes.Compare("le", AT, END)
    assert is_position(said_by(within), AT)
    assert not is_position(said_by(within[:1]), AT)
    assert not is_position(said_by(within[1:]), AT)


def test_behind_branches_a_local_is_one_if_it_is_in_all_of_them():
    known = after_require(NONE, AT, index(8))
    moved, strange = after_binding(known, "next", add(AT, 8)), after_binding(known, "next", COUNT)
    following, stmt = nodes.Local("i64", "next"), nodes.If(nodes.Const("bool", value=True), (nodes.Let("own", AT),))
    assert is_position(joined(stmt, [moved, after_binding(moved, "next", AT)]), following)
    assert not is_position(joined(stmt, [moved, strange]), following)
    assert is_position(joined(stmt, [moved, strange]), add(AT, 8))
    assert not is_position(joined(stmt, [known, NONE]), AT)
    assert not is_position(joined(stmt, [after_binding(known, "own", AT)]), nodes.Local("i64", "own"))
    assert joined(stmt, []) == NONE


def test_results_of_a_call_are_as_its_contract_says():
    following, size = nodes.Local("i64", "next"), nodes.Local("i64", "size")
    call = nodes.Call("write", (AT,), (following, size), (), ())
    known = after_call(after_require(NONE, following, index(1)), call, {0})
    assert is_position(known, following)
    assert not is_position(known, add(following, 1))
    assert not is_position(known, size)


def test_padding_is_not_waited_for():
    padding = nodes.Let("padding", nodes.Binary("and", nodes.Binary("sub", index(4), AT), index(3)))
    behind = nodes.Let("behind", add(AT, PADDING))
    assert aligned((padding, behind)) == {"behind": nodes.Binary("and", add(AT, 3), index(-4))}
    shorter = nodes.Let("behind", nodes.Binary("and", add(AT, 3), index(-4)))
    assert as_printed((nodes.For("i", COUNT, (padding, behind)),)) == (nodes.For("i", COUNT, (padding, shorter)),)
    assert aligned((padding, nodes.Assign("at", index(0)), behind)) == {}
    assert aligned((nodes.Let("padding", nodes.Binary("and", nodes.Binary("sub", index(4), AT), index(7))), behind)) == {}
    assert aligned((nodes.Let("padding", nodes.Binary("and", nodes.Binary("sub", index(4), AT), index(2))), behind)) == {}


def test_a_text_after_another_is_checked_with_one_comparison_each():
    text = generated(type_request("decode", "sensor_msgs/msg/JointState", {"encoding": "cdr"}), "c", ("encode",), "unit")["unit.c"]
    assert "if (lacks_behind(at_3 + 4, count_3, end)) {" in text
    assert "const int64_t at_3 = (next + 3) & (-4);" in text
    assert "lacks(" not in text
    assert text.count("padding_2 = (4 - next) & 3;") == 1  # what measures the message does not need it


def test_fields_that_may_be_absent_are_checked_with_one_comparison_each():
    schema = {"m.proto": 'syntax = "proto3"; message P { double x = 1; double y = 2; } message M { repeated P ps = 1; int32 n = 2; }'}
    text = generated(type_request("decode", "M", {"encoding": "protobuf", "schema": schema}), "c", ("encode",), "unit")["unit.c"]
    assert "if (end < next_3 + 9) {" in text
    assert "lacks(" not in text
