"""Bodies of very many checks: each failure stores what it reports, and reports what the interpreter does."""

from __future__ import annotations

import re

import pytest
from llvmlite import ir

from rosetta_jit.backends.entry.link import llvm_text
from rosetta_jit.backends.llvm.function import emit
from rosetta_jit.backends.llvm.routines import MANY
from rosetta_jit.kernel.nodes import Compare, Const, Expect, For, Load, Local, Require, Return
from rosetta_jit.kernel.proof.verify import verify
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request
from tests.backends.engines import outcome
from tests.backends.holders import rows
from tests.backends.kernels import failure, kernel

BYTES, ROUNDS, LAST = 600, 3, 4


def checked(*, goes_wrong_at=1):
    """Two attempts: all bytes are 0, the last four of them in three rounds; or the byte at a place is 7."""
    every = [Expect(Compare("eq", Load("u8", add(BEGIN, at)), Const("u8", 0)), failure(2, add(BEGIN, at))) for at in range(BYTES)]
    number = Local("i64", "number")
    ends = [add(BEGIN, at) for at in range(BYTES, BYTES + LAST)]
    last = tuple(Expect(Compare("eq", Load("u8", each), Const("u8", 0)), failure(3, each, number)) for each in ends)
    size = Require(BEGIN, index(BYTES + LAST), failure(1))
    second = Expect(Compare("eq", Load("u8", add(BEGIN, goes_wrong_at)), Const("u8", 7)), failure(4, add(BEGIN, goes_wrong_at), index(5)))
    first = (size, *every, For(number.name, Const("i64", ROUNDS), last), Return(END))
    return kernel(first, (size, second, Return(END)), strides=(8,), name="checked")


@pytest.mark.parametrize("at", [1, 300, BYTES])
@pytest.mark.parametrize("name", ["llvm", "python"])
@pytest.mark.parametrize("wrong", [None, 0, 1, 299, BYTES - 1, BYTES, BYTES + 2])
def test_failures_are_those_of_the_interpreter(name, wrong, at):
    made = checked(goes_wrong_at=at)
    verify(made)
    message = bytes(9 if place == wrong else 0 for place in range(BYTES + LAST))
    assert outcome(name, made, message, rows(made)) == outcome("interpreter", made, message, rows(made))


def test_no_instruction_names_all_failures():
    text = llvm_text([checked()], "decode", with_numba=False)
    assert max(line.count("[ ") for line in text.splitlines() if "= phi " in line) < 64


def test_failures_of_one_round_share_the_block_that_stores_its_number():
    text = llvm_text([checked()], "decode", with_numba=False)
    assert len(re.findall(r"^indices[.\d]*:", text, re.MULTILINE)) == 1


def test_failures_end_in_what_they_do_not_share():
    """Where the last instructions of blocks are the same, LLVM compares each block with each other one, to merge them."""
    text = llvm_text([checked()], "decode", with_numba=False)
    last = re.findall(r"store i64 (\S+), ptr [^\n]*\n  br label %(?:failed|indices)\b", text)
    assert sum(each.isdigit() for each in last) > BYTES


def test_checks_that_report_the_same_lead_to_one_block():
    every = [Expect(Compare("eq", Load("u8", add(BEGIN, at)), Const("u8", 0)), failure(2, BEGIN)) for at in range(BYTES)]
    made = kernel((Require(BEGIN, index(BYTES), failure(1)), *every, Return(END)), strides=(8,), name="alike")
    verify(made)
    assert len(re.findall(r"^broken[.\d]*:", llvm_text([made], "decode", with_numba=False), re.MULTILINE)) < 5
    for wrong in (None, 0, 300, BYTES - 1):
        message = bytes(9 if place == wrong else 0 for place in range(BYTES))
        assert outcome("llvm", made, message, rows(made)) == outcome("interpreter", made, message, rows(made))


def test_a_routine_that_cannot_fail_is_not_asked_whether_it_has():
    fields = "\n".join(f"  int64 field{number} = {number + 1};" for number in range(MANY))
    text = f'syntax = "proto3"; package a;\nmessage All {{\n{fields}\n}}'
    encoder, size = Build(Request("encode", type="a.All", files=(("a.proto", text),), encoding="protobuf")).kernels
    asked = {}
    for made in (encoder, size):
        module = ir.Module("made")
        emit(module, made, "made", whole=False)
        asked[made] = len(re.findall(r"extractvalue \{ ?i64, i64 ?\} \S+, 0", str(module)))
    assert asked[size] == 0
    assert asked[encoder] >= MANY
