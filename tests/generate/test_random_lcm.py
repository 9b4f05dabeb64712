"""Random types of LCM in generated Python and C++, with classes of its own and lcm-gen's: they do what the library does."""

from __future__ import annotations

import random
import subprocess
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import Wishes, generated
from rosetta_jit.generate.c.words import RESERVED
from rosetta_jit.generate.cpp.objects.walk import IDENTIFIER
from tests.frameworks.lcm import declarations
from tests.frameworks.lcm.lcm_files import LCM_GEN
from tests.generate import cpp, native
from tests.generate.cpp import QUICK
from tests.generate.driver import answers, harmed
from tests.generate.python import answers_as_the_library, module
from tests.generate.test_cpp import BOTH, same

if TYPE_CHECKING:
    from rosetta_jit.api.decoder import Decoder
    from rosetta_jit.api.encoder import Encoder

FOUND = given(found=declarations.files(3), seed=st.integers(0, 1 << 32))
LONG = settings(deadline=None, suppress_health_check=list(HealthCheck), max_examples=30)


class Case:
    """A random type, and messages of it: whole ones, cut and altered ones, and the whole ones again."""

    def __init__(self, found: list[declarations.Declared], seed: int) -> None:
        assume(all(member.name not in RESERVED for each in found for member in each.members))
        chance, types, name = random.Random(seed), {each.name: each for each in found}, found[-1].name
        self.text, type_ = declarations.text_of(found), f"{declarations.PACKAGE}.{name}"
        options: dict[str, Any] = {"encoding": "lcm", "schema": {"a.lcm": self.text}}
        self.request = type_request("decode", type_, options)
        self.programs: tuple[Decoder, Encoder] = rj.Decoder.of(type_, **options), rj.Encoder.of(type_, **options)
        write, holder = self.programs[1], self.programs[0].holder_type
        good = [bytes(write(holder.from_dict(declarations.random_value(name, types, chance)))) for _ in range(8)]
        self.messages = [*good, *harmed(good[:5], 12, str(seed)), *good]

    def in_cpp(self, folder, wishes: Wishes, *options: str) -> None:
        name = cpp.write(folder, generated(self.request, "cpp", BOTH, "unit", wishes))
        same(answers(cpp.program(folder, name, options=(*QUICK, *options)), self.messages), *self.programs, self.messages)


@pytest.mark.campaign
@LONG
@FOUND
def test_python(found, seed):
    made = Case(found, seed)
    for numpy in (False, True):
        answers_as_the_library(module(made.request, wishes=Wishes(numpy=numpy)), made.programs, made.messages)


@pytest.mark.campaign
@cpp.needs_cpp
@LONG
@FOUND
def test_classes_of_our_own(found, seed, tmp_path_factory):
    Case(found, seed).in_cpp(tmp_path_factory.mktemp("own"), Wishes())


@pytest.mark.campaign
@cpp.needs_cpp
@LONG
@FOUND
def test_classes_of_lcm_gen(found, seed, tmp_path_factory):
    """Fields are called there as they are declared, which is refused of names that C++ may use itself; what lcm-gen makes of arrays as
    long as a constant does not compile.
    """
    assume(not any(each.constants for each in found))
    assume(all(IDENTIFIER.fullmatch(member.name) for each in found for member in each.members))
    if not native.finds("lcm/lcm_coretypes.h"):
        pytest.skip("LCM's headers are not installed")
    made, folder = Case(found, seed), tmp_path_factory.mktemp("theirs")
    (folder / "a.lcm").write_text(made.text)
    subprocess.run([LCM_GEN, "--cpp", "--cpp-hpath", folder, folder / "a.lcm"], check=True, capture_output=True)
    made.in_cpp(folder, Wishes(holder="lcm"), "-isystem", str(folder))
