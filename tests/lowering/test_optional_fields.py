"""What kernels say again behind an optional field of protobuf: what its writing may have changed, and nothing else."""

from __future__ import annotations

import pytest

from rosetta_jit.kernel.nodes import Capacity, Expect
from rosetta_jit.kernel.passes import order
from rosetta_jit.kernel.walk import every_statement, parts_of
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request

PLAIN = ("int64", "string", "bytes", "double", "bool")
MEASURED = ("Inner", "repeated int64")


def kernels(kind):
    """The encoder of a message of three fields of a kind, and what measures for it, as they are lowered."""
    fields = " ".join(f"{kind} field{number} = {number};" for number in (1, 2, 3))
    text = f'syntax = "proto3"; package a;\nmessage Inner {{ int64 number = 1; }}\nmessage All {{ {fields} }}'
    return Build(Request("encode", type="a.All", files=(("a.proto", text),), encoding="protobuf")).lowered


def asked_of_lengths(kernel):
    """How many checks ask whether there is room for the lengths of what a message has within it."""
    scratch = len(kernel.strides) - 1
    checks = [each for each in every_statement(kernel) if isinstance(each, Expect)]
    return sum(Capacity(scratch) in parts_of((each,)) for each in checks)


@pytest.mark.parametrize("kind", PLAIN)
def test_plain_fields_say_nothing_of_lengths(kind):
    assert [asked_of_lengths(each) for each in kernels(kind)] == [0, 0]


@pytest.mark.parametrize("kind", MEASURED)
def test_fields_that_have_a_length_of_their_own_do(kind):
    assert min(asked_of_lengths(each) for each in kernels(kind)) >= 3


@pytest.mark.parametrize("kind", [*PLAIN, *MEASURED])
def test_they_are_proven(kind):
    for each in kernels(kind):
        order.run(each)


def test_a_text_is_measured_in_one_step():
    """One check of the sum for each of three texts, and one for unknown fields."""
    _, size = kernels("string")
    details = [size.sites[each.failure.site].detail for each in every_statement(size) if isinstance(each, Expect)]
    assert sum("larger than any memory" in each for each in details) == 4
