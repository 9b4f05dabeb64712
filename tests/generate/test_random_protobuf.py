"""Random schemas of protobuf in generated Python and C++: what they read, write and refuse is what the library does."""

from __future__ import annotations

import random
from pprint import pformat
from typing import TYPE_CHECKING, Any

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import Wishes, generated
from tests.frameworks.protobuf.random_schemas import Writer, schema
from tests.generate import cpp, native
from tests.generate.cpp import CAREFUL, QUICK
from tests.generate.driver import answers, expected, harmed
from tests.generate.python import answer, module, same

if TYPE_CHECKING:
    from pathlib import Path

BOTH = ("decode", "encode")
MESSAGES = 60
FIRST, BEHIND = 5000, 5040
"""The seeds of a campaign."""


class Case:
    """A random schema, and messages of it: whole ones, those of a careless writer, cut and altered ones, and the first ones again."""

    def __init__(self, seed: int, *, is_plain: bool = False) -> None:
        chance = random.Random(f"generated {seed}")
        self.text, fields = schema(chance)
        self.options: dict[str, Any] = {"encoding": "protobuf", "schema": {"t.proto": self.text}}
        self.request = type_request("decode", "t.A", self.options)
        self.programs = rj.Decoder.of("t.A", **self.options), rj.Encoder.of("t.A", **self.options)
        writer = Writer(fields, chance, pads=not is_plain)
        written = [writer.message("A") for _ in range(MESSAGES)]
        self.messages = written if is_plain else [*written, *harmed(written[:5], 12, str(seed)), *written[:20]]

    def in_python(self, wishes: Wishes) -> None:
        unit = module(self.request, BOTH, wishes)
        self.holds([answer(unit, message) for message in self.messages])

    def written(self, folder: Path, wishes: Wishes) -> str:
        return cpp.write(folder, generated(self.request, "cpp", BOTH, "unit", wishes))

    def holds(self, found: list[str]) -> None:
        """All lines are the library's."""
        for line, message in zip(found, self.messages, strict=True):
            wanted = expected(*self.programs, message)
            assert same(line, wanted) or self.holds_the_same(line, wanted), (self.text, message.hex(), line, wanted)

    def holds_the_same(self, found: str, wanted: str) -> bool:
        """Whether two messages differ in the order of bytes alone, or in the entries of maps whose key comes again: a dict keeps one."""
        if not (found.startswith("ok ") and wanted.startswith("ok ")):
            return False
        one, other = (bytes.fromhex(each[3:]) for each in (found, wanted))
        decode, _ = self.programs
        return sorted(one) == sorted(other) or ("map<" in self.text and pformat(decode(one).to_dict()) == pformat(decode(other).to_dict()))


def test_python():
    Case(0).in_python(Wishes())


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(FIRST, BEHIND))
def test_python_of_many(seed):
    made = Case(seed)
    for numpy in (False, True):
        made.in_python(Wishes(numpy=numpy))


@pytest.mark.campaign
@cpp.needs_cpp
@pytest.mark.parametrize("seed", range(FIRST, BEHIND))
def test_classes_of_our_own(seed, tmp_path):
    made = Case(seed)
    program = cpp.program(tmp_path, made.written(tmp_path, Wishes()), options=(QUICK, CAREFUL)[seed % 2])
    made.holds(answers(program, made.messages))


@pytest.mark.campaign
@cpp.needs_cpp
@pytest.mark.parametrize("seed", range(FIRST, BEHIND))
def test_classes_of_protoc(seed, tmp_path):
    """Without tags that are longer than they need be: protoc's classes write those of unknown fields in their shortest form."""
    made = Case(seed, is_plain=True)
    if "edition" in made.text:
        pytest.skip("this protoc may know no editions")
    native.protoc(tmp_path, "t", made.text)
    unit = made.written(tmp_path, Wishes(holder="protobuf", include="t.pb.h"))
    made.holds(answers(native.program_of_protoc(tmp_path, unit, "t", QUICK), made.messages))
