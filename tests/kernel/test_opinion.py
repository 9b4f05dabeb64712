"""z3's opinion on what kernels owe: it agrees with the proof, refutes what is unsafe, and does not believe wrong inferences."""

from __future__ import annotations

from contextlib import suppress

import pytest
import z3

from rosetta_jit.kernel.nodes import Binary, Const, Convert, Let, Load, Local, Return
from rosetta_jit.kernel.proof import claims, meanings, paths, prove, symbolic
from rosetta_jit.kernel.proof.linear import minus, shifted
from rosetta_jit.kernel.proof.opinion import opinions
from rosetta_jit.kernel.proof.record import Record
from rosetta_jit.kernel.proof.verify import VerificationError, verify
from rosetta_jit.kernel.terms import BEGIN, add
from tests.kernel import kernels
from tests.kernel.kernels import compare, expect, i64, need
from tests.kernel.unsafe import ACCEPTED, REFUSED


def judged(kernel):
    record = Record()
    with suppress(VerificationError):
        verify(kernel, record)
    return list(zip(record.obligations, opinions(record.obligations), strict=True))


def agree(kernel):
    for obligation, opinion in judged(kernel):
        assert obligation.procedure is not None
        assert opinion.verdict == "proved", (obligation.claim, obligation.stmt, opinion)


LONG = {"image", "a deep expression"}
"""Kernels that z3 thinks about for half a minute."""


@pytest.mark.parametrize("name", sorted(set(kernels.ALL) - LONG))
def test_kernels_like_lowered_ones(name):
    agree(kernels.ALL[name])


@pytest.mark.parametrize("name", [each for each in list(ACCEPTED)[::8] if each not in LONG])
def test_safe_kernels(name):
    agree(ACCEPTED[name])


def refuted(name):
    *others, (last, opinion) = judged(REFUSED[name][1])
    assert all(each.verdict == "proved" for _, each in others)
    assert last.procedure is None, last.claim
    assert opinion.verdict == "refuted", last.claim
    return opinion


REFUTED = [
    "load beyond the end",
    "load far before the begin",
    "row at the capacity",
    "more rows than reserved",
    "copy onto itself, to the left",
    "a sum that wraps",
    "div by zero",
    "condition: le",
    "a check in one branch",
    "a position that both branches move",
    "a number that a case changes",
    "what a loop leaves",
    "a round without progress",
    "a promise that is broken",
    "xor: one row too few",
]


@pytest.mark.parametrize("name", REFUTED)
def test_unsafe_kernels(name):
    refuted(name)


def test_bits_of_a_sum_whose_parts_may_be_anything():
    """That the sum is a word was owed where it was made; of its parts alone it does not follow."""
    first, second = Load("i64", BEGIN), Load("i64", add(BEGIN, 8))
    small = [expect(compare(op, i64(each), limit)) for each in "ab" for op, limit in (("ge", 0), ("le", 9))]
    body = (need(BEGIN, 16), Let("a", first), Let("b", second), *small)
    agree(kernels.kernel((*body, Let("n", Binary("xor", Binary("sub", i64("a"), i64("b")), i64("a"))), Return(BEGIN))))


def word(operation, left, right, type_="u64"):
    return Binary(operation, left, right if isinstance(right, Load | Local | Binary | Convert) else Const(type_, right))


BITS = {
    "shr": lambda x: word("and", word("shr", x, 7), 0x00FF00FF),
    "shr of and": lambda x: word("or", word("and", x, 0x7F), word("and", word("shr", x, 1), 0x3F80)),
    "sum of shr": lambda x: word("add", word("and", x, 0xFF), word("shr", word("and", x, 0xFF), 4)),
    "shl": lambda x: word("or", word("shl", x, 9), word("shr", x, 55)),
    "low bits": lambda x: word("xor", Convert("u32", x), 0x5555, "u32"),
    "low bits with a sign": lambda x: word("xor", Convert("i32", x), 0x5555, "i32"),
    "zigzag": lambda x: Convert("i32", word("xor", word("shr", word("and", x, 0xFFFFFFFF), 1), word("and", x, 1))),
}
"""What varints are put together by: shifts among operations on bits."""


@pytest.mark.parametrize("name", BITS)
def test_shifts_among_bits(name):
    made = BITS[name](Local("u64", "x"))
    agree(kernels.kernel((need(BEGIN, 8), Let("x", Load("u64", BEGIN)), Let("n", made), Return(BEGIN))))


@pytest.mark.parametrize(("type_", "ends"), [("u8", (0, 255)), ("i16", (-(1 << 15), (1 << 15) - 1)), ("i64", (-(1 << 63), (1 << 63) - 1))])
def test_a_word_is_the_low_bits(type_, ends):
    low, high = ends
    for value in (0, 1, -1, low, high, high + 1, low - 1, 12345678901234567890, -(1 << 70) + 77):
        wanted = (value - low) % (high - low + 1) + low
        assert z3.simplify(meanings._as_word(z3.BitVecVal(value, meanings.BITS), ends)).as_signed_long() == wanted, type_


def test_a_counterexample_shows_the_message():
    values = dict(refuted("load without a check").counterexample)
    assert values["length"] < 8


@pytest.mark.campaign
@pytest.mark.parametrize("name", [*ACCEPTED, "image"])
def test_every_safe_kernel(name):
    agree((ACCEPTED | kernels.ALL)[name])


def doubted(kernel):
    return {obligation.claim for obligation, opinion in judged(kernel) if opinion.verdict != "proved"}


def test_what_the_proof_infers_of_operations_is_judged(monkeypatch):
    """Were the rest of a division thought to be less than it can be, z3 would not agree."""
    right = symbolic.integers.remainder

    def wrong(facts, left, divisor):
        result = right(facts, left, divisor)
        facts.derive(minus(shifted(divisor, -2), result))
        return result

    monkeypatch.setattr(symbolic.integers, "remainder", wrong)
    assert claims.OPERATION in doubted(REFUSED["remainder: one row too few"][1])


def test_what_the_proof_infers_of_meeting_paths_is_judged(monkeypatch):
    """Were one of the paths forgotten where they meet, z3 would not agree."""
    right = paths._met
    monkeypatch.setattr(paths, "_met", lambda scope, old, arrivals, name: right(scope, old, arrivals[:1], name))
    assert claims.ALL_PATHS in doubted(REFUSED["a number that both branches change"][1])


def test_what_the_proof_infers_of_loops_is_judged(monkeypatch):
    """Were relations kept that a round breaks, z3 would not agree."""
    right = prove.Facts.proves
    monkeypatch.setattr(prove.Facts, "proves", lambda *_: True)
    monkeypatch.setattr(prove.Facts, "proves_thoroughly", right)
    assert claims.RELATION_KEPT in doubted(REFUSED["a position that a loop moves"][1])
