"""Messages of real peers, whole, cut and altered, get the same answers from C as from the library: on this machine and on others."""

from __future__ import annotations

import shutil

import pytest

from rosetta_jit.generate.build import generated, unit_of
from rosetta_jit.kernel.passes.alone import as_proven
from rosetta_jit.kernel.proof.verify import VerificationError, verify
from tests.generate.corpora import corpora
from tests.generate.driver import SANITIZED, answers, driver, expected, harmed, needs_gcc, write

FEW = {"lcm exlcm.example_t", "corba RTC::TimedWString big", "orocos State"}
MACHINES = {
    "gcc": ("gcc",),
    "clang": ("clang",),
    "s390x": ("s390x-linux-gnu-gcc", "qemu-s390x"),
    "aarch64": ("aarch64-linux-gnu-gcc", "qemu-aarch64"),
    "armv7": ("arm-linux-gnueabihf-gcc", "qemu-arm"),
    "riscv64": ("riscv64-linux-gnu-gcc", "qemu-riscv64"),
}
STATIC = ("-O2", "-static", "-ffp-contract=off")


def answered(corpus, folder, compiler, options, runner, rounds):
    """What C and the library say of the messages, in pairs."""
    name = write(folder, generated(corpus.request, "c", ("decode", "encode"), "unit"))
    messages = harmed(list(corpus.messages), rounds, corpus.name)
    decode, encode = corpus.programs()
    found = answers(driver(folder, name, compiler, (*options, *roomy(folder, name))), messages, *runner)
    return list(zip(found, [expected(decode, encode, message) for message in messages], strict=True))


def roomy(folder, name):
    """Options that give a lane, which nothing bounds, the room for any of the messages."""
    header = (folder / f"{name}.h").read_text()
    return [f"-D{line.split()[1]}=40000" for line in header.splitlines() if line.startswith("#ifndef UNIT_") and not line.endswith("_H")]


@pytest.mark.parametrize("corpus", [each for each in corpora() if each.name in FEW], ids=lambda each: each.name)
def test_kernels_for_one_message_are_proven_as_such(corpus):
    for kernel in unit_of(corpus.request, ("decode", "encode"), "unit").kernels.values():
        verify(as_proven(kernel))
        with pytest.raises(VerificationError):
            verify(kernel)  # which speaks of any row of lane 0


@needs_gcc
@pytest.mark.parametrize("corpus", [each for each in corpora() if each.name in FEW], ids=lambda each: each.name)
def test_messages_of_peers(corpus, tmp_path):
    for found, wanted in answered(corpus.of(4), tmp_path, "gcc", SANITIZED, (), 4):
        assert found == wanted


@pytest.mark.campaign
@needs_gcc
@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize("corpus", corpora(), ids=lambda each: each.name)
def test_all_messages_of_peers(corpus, machine, tmp_path):
    compiler, *runner = MACHINES[machine]
    if shutil.which(compiler) is None or any(shutil.which(each) is None for each in runner):
        pytest.skip(f"{compiler} and {runner} are not installed")
    options = STATIC if runner else SANITIZED
    for found, wanted in answered(corpus, tmp_path, compiler, options, runner, 20):
        assert found == wanted
