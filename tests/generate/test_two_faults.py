"""A message with two faults: generated code reports the one that the library reports, however large the type is."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import generated
from tests.generate import driver, python

BEHIND = "float32[4] weights\nbuiltin_interfaces/Time[2] stamps\nint32[] counts\n"
SIZES = {"small": 1, "large": 10}
"""Lists of which kernels have more statements than those on which passes run several times."""


def options(lists: int) -> dict[str, object]:
    before = "".join(f"string[] names{each}\nbool[] flags{each}\n" for each in range(lists))
    return {"encoding": "cdr2", "schema": {"t/msg/Lists.msg": before + BEHIND}}


def twice_wrong(message: bytes) -> list[bytes]:
    """With another byte in the last third, and without some of the end."""
    places = range(len(message) * 2 // 3, len(message))
    changed = [message[:at] + bytes([value]) + message[at + 1 :] for at in places for value in (1, 4)]
    return [each[: len(each) - cut] for each in changed for cut in (0, 4, 8, 20)]


@pytest.fixture(params=SIZES.values(), ids=SIZES, scope="module")
def known(request):
    """A request, messages, and what the library says of them."""
    given = options(request.param)
    decode, encode = rj.Decoder.of("t/msg/Lists", **given), rj.Encoder.of("t/msg/Lists", **given)
    messages = twice_wrong(bytes(encode(decode.new())))
    wanted = [driver.expected(decode, encode, each) for each in messages]
    assert len({each.split("]")[0] for each in wanted}) > 5
    return type_request("decode", "t/msg/Lists", given), messages, wanted


def test_by_python(known):
    request, messages, wanted = known
    unit = python.module(request)
    assert [python.answer(unit, each) for each in messages] == wanted


@driver.needs_gcc
def test_by_c(known, tmp_path):
    request, messages, wanted = known
    name = driver.write(tmp_path, generated(request, "c", python.BOTH, "unit"))
    assert driver.answers(driver.driver(tmp_path, name), messages) == wanted
