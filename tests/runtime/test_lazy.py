"""Lazy binding: functions that are found when they are first called, and the accessors, which are compiled so."""

from __future__ import annotations

import ctypes
import subprocess
import sys

import pytest

from rosetta_jit.runtime.attributes import code
from rosetta_jit.runtime.attributes.code import FILES, SYMBOLS, Accessors, text, whole
from rosetta_jit.runtime.attributes.groups import GROUPS
from rosetta_jit.runtime.callable import is_native
from rosetta_jit.runtime.code import native
from rosetta_jit.runtime.code.assembler import assembled
from rosetta_jit.runtime.code.lazy import Stubs, is_supported
from rosetta_jit.runtime.code.parts import part_of

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
    stubs = Stubs({"one": lambda: find("one"), "two": lambda: find("two")}, {})

    def find(name):
        found.append(name)
        stubs.bind(name, sum_code["sum"])

    for name in ("two", "one", "two", "one"):
        assert CALL(stubs[name])(1, 2, 3, 4) == 0o1234
    assert found == ["two", "one"]


def test_stubs_of_the_same_names_are_apart(sum_code):
    """Each has tables of its own, which refer to what ends with it."""
    found = list[str]()

    def stubs(name):
        def find():
            found.append(name)
            made.bind("sum", sum_code["sum"])

        made = Stubs({"sum": find}, {})
        return made

    kept, gone = stubs("kept"), stubs("gone")
    assert kept["sum"] != gone["sum"]
    del gone
    assert CALL(kept["sum"])(1, 2, 3, 4) == 0o1234
    assert found == ["kept"]


def test_a_function_that_is_not_found_fails_and_is_looked_for_again(sum_code):
    errors = [ValueError("first"), KeyboardInterrupt("second")]

    def find():
        if errors:
            raise errors.pop(0)
        stubs.bind("set", sum_code["sum"])

    stubs = Stubs({"set": find}, {"set": -1})
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
assert made == [], made
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


def surroundings():
    return {"PATH": "", "ROSETTA_JIT_CACHE": "off", "PYTHONPATH": ":".join(sys.path)}


def test_a_process_without_a_cache_compiles_what_it_calls():
    subprocess.run([sys.executable, "-c", PROCESS], check=True, env=surroundings())


FEW = """
import weakref
import rosetta_jit as rj
from rosetta_jit.runtime.attributes.code import is_compiled
decode, encode = (each.of("geometry_msgs/msg/PoseStamped", encoding="cdr") for each in (rj.Decoder, rj.Encoder))
holder_type = decode.holder_type
def made():
    return type.__call__(holder_type)
first = [made() for _ in range(4)]
def are_gone(seen):
    return [each() for each in seen] == [None] * len(seen)
assert are_gone([weakref.ref(made().lanes_)])
assert not is_compiled("equip") and not is_compiled("end_holder")
position = made().pose.position
assert position.x == 0.0 and first[0].pose is first[0].pose
others = [holder_type() for _ in range(4)]
assert is_compiled("equip") and is_compiled("end_holder")
for number, (one, other) in enumerate(zip(first, others)):
    assert one == other and one.to_dict() == other.to_dict()
    one.pose.position.x = other.pose.position.x = number + 0.5
    one.header.frame_id = other.header.frame_id = "f" * number
    assert encode(one) == encode(other) and decode(encode(one)) == other
ended = [weakref.ref(each) for each in first]
del first, one
assert are_gone(ended) and position.x == 0.0
again = [holder_type() for _ in range(4)]
assert all(each == again[0] and each.pose.position.x == 0.0 for each in again)
"""

MANY = """
import rosetta_jit as rj
from rosetta_jit.runtime.attributes.code import is_compiled
from rosetta_jit.runtime.limits import FEW_HOLDERS
decode = rj.Decoder.of("geometry_msgs/msg/Twist", encoding="cdr")
holders = []
while not is_compiled("equip"):
    holders.append(type.__call__(decode.holder_type))
assert len(holders) == FEW_HOLDERS + 1, len(holders)
assert all(each == holders[-1] for each in holders)
"""


@pytest.mark.parametrize("program", [FEW, MANY])
def test_a_few_holders_are_made_and_ended_without_compiled_code(program):
    subprocess.run([sys.executable, "-c", program], check=True, env=surroundings())


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
