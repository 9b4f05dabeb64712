"""Objects for other machines, and the header through which C calls them."""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest
from llvmlite import binding

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.cli import main
from rosetta_jit.generate.build import object_of
from tests.generate import test_c
from tests.generate.driver import answers, driver_of_object, expected, harmed, needs_gcc, write
from tests.generate.test_c import BOTH, TORSO, joint_states, proto_angles

SUBJECTS = {
    "joints": ("sensor_msgs/JointState", "ros1", joint_states()),
    "angles": ("rst.kinematics.JointAngles", "protobuf", proto_angles()),
}
MACHINES = ["aarch64-linux-gnu", "armv7-linux-gnueabihf", "thumbv7em-none-eabihf", "riscv64-linux-gnu", "wasm32-unknown-unknown"]

LINKED = [
    ("aarch64-linux-gnu", "aarch64-linux-gnu-gcc", "qemu-aarch64"),
    ("armv7-linux-gnueabihf", "arm-linux-gnueabihf-gcc", "qemu-arm"),
    ("riscv64-linux-gnu", "riscv64-linux-gnu-gcc", "qemu-riscv64"),
]
TORSO_MESSAGES = test_c.SUBJECTS["torso"][1]


@needs_gcc
@pytest.mark.parametrize("name", SUBJECTS)
def test_an_object_answers_as_the_library_does(name, tmp_path):
    type_, encoding, good = SUBJECTS[name]
    options = {"encoding": encoding}
    write(tmp_path, object_of(type_request("decode", type_, options), BOTH, name, binding.get_default_triple()))
    decode, encode = rj.Decoder.of(type_, **options), rj.Encoder.of(type_, **options)
    messages = harmed(good, 8, name)
    found = answers(driver_of_object(tmp_path, name), messages)
    assert found == [expected(decode, encode, message) for message in messages]


@needs_gcc
def test_the_header_is_one_of_c_plus_plus_too_and_says_that_its_implementation_is_not(tmp_path):
    write(tmp_path, object_of(TORSO, BOTH, "torso", binding.get_default_triple()))
    (tmp_path / "main.cpp").write_text(
        '#include "torso.h"\ntorso_status is_there(torso_holder &holder) { return torso_size(&holder, nullptr, nullptr); }\n'
    )
    command = ["gcc", "-std=c++17", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsyntax-only", "main.cpp"]
    subprocess.run(command, cwd=tmp_path, check=True)
    refused = subprocess.run([*command, "-DTORSO_IMPLEMENTATION"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert refused.returncode != 0
    assert "what follows is C: define TORSO_IMPLEMENTATION in a file of C" in refused.stderr
    assert refused.stderr.count("error:") == 1


@pytest.mark.parametrize("triple", MACHINES)
def test_objects_of_other_machines_need_nothing_of_cpython(triple):
    texts = object_of(TORSO, ("decode",), "torso", triple)
    code = texts["torso.o"]
    assert len(code) > 500
    assert b"torso_decode_kernel" in code
    assert not re.search(rb"_?Py[A-Z_]", code)
    assert "torso_decode_kernel(" in texts["torso.h"]


def elf_flags(code: bytes) -> int:
    """Those of a machine, which a linker compares: where it has 64 bits, the offsets before them are wider."""
    return int.from_bytes(code[48:52] if code[4] == 2 else code[36:40], "little")


def test_floats_go_in_registers_where_the_machine_is_said_to_pass_them_there():
    """Else no linker of these machines puts the object beside anything: `linux` stands where a vendor may, and LLVM knows no rv64gc."""
    assert elf_flags(object_of(TORSO, ("decode",), "torso", "riscv64-linux-gnu")["torso.o"]) & 0x6 == 0x4
    vfp_args = b"\x1c\x01"  # Tag_ABI_VFP_args: VFP registers
    for triple in ("armv7-linux-gnueabihf", "armv7-unknown-linux-gnueabihf", "thumbv7em-none-eabihf"):
        attributes = object_of(TORSO, ("decode",), "torso", triple)["torso.o"].partition(b"aeabi\0")[2]
        assert vfp_args in attributes[:80], triple


@pytest.mark.parametrize(("triple", "compiler", "runner"), LINKED)
def test_objects_run_on_other_machines(triple, compiler, runner, tmp_path):
    if shutil.which(compiler) is None or shutil.which(runner) is None:
        pytest.skip(f"{compiler} and {runner} are not installed")
    write(tmp_path, object_of(TORSO, BOTH, "torso", triple))
    decode, encode = (make(TORSO.mapping, encoding="yarp3") for make in (rj.Decoder, rj.Encoder))
    messages = harmed(TORSO_MESSAGES, 12, triple)
    found = answers(driver_of_object(tmp_path, "torso", compiler, ("-O2", "-static", "-ffp-contract=off")), messages, runner)
    assert found == [expected(decode, encode, message) for message in messages]


def test_a_small_machine_needs_little(tmp_path):
    """Of the mapping's own code on a Cortex-M7: at most 3 KB."""
    if shutil.which("size") is None:
        pytest.skip("binutils are not installed")
    path = tmp_path / "torso.o"
    path.write_bytes(object_of(TORSO, BOTH, "torso", "thumbv7em-none-eabihf", "cortex-m7")["torso.o"])
    text = subprocess.run(["size", path], capture_output=True, text=True, check=True).stdout.splitlines()[1].split()[0]
    assert 0 < int(text) <= 3072


def test_the_header_of_an_object_can_do_without_a_c_library():
    for freestanding, wanted in ((True, set()), (False, {"string.h"})):
        text = object_of(TORSO, BOTH, "torso", "thumbv7em-none-eabihf", "cortex-m7", freestanding=freestanding)["torso.h"]
        assert set(re.findall(r"#include <(.*)>", text)) - {"stdbool.h", "stddef.h", "stdint.h", "float.h"} == wanted


@pytest.mark.parametrize(
    ("arguments", "kind"),
    [
        (["--target", "s390x-linux-gnu"], "no-target"),
        (["--target", "abacus"], "no-target"),
        (["--language", "cobol"], "no-object"),
    ],
)
def test_what_has_no_object_is_said(arguments, kind, capsys):
    assert main(["generate", "yarp/icub/torso_state.mapping", "--encoding", "yarp3", "--emit", "object", *arguments]) == 1
    assert f"error[{kind}]" in capsys.readouterr().err
