"""Every shipped mapping in each language: compilers have nothing to say, and messages become what the library makes of them."""

from __future__ import annotations

import random
import re
import shutil
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of
from rosetta_jit.errors import MappingError, SchemaError
from rosetta_jit.generate.build import NO_WISHES, generated
from tests.generate import cpp, driver, lisp, python
from tests.generate.cpp import QUICK
from tests.generate.python import module
from tests.language.test_shipped_laws import ROOT, SHIPPED
from tests.runtime.test_shipped_growth import damaged, encoding, likely, messages

if TYPE_CHECKING:
    from pathlib import Path

    from rosetta_jit.pipeline.request import Request

ROUNDS = 24
COMPILERS = {"c": ("gcc", "clang"), "cpp": ("g++", "clang++")}
SAMPLE = {"packed/gamepad.mapping", "ros1/nav_sat_fix_utm.mapping"}
NOT_GENERATED = {"ros1/compressed_image.mapping"}
"""Its kernels call what compresses."""

ALL = [pytest.param(name, marks=() if name in SAMPLE else pytest.mark.campaign) for name in SHIPPED if name not in NOT_GENERATED]


@dataclass(frozen=True)
class Case:
    """A shipped mapping: the directions that it has, the library's programs for them, and messages of its wire."""

    request: Request
    directions: tuple[str, ...]
    messages: list[bytes]
    options: dict[str, Any]

    @property
    def is_both(self) -> bool:
        return len(self.directions) == 2

    @property
    def ways(self) -> list[tuple[str, ...]]:
        """What is asked for: each direction alone, and both."""
        return [*((each,) for each in self.directions), self.directions][: 2 * len(self.directions) - 1]

    def programs(self) -> tuple[rj.Decoder, rj.Encoder]:
        """The library's, which have had no message."""
        return tuple(make(self.request.mapping, **self.options) for make in (rj.Decoder, rj.Encoder))

    def wanted(self) -> list[str]:
        programs = self.programs()
        return [driver.expected(*programs, each) for each in self.messages]


@cache
def case(name: str) -> Case:
    options = {"encoding": encoding(name)}
    request = request_of("decode", options, mapping=name)
    directions = tuple(each for each in ("decode", "encode") if goes(request, each))
    rng = random.Random(name)
    good = encoded(name, options, rng) if "encode" in directions else []
    found = [*messages(name, ROUNDS, rng), *good, *(damaged(each, rng) for each in good)]
    return Case(request, directions, found, options)


def encoded(name: str, options: dict[str, Any], rng: random.Random) -> list[bytes]:
    """What the library writes of random holders."""
    checked, write = rj.check(name).checked, rj.Encoder(name, **options)
    texts = ["x", "", *re.findall(r'"([^"\n]*)"', (ROOT / name).read_text("utf-8"))]
    found = list[bytes]()
    for _ in range(10 * ROUNDS):
        try:
            found.append(bytes(write(write.holder_type.from_dict(likely(checked.holder.root, checked.holder.schema, texts, rng)))))
        except rj.EncodeError:
            continue
        if len(found) == ROUNDS:
            break
    return found


def goes(request: Request, direction: str) -> bool:
    try:
        generated(request, "c", (direction,), "unit")
    except (MappingError, SchemaError):
        return False
    return True


def installed(language: str) -> list[str]:
    return [each for each in COMPILERS[language] if shutil.which(each) is not None]


def roomy(folder: Path, name: str) -> tuple[str, ...]:
    """Options that give a lane, which nothing bounds, room for any of the messages."""
    header = (folder / f"{name}.h").read_text()
    return tuple(
        f"-D{line.split()[1]}=20000" for line in header.splitlines() if line.startswith("#ifndef UNIT_") and not line.endswith("_H")
    )


@driver.needs_gcc
@pytest.mark.parametrize("name", ALL)
def test_in_c(name, tmp_path):
    made = case(name)
    for directions in made.ways:
        unit = driver.write(tmp_path, generated(made.request, "c", directions, "unit"))
        for compiler in installed("c"):
            driver.compiled(compiler, tmp_path, unit, "-fsyntax-only" if compiler == "clang" else "-O2")
    if made.is_both:
        unit = driver.write(tmp_path, generated(made.request, "c", made.directions, "unit"))
        program = driver.driver(tmp_path, unit, options=(*QUICK, *roomy(tmp_path, unit)))
        for line, wanted in zip(driver.answers(program, made.messages), made.wanted(), strict=True):
            assert line == wanted or (line.startswith("full ") and not wanted.startswith("ok "))


@cpp.needs_cpp
@pytest.mark.parametrize("name", ALL)
def test_in_cpp(name, tmp_path):
    made = case(name)
    units = {f"to_{'_'.join(directions)}": directions for directions in made.ways}
    texts = [generated(made.request, "cpp", directions, unit) for unit, directions in units.items()]
    name = cpp.write_as_one(tmp_path, "units", texts)
    for compiler in installed("cpp"):
        if compiler == "clang++" or not made.is_both:
            cpp.compiled(compiler, tmp_path, name)
    if made.is_both:
        program = cpp.program(tmp_path, name, options=QUICK, units=("to_decode_encode",))
        assert driver.answers(program, made.messages, unit="to_decode_encode") == made.wanted()


@pytest.mark.parametrize("name", ALL)
def test_in_python(name):
    made = case(name)
    units = [module(made.request, directions, NO_WISHES) for directions in made.ways]
    if made.is_both:
        for message, wanted in zip(made.messages, made.wanted(), strict=True):
            assert python.same(python.answer(units[-1], message), wanted), message.hex()


@lisp.needs_sbcl
@pytest.mark.parametrize("name", ALL)
def test_in_lisp(name, tmp_path):
    made = case(name)
    if not made.is_both:
        pytest.skip("the driver needs both directions")
    (found,) = lisp.answers(tmp_path, [(made.request, made.messages)])
    for line, wanted in zip(found, lisp.expected(made.request, *made.programs(), made.messages), strict=True):
        assert line == wanted or ("memory than its size allows" in line and wanted.split("]")[0].split()[0] == line.split()[0]), line
