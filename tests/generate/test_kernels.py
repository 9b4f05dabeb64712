"""Every operation of kernels does in C what the interpreter says."""

from __future__ import annotations

from random import Random

import pytest

from rosetta_jit.kernel.nodes import Advance
from rosetta_jit.kernel.passes.alone import alone
from rosetta_jit.kernel.walk import statements
from tests.backends import engines, kernels, test_agreement
from tests.backends.holders import rows
from tests.backends.messages import hostile
from tests.generate import kernels_in_c
from tests.generate.driver import needs_gcc
from tests.kernel.random_kernels import random_kernel

pytestmark = needs_gcc


@pytest.fixture(autouse=True)
def through_c(monkeypatch):
    """The tests of backends ask C instead."""

    def outcome(backend, kernel, message, holder, *place):
        if backend != "c":
            return engines.outcome(backend, kernel, message, holder, *place)
        return kernels_in_c.outcome(kernel, message, holder)

    monkeypatch.setattr(test_agreement, "BACKENDS", ("c",))
    monkeypatch.setattr(test_agreement, "outcome", outcome)


def has_one_message(kernel):
    """Whether lane 0 has a row for the message, as in holders, and not the elements of an array."""
    return not any(isinstance(stmt, Advance) and stmt.lane == 0 for body in kernel.bodies for stmt, _ in statements(body))


@pytest.mark.parametrize("kernel", [*filter(has_one_message, kernels.DECODERS)], ids=lambda each: each.name)
def test_decodes_like_the_interpreter(kernel):
    for message in hostile(kernel.name):
        expected = engines.outcome("interpreter", kernel, message, rows(kernel))
        found = kernels_in_c.outcome(kernel, message, rows(kernel))
        assert found == ((0, *expected[1:]) if expected[0] >= 0 else expected), message


@pytest.mark.parametrize("type_", test_agreement.NUMBERS)
def test_conversions(type_):
    test_agreement.test_conversions(type_)


@pytest.mark.parametrize("type_", ["f64", "f32"])
def test_float_arithmetic(type_):
    test_agreement.test_float_arithmetic(type_)


@pytest.mark.parametrize("type_", ["i64", "u64", "i16", "u8"])
def test_integer_arithmetic(type_):
    test_agreement.test_integer_arithmetic(type_)


@pytest.mark.parametrize("type_", ["u64", "u8"])
def test_sums_that_wrap(type_):
    test_agreement.test_sums_that_wrap(type_)


@pytest.mark.parametrize("type_", ["u8", "i16", "u64", "i64"])
def test_tables(type_):
    test_agreement.test_tables(type_)


@pytest.mark.parametrize("type_", ["f64", "i64", "u8"])
def test_comparisons_and_selection(type_):
    test_agreement.test_comparisons_and_selection(type_)


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(300))
def test_random_kernels(seed):
    kernel = random_kernel(seed)
    chance = Random(seed)
    for length in (0, 8, 40, 200, 1000):
        message = chance.randbytes(length)
        expected = engines.outcome("interpreter", alone(kernel), message, rows(kernel))
        assert shown(kernel, kernels_in_c.outcome(kernel, message, rows(kernel))) == shown(kernel, expected), message


def shown(kernel, outcome):
    """What a caller sees: of a failure its offset and its path, which several sites may have."""
    result, *rest = outcome
    return rest if result >= -1 else (rest[0][0], kernel.sites[-1 - result].path, kernel.sites[-1 - result].kind)


def test_fits():
    test_agreement.test_fits()
