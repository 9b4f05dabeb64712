"""Comparisons that the type of a number decides do not reach a compiler, which would complain of them."""

from __future__ import annotations

from itertools import product

import pytest

from rosetta_jit.api.options import request_of
from rosetta_jit.generate.build import generated
from rosetta_jit.generate.passes.decided import decided
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.arithmetic import compare
from rosetta_jit.kernel.passes.fold import FALSE, TRUE
from tests.generate.driver import compiled, needs_gcc, write
from tests.mapping_examples import example
from tests.test_documents import EXAMPLES

BYTE = nodes.Local("u8", "byte")


def decided_value(condition: nodes.Expr) -> nodes.Expr:
    (stmt,) = decided((nodes.Let("found", condition),))
    assert isinstance(stmt, nodes.Let)
    return stmt.value


@pytest.mark.parametrize("op", ["eq", "ne", "lt", "le", "gt", "ge"])
def test_what_all_numbers_of_a_type_give(op):
    for value, wide in product((-1, 0, 1, 254, 255, 256), (False, True)):
        number = nodes.Convert("i64", BYTE) if wide else BYTE
        if not wide and not 0 <= value <= 255:
            continue
        found = decided_value(nodes.Compare(op, number, nodes.Const(number.type, value)))
        given = {compare(op, each, value) for each in range(256)}
        assert found == (
            nodes.Compare(op, number, nodes.Const(number.type, value)) if len(given) == 2 else TRUE if given == {True} else FALSE
        )


def test_checks_that_hold_are_left_out_and_others_stay():
    never = nodes.Failure(1, nodes.Const("i64", 0))
    holds = nodes.Expect(nodes.Compare("ge", BYTE, nodes.Const("u8", 0)), never)
    may_fail = nodes.Expect(nodes.Compare("ge", BYTE, nodes.Const("u8", 1)), never)
    loop = nodes.For("i", nodes.Const("i64", 3), (holds, may_fail))
    assert decided((holds, loop)) == (nodes.For("i", nodes.Const("i64", 3), (may_fail,)),)


@needs_gcc
def test_joined_bits_of_bytes_compile_without_a_warning(tmp_path):
    made = next(example(block) for block in EXAMPLES.values() if "--- drive.mapping" in block)
    options = {"schema": made.files, "encoding": made.encoding, "parameters": made.parameters}
    texts = generated(request_of("decode", options, mapping=made.mapping), "c", ("decode", "encode"), "unit")
    compiled("gcc", tmp_path, write(tmp_path, texts), "-O1")
