"""The examples of mappings in the documents, in generated source: random messages of theirs become what the library makes of them."""

from __future__ import annotations

import ast
import dataclasses
import math
import random
import re
from dataclasses import dataclass
from functools import cache
from typing import Any

import pytest

import rosetta_jit as rj
from rosetta_jit.api import programs
from rosetta_jit.api.options import request_of
from rosetta_jit.errors import MappingError
from rosetta_jit.generate.build import NO_WISHES, generated
from tests.generate import cpp, lisp
from tests.generate.cpp import QUICK
from tests.generate.driver import answers, expected, harmed, needs_gcc
from tests.generate.python import answer, module
from tests.generate.python import same as same_line
from tests.generate.through_c import loaded_in_c
from tests.mapping_examples import Example, example, type_of
from tests.runtime.test_shipped_growth import likely
from tests.test_documents import EXAMPLES

ROUNDS = 30
NAMES = list(EXAMPLES)


@dataclass(frozen=True)
class Case:
    """An example: what its programs are made from, the directions that it has, messages of its wire, and holders."""

    made: Example
    directions: tuple[str, ...]
    messages: list[bytes]
    holders: list[dict[str, Any]]

    @property
    def options(self) -> dict[str, Any]:
        return {"schema": self.made.files, "encoding": self.made.encoding, "parameters": self.made.parameters}

    @property
    def request(self):
        return request_of("decode", self.options, mapping=self.made.mapping)

    def program(self, direction: str):
        return {"decode": rj.Decoder, "encode": rj.Encoder}[direction](self.made.mapping, **self.options)

    def programs(self):
        return self.program("decode"), self.program("encode")

    def wanted(self) -> list[str]:
        pair = self.programs()
        return [expected(*pair, each) for each in self.messages]


@cache
def case(name: str) -> Case:
    return case_of(name, example(EXAMPLES[name]))


def case_of(name: str, made: Example) -> Case:
    """With messages and holders that the name alone decides."""
    rng = random.Random(name)
    found = Case(made, (), [], [])
    directions = tuple(each for each in ("decode", "encode") if goes(found, each))
    checked = rj.check(made.mapping, schema=made.files).checked
    texts = ["x", "", *re.findall(r'"([^"\n]*)"', made.files[made.mapping])]
    wire = type_of(next(iter(made.files)), next(iter(made.files.values())))
    write = rj.Encoder.of(wire, schema=made.files, imports=[next(iter(made.files))], encoding=made.encoding)
    shown = [ast.literal_eval(each) for line in made.values for each in re.split(r" <->| <-| ->", line)[:1] if each.startswith("{")]
    values = [*shown, *(likely(checked.wire.root, checked.wire.schema, texts, rng) for _ in range(ROUNDS))]
    good = [bytes(each) for each in (written(write, each) for each in values) if each is not None]
    holders = [likely(checked.holder.root, checked.holder.schema, texts, rng) for _ in range(ROUNDS)]
    holders += [ast.literal_eval(part) for line in made.values for part in re.split(r" <-> | <- | -> ", line)[1:] if part.startswith("{")]
    if len(directions) == 2:
        good += [bytes(each) for each in (written(found.program("encode"), each) for each in holders) if each is not None]
    return Case(made, directions, [*good, *harmed(good, 2, name)], holders)


def goes(found: Case, direction: str) -> bool:
    try:
        found.program(direction)
    except MappingError:
        return False
    return True


def written(write, values: dict[str, Any]) -> Any:
    try:
        return write(write.holder_type.from_dict(values))
    except rj.EncodeError:
        return None


def decoded(decode, message: bytes) -> Any:
    try:
        return plain(decode(message).to_dict())
    except rj.DecodeError as error:
        return f"{error.kind} {error.offset} [{error.path}] {error.detail}"


def encoded(encode, values: dict[str, Any]) -> Any:
    try:
        return bytes(encode(encode.holder_type.from_dict(values)))
    except rj.EncodeError as error:
        return f"{error.kind} [{error.path}] {error.detail}"


def plain(value: Any) -> Any:
    """A value in which a NaN equals another one."""
    match value:
        case dict():
            return {name: plain(each) for name, each in value.items()}
        case list() | tuple():
            return [plain(each) for each in value]
        case float():
            return "nan" if math.isnan(value) else value.hex()
        case _:
            return value


@needs_gcc
@pytest.mark.campaign
@pytest.mark.parametrize("name", NAMES)
def test_in_c(name, monkeypatch):
    made = case(name)
    wanted = [results(made, each) for each in made.directions]
    monkeypatch.setattr(programs, "loaded_of", loaded_in_c)
    assert [results(made, each) for each in made.directions] == wanted


def results(made: Case, direction: str) -> list[Any]:
    """What comes of all messages, or of all holders."""
    program = made.program(direction)
    if direction == "decode":
        return [decoded(program, each) for each in made.messages]
    return [encoded(program, each) for each in made.holders]


@cpp.needs_cpp
@pytest.mark.campaign
@pytest.mark.parametrize("name", NAMES)
def test_in_cpp(name, tmp_path):
    made = case(name)
    unit = cpp.write(tmp_path, generated(made.request, "cpp", made.directions, "unit"))
    if len(made.directions) == 2:
        assert answers(cpp.program(tmp_path, unit, options=QUICK), made.messages) == made.wanted()
    else:
        cpp.compiled("g++", tmp_path, unit)


@pytest.mark.parametrize("name", NAMES)
def test_in_python(name):
    made = case(name)
    unit = module(made.request, made.directions, NO_WISHES)
    if len(made.directions) == 2:
        for message, wanted in zip(made.messages, made.wanted(), strict=True):
            found = answer(unit, message)
            assert same_line(found, wanted), (message.hex(), found, wanted)
    elif made.directions == ("decode",):
        decode = made.program("decode")
        for message in made.messages:
            assert alike(read(unit, message), decoded(decode, message)), message.hex()


def read(unit, message: bytes) -> Any:
    try:
        return plain(dataclasses.asdict(unit.decode(message)))
    except unit.DecodeError as error:
        return f"{error.kind} {error.offset} [{error.path}] {error.detail}{f' ({error.line})' if error.line else ''}"


def alike(found: Any, wanted: Any) -> bool:
    """Enums are numbers in generated Python, and names in the library's dictionaries."""
    match found, wanted:
        case dict(), dict():
            return all(alike(each, wanted.get(name)) for name, each in found.items() if name != "unknown_fields")
        case list(), list():
            return len(found) == len(wanted) and all(map(alike, found, wanted))
        case int(), str():
            return not wanted.startswith(("0x", "-0x"))
        case _:
            return found == wanted


@lisp.needs_sbcl
@pytest.mark.campaign
@pytest.mark.parametrize("name", NAMES)
def test_in_lisp(name, tmp_path):
    made = case(name)
    if len(made.directions) != 2:
        pytest.skip("the program around Lisp writes what it reads")
    (found,) = lisp.answers(tmp_path, [(made.request, made.messages)])
    for line, wanted in zip(found, lisp.expected(made.request, *made.programs(), made.messages), strict=True):
        assert line == wanted or ("memory than its size allows" in line and wanted.split()[0] == line.split()[0])
