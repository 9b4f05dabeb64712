"""Every operation of kernels does in Lisp what the interpreter says."""

from __future__ import annotations

from random import Random

import pytest

from rosetta_jit.kernel.passes.alone import alone
from tests.backends import engines, kernels, test_agreement, test_decimals
from tests.backends.holders import rows
from tests.backends.messages import hostile
from tests.generate import kernels_in_lisp
from tests.generate.lisp import needs_sbcl
from tests.generate.test_kernels import has_one_message
from tests.kernel.random_kernels import random_kernel

pytestmark = needs_sbcl

OF_ONE_MESSAGE = [*filter(has_one_message, kernels.DECODERS)]


@pytest.fixture(autouse=True)
def through_lisp(monkeypatch):
    """The tests of backends ask Lisp instead."""

    def outcome(backend, kernel, message, holder, *place):
        if backend != "lisp":
            return engines.outcome(backend, kernel, message, holder, *place)
        return kernels_in_lisp.outcome(kernel, message, holder)

    monkeypatch.setattr(test_agreement, "BACKENDS", ("lisp",))
    for module in (test_agreement, test_decimals):
        monkeypatch.setattr(module, "outcome", outcome)


@pytest.mark.parametrize("kernel", OF_ONE_MESSAGE, ids=lambda each: each.name)
def test_decodes_like_the_interpreter(kernel):
    for message in hostile(kernel.name):
        expected = engines.outcome("interpreter", kernel, message, rows(kernel))
        assert kernels_in_lisp.outcome(kernel, message, rows(kernel)) == kernels_in_lisp.seen(expected), message


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


@pytest.mark.parametrize("type_", ["f64", "f32", "i64", "u64", "u8"])
def test_comparisons_and_selection(type_):
    test_agreement.test_comparisons_and_selection(type_)


def test_fits():
    test_agreement.test_fits()


@pytest.mark.parametrize("type_", ["f64", "f32"])
def test_written_numbers(type_):
    test_decimals.test_written_numbers("lisp", type_)


@pytest.mark.parametrize(("text", "exponent"), test_decimals.READ)
def test_read_numbers(text, exponent):
    test_decimals.test_read_numbers("lisp", text, exponent)


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(300))
def test_random_kernels(seed):
    kernel, chance = random_kernel(seed), Random(seed)
    for length in (0, 8, 40, 200, 1000):
        message = chance.randbytes(length)
        expected = kernels_in_lisp.seen(engines.outcome("interpreter", alone(kernel), message, rows(kernel)))
        assert shown(kernel, kernels_in_lisp.outcome(kernel, message, rows(kernel))) == shown(kernel, expected), message


def shown(kernel, outcome):
    """What a caller sees: of a failure its offset and its path, which several sites may have."""
    result, *rest = outcome
    return rest if result >= -1 else (rest[0][0], kernel.sites[-1 - result].path, kernel.sites[-1 - result].kind)
