"""Random relations in generated source: each language unpacks, packs and refuses what the library does."""

from __future__ import annotations

import random
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import request_of
from rosetta_jit.generate.build import NO_WISHES, generated
from tests.generate import cpp, lisp, python
from tests.generate.driver import answers, driver, expected, needs_gcc, write
from tests.generate.python import module
from tests.random_mappings.blocks import Relations
from tests.random_mappings.conditional import conditional
from tests.random_mappings.defaults import defaulted, demanded
from tests.random_mappings.hostile import altered
from tests.random_mappings.sums import sums
from tests.random_mappings.test_relations import mappings, pair_of, relations, sides
from tests.random_mappings.test_wires import counted
from tests.random_mappings.wires import WIRES

if TYPE_CHECKING:
    from pathlib import Path

    from tests.random_mappings.relations import Part
    from tests.random_mappings.test_wires import Side

BOTH = ("decode", "encode")
MESSAGES = 16

WORDS_OF_A_LIMIT = "more memory than its size allows"
"""How Lisp says what the library has other words for."""


@dataclass(frozen=True)
class Case:
    """A random mapping with messages of its wire, whole and altered: what the library says of each that it reads, and writes again."""

    request: Any
    programs: tuple[rj.Decoder, rj.Encoder]
    messages: list[bytes]
    about: Any

    def holds(self, found: list[str]) -> None:
        """All lines are the library's."""
        for line, message in zip(found, self.messages, strict=True):
            wanted = expected(*self.programs, message)
            assert alike(line, wanted), (self.about, message, line, wanted)


def alike(found: str, wanted: str) -> bool:
    """A NaN may have another sign, entries of maps come in another order, and C has no memory for what the library refuses as too much."""
    if python.same(found, wanted) or (found.startswith("full ") and wanted.startswith("count ") and "`limit:`" in wanted):
        return True
    is_written = found.startswith("ok ") and wanted.startswith("ok ")
    return is_written and sorted(bytes.fromhex(found[3:])) == sorted(bytes.fromhex(wanted[3:]))


def case(seed: int) -> Case:
    rng, names = random.Random(seed), pair_of(seed)
    return case_of(rng, names, *relations(rng, names))


def case_of(rng: random.Random, names: tuple[str, str], src: Side, dst: Side, parts: list[Part]) -> Case:
    files = {**src.files, **dst.files, **mappings(src, dst, parts)}
    given = {name: value for part in parts for name, (_, value) in part.parameters.items()}
    wire = {"schema": files, **src.wire.options, **src.wire.written}
    write_wire = rj.Encoder.of(src.type_name, imports=list(src.files), **wire)
    messages = list[bytes]()
    for number in range(MESSAGES):
        values = {name: value for part in parts for name, value in part.some_wire(rng).items()}
        data = bytes(write_wire(write_wire.holder_type.from_dict(counted(src, values))))
        messages.append(altered(rng, data) if number % 2 else data)
    options: Any = {**wire, "parameters": given}
    programs = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    return Case(request_of("decode", options, mapping="m.mapping"), programs, messages, (names, files))


def solved(seed: int) -> Case:
    """Sums and differences that are solved together, elements that have their default, rejections that say what packing computes, and
    reductions of some elements.
    """
    rng, names = random.Random(seed), ("ros1", "proto3")
    made = Relations(rng, *(WIRES[each] for each in names), "")
    forms = (sums, demanded, defaulted, conditional) * 2
    parts = [form(made, f"f{number}") for number, form in enumerate(forms)]
    return case_of(rng, names, *sides(rng, names, parts), parts)


def in_c(made: Case, folder: Path) -> None:
    made.holds(answers(driver(folder, write(folder, generated(made.request, "c", BOTH, "unit"))), made.messages))


def in_cpp(made: Case, folder: Path) -> None:
    made.holds(
        answers(cpp.program(folder, cpp.write(folder, generated(made.request, "cpp", BOTH, "unit")), options=cpp.PLAIN), made.messages)
    )


def in_python(made: Case, folder: Path) -> None:
    unit = module(made.request, BOTH, NO_WISHES)
    made.holds([python.answer(unit, message) for message in made.messages])


def in_lisp(made: Case, folder: Path) -> None:
    (found,) = lisp.answers(folder, [(made.request, made.messages)], lisp.QUICKLY)
    wanted = lisp.expected(made.request, *made.programs, made.messages)
    for line, right in zip(found, wanted, strict=True):
        assert bool(re.match("ok ", line)) == bool(re.match("ok ", right)), (made.about, line, right)
        _, message, *values = line.split(" ", 2)
        _, other, *others = right.split(" ", 2)
        about = made.about, line, right
        assert alike(f"ok {message}", f"ok {other}") if line.startswith("ok ") else alike(line, right), about
        assert values == others or WORDS_OF_A_LIMIT in line, about


LANGUAGES = [
    pytest.param(in_c, marks=needs_gcc, id="c"),
    pytest.param(in_cpp, marks=cpp.needs_cpp, id="cpp"),
    pytest.param(in_python, id="python"),
    pytest.param(in_lisp, marks=lisp.needs_sbcl, id="lisp"),
]


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("seed", [1, 43])
def test_what_relations_solve_and_compute(seed, language, tmp_path):
    """The second one has a decoder and an encoder with hidden lanes of other widths, and an encoder with more than what measures."""
    language(solved(seed), tmp_path)


@pytest.mark.campaign
@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("seed", range(60))
def test_campaign(seed, language, tmp_path):
    language(case(seed + 7000), tmp_path)
    language(solved(seed + 7000), tmp_path)
