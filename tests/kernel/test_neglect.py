"""A size kernel asks where a list starts only if it reads it, and passes are left out only where they find nothing."""

from __future__ import annotations

import struct

import pytest

from rosetta_jit.api.options import type_request
from rosetta_jit.kernel.nodes import If, Let
from rosetta_jit.kernel.passes import order
from rosetta_jit.kernel.passes.seldom_needed import neglect
from rosetta_jit.kernel.proof.verify import verify
from rosetta_jit.kernel.walk import flat
from rosetta_jit.pipeline.build import Build
from tests.kernel import kernels
from tests.kernel.kernels import ROW_EXISTS, outcome
from tests.kernel.pass_kernels import PASSED
from tests.kernel.sized_kernels import COUNT, COUNTED, SIZED, list_kernel


def test_a_start_that_is_only_checked_goes():
    made = neglect(list_kernel())
    assert made.bodies[0][:-1] == (ROW_EXISTS, COUNT, COUNTED)


def test_the_encoder_keeps_it():
    encoder = list_kernel(direction="encode")
    assert neglect(encoder) is encoder


@pytest.mark.parametrize("name", ["a start that is read", "a start that is checked twice", "a check of other numbers"])
def test_what_else_is_read_or_asked_stays(name):
    assert neglect(SIZED[name]) is SIZED[name]


def test_a_start_within_a_branch_goes():
    (branch,) = [stmt for stmt in neglect(SIZED["a start within a branch"]).bodies[0] if isinstance(stmt, If)]
    assert branch.then == (COUNT, COUNTED)


FILES = {"t/msg/T.msg": "string name\nfloat64[] values\nE[] items\n", "t/msg/E.msg": "string text\n"}


def programs():
    return Build(type_request("encode", "t/T", {"encoding": "ros1", "schema": FILES})).kernels


def test_only_lists_of_what_is_measured_are_looked_for():
    encoder, sizes = programs()
    assert [starts(each) for each in (encoder, sizes)] == [4, 1]  # `items` alone: each of them has a text


def starts(each):
    return len({stmt.name for stmt in flat(each.bodies[0]) if isinstance(stmt, Let) and stmt.name.startswith("start")})


@pytest.mark.parametrize("start", [0, 1, 1 << 40, -1])
def test_a_damaged_start_is_the_encoders_to_report(start):
    """Two texts are in use, and the row asks for both of them, from somewhere on."""
    encoder = list_kernel(direction="encode")
    seed = struct.pack("<qq", start, 2)
    whole = start == 0
    assert (outcome(encoder, b"", seed=seed) != ("failed",)) is whole
    assert outcome(neglect(encoder), b"", seed=seed) == outcome(encoder, b"", seed=seed)


KERNELS = {**kernels.ALL, **PASSED, **SIZED}


@pytest.mark.parametrize("name", KERNELS)
def test_a_pass_that_is_left_out_changes_nothing(name):
    original = KERNELS[name]
    left_out = set(order.PASSES) - set(order._needed(order.PASSES, original))
    assert left_out <= set(order.NEEDS)
    current = original
    for transform in order.PASSES:
        made = transform(current)
        assert transform not in left_out or made.bodies == current.bodies, transform.__name__
        current = made
    verify(current)
