"""Lazy binding: functions that are found when they are first called, and the accessors, which are compiled so."""

from __future__ import annotations

import ctypes
import subprocess
import sys

import pytest

from rosetta_jit.runtime.attributes import code
from rosetta_jit.runtime.attributes.code import FILES, SYMBOLS, Accessors, text, whole
from rosetta_jit.runtime.attributes.groups import GROUPS, part_of
from rosetta_jit.runtime.callable import is_native
from rosetta_jit.runtime.code import native
from rosetta_jit.runtime.code.assembler import assembled
from rosetta_jit.runtime.code.lazy import Stubs, is_supported, stubs_text

pytestmark = pytest.mark.skipif(not is_supported() or not is_native(), reason="no stubs for this machine, or no accessors for this Python")

SUM = """
define i64 @sum(i64 %a, i64 %b, i64 %c, i64 %d) {
  %ab = shl i64 %a, 3
  %one = add i64 %ab, %b
  %two = shl i64 %one, 3
  %three = add i64 %two, %c
  %four = shl i64 %three, 3
  %five = add i64 %four, %d
  ret i64 %five
}
"""
WORD = ctypes.c_int64
CALL = ctypes.PYFUNCTYPE(WORD, WORD, WORD, WORD, WORD)


@pytest.fixture(scope="module")
def sum_code():
    return native.load(assembled(SUM, ["sum"]), ["sum"])


def test_the_first_call_finds_the_function_and_passes_on_its_arguments(sum_code):
    found = []
    stubs = Stubs(assembled(stubs_text(("one", "two")), ()), {"one": lambda: find("one"), "two": lambda: find("two")}, {})

    def find(name):
        found.append(name)
        stubs.bind(name, sum_code["sum"])

    for name in ("two", "one", "two", "one"):
        assert CALL(stubs[name])(1, 2, 3, 4) == 0o1234
    assert found == ["two", "one"]


def test_a_function_that_is_not_found_fails_and_is_looked_for_again(sum_code):
    errors = [ValueError("first"), KeyboardInterrupt("second")]

    def find():
        if errors:
            raise errors.pop(0)
        stubs.bind("set", sum_code["sum"])

    stubs = Stubs(assembled(stubs_text(("set",)), ()), {"set": find}, {"set": -1})
    answers, call = [], CALL(stubs["set"])
    for error in (ValueError, KeyboardInterrupt):
        with pytest.raises(error):
            answers.append(call(1, 2, 3, 4))
    assert (answers, call(1, 2, 3, 4)) == ([], 0o1234)


def test_groups_have_all_accessors_and_no_part_lacks_a_function():
    assert len(FILES) == len(set(FILES))
    assert {symbol for group in GROUPS for symbol in group.symbols} == set(SYMBOLS)
    defined = {line.split("@")[1].split("(")[0] for line in text().splitlines() if line.startswith("define")}
    exported = {line.split("@")[1].split("(")[0] for line in text().splitlines() if line.startswith("define") and " internal " not in line}
    assert exported - {"unbox_real"} <= set(SYMBOLS) <= defined
    assert len(part_of(text(), ("get_python",))) < len(part_of(text(), SYMBOLS)) / 3


def test_systems_without_stubs_have_all_accessors_at_once():
    assert all(whole()[symbol] for symbol in SYMBOLS)


def test_code_is_found_in_the_cache_without_a_stub_in_between():
    """Here the suite's cache; a process of its own has none (below)."""
    made, group = Accessors(), next(group for group in GROUPS if group.symbols == ("get_kept",))
    made.make(group)
    assert Accessors()["get_kept"] != Accessors()._stubs["get_kept"]
    assert made["get_kept"] == Accessors()["get_kept"]


PROCESS = """
import threading
import rosetta_jit as rj
from rosetta_jit.runtime.attributes import code
made, failing = [], []
def make(accessors, group, real=code.Accessors.make):
    if group.name in failing:
        raise MemoryError(group.name)
    made.append(group.name)
    real(accessors, group)
code.Accessors.make = make
type_ = "geometry_msgs/msg/PoseStamped"
decode, encode = (each.of(type_, encoding="cdr") for each in (rj.Decoder, rj.Encoder))
assert made == ["first holders"], made
first = decode.holder_type
assert decode(encode(decode.new())) is not None
del made[:]
failing += ["scalar f64", "messages within messages"]
pose = decode.new().pose.position
for attempt in (lambda: pose.x, lambda: setattr(pose, "x", 1.0)):
    try:
        attempt()
    except MemoryError as error:
        assert str(error) == "scalar f64"
    else:
        raise AssertionError("it should have failed")
del failing[:]
barrier, seen = threading.Barrier(4), []
def work(number):
    own = first()
    barrier.wait()
    own.pose.position.x = float(number)
    own.header.frame_id = "f" * number
    seen.append((own.pose.position.x, own.header.frame_id) == (number, "f" * number) and own == own)
threads = [threading.Thread(target=work, args=(number,)) for number in range(4)]
for each in threads: each.start()
for each in threads: each.join()
assert seen == [True] * 4, seen
pose.x = 2.5
assert pose.x == 2.5 and {"scalar f64", "texts and bytes", "sameness"} <= set(made), made
made.clear()
holders = [first() for _ in range(20)]
del holders, pose
assert made == [], made
"""


def test_a_process_without_a_cache_compiles_what_it_calls():
    surroundings = {"PATH": "", "ROSETTA_JIT_CACHE": "off", "PYTHONPATH": ":".join(sys.path)}
    subprocess.run([sys.executable, "-c", PROCESS], check=True, env=surroundings)


def test_the_cache_is_asked_for_a_group_when_an_address_of_it_is(monkeypatch):
    """A process pays for the groups that its types need."""
    asked = []
    monkeypatch.setattr(code, "known", asked.append)
    accessors = Accessors()
    assert asked == []
    address = accessors["get_f64"]
    assert accessors["get_f64"] == address
    assert asked == ["accessors: scalar f64"]
    assert accessors["set_f64"]
    assert asked == ["accessors: scalar f64"]
