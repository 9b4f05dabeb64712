"""Products and sums of generated C and C++ are rounded as the library's are, also by compilers that would make one operation of them."""

from __future__ import annotations

import random
import shutil
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of
from rosetta_jit.generate.build import generated
from rosetta_jit.generate.passes.roundings import TWO_ROUNDINGS
from tests.generate import cpp, driver

BOTH = ("decode", "encode")
FILES = {
    "a.msg": "float64 x\nfloat64 y\nfloat32 z\nfloat32 w\n",
    "b.proto": 'syntax = "proto3"; package b; message B { double x = 1; double y = 2; float z = 3; float w = 4; }',
    "m.mapping": """import "a.msg"
import "b.proto"
data-holder: b.B
wire-schema: a
unpack-rules:
  .x = .x * .y + 0.1
  .y = .x * .x - .y * .y
  .z = .z * .w + float32(0.1)
  .w = .w
pack-rules:
  .x = .x * .y - .y
  .y = .y
  .z = .z * .w + .w
  .w = .w
""",
}
OPTIONS = {"schema": FILES, "encoding": "ros1", "framework": "ros1"}
FMA = ("-O2", "-mfma")
CONTRACTED = {"gcc": "-ffp-contract=fast", "g++": "-ffp-contract=fast", "clang": "-ffp-contract=on", "clang++": "-ffp-contract=on"}
"""What compilers do by themselves: gcc not in strict C."""
MACHINES = {
    "gcc": ("gcc", (*FMA, CONTRACTED["gcc"]), ()),
    "clang": ("clang", (*FMA, CONTRACTED["clang"]), ()),
    "aarch64": ("aarch64-linux-gnu-gcc", ("-O2", "-static", CONTRACTED["gcc"]), ("qemu-aarch64",)),
}


def request():
    return request_of("decode", OPTIONS, mapping="m.mapping")


def messages() -> list[bytes]:
    """Numbers of which most products are rounded."""
    chance, write = random.Random(19), rj.Encoder.of("a", imports=["a.msg"], **OPTIONS)
    return [bytes(write({name: chance.uniform(-3, 3) for name in "xyzw"})) for _ in range(200)]


def wanted() -> list[str]:
    decode, encode = (make("m.mapping", **OPTIONS) for make in (rj.Decoder, rj.Encoder))
    return [driver.expected(decode, encode, each) for each in messages()]


def needs(*programs: str) -> None:
    """Skip where one is not installed, or this machine has no such operation."""
    for each in programs:
        if shutil.which(each) is None:
            pytest.skip(f"{each} is not installed")
    if len(programs) == 1 and " fma " not in Path("/proc/cpuinfo").read_text():
        pytest.skip("this machine has no operation for a product and a sum")


@pytest.mark.parametrize("machine", MACHINES)
def test_c(machine, tmp_path):
    compiler, options, runner = MACHINES[machine]
    needs(compiler, *runner)
    name = driver.write(tmp_path, generated(request(), "c", BOTH, "unit"))
    assert driver.answers(driver.driver(tmp_path, name, compiler, options), messages(), *runner) == wanted()


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
def test_cpp(compiler, tmp_path):
    needs(compiler)
    name = cpp.write(tmp_path, generated(request(), "cpp", BOTH, "unit"))
    assert driver.answers(cpp.program(tmp_path, name, compiler=compiler, options=(*FMA, CONTRACTED[compiler])), messages()) == wanted()


@pytest.mark.parametrize("language", ["c", "cpp"])
def test_nothing_is_said_where_there_is_no_sum(language):
    asked = request_of("decode", {"encoding": "yarp3"}, mapping="yarp/icub/torso_state.mapping")
    assert TWO_ROUNDINGS in generated(request(), language, BOTH, "unit")[f"unit.{language}"]
    assert TWO_ROUNDINGS not in generated(asked, language, BOTH, "unit")[f"unit.{language}"]
