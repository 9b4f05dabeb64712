"""Every construct of the language, in every language that kernels are printed in: the same values, and the same refusals.

A construct is found in the grammar, and in the records of functions: one that no example has fails `test_every_construct_has_an_example`.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.api import programs
from rosetta_jit.generate.build import NO_WISHES, generated
from tests.constructs.contained import EVERY, contained
from tests.constructs.examples import FILES, MAPPINGS
from tests.generate import cpp, lisp
from tests.generate.cpp import QUICK
from tests.generate.driver import answers, needs_gcc
from tests.generate.python import answer, module
from tests.generate.python import same as same_line
from tests.generate.test_examples import Case, case_of, decoded, encoded, results
from tests.generate.through_c import loaded_in_c
from tests.mapping_examples import Example
from tests.test_documents import EXAMPLES

ROOT = Path(__file__).resolve().parents[2]
NAMES = list(MAPPINGS)
STATE = "state"
"""The one that keeps something from one message to the next."""

SHORT = ("choices", "texts", "keys")
"""What the suite compiles in each language; campaigns compile all."""

ELSEWHERE = {
    "state": "tests/generate/test_state.py",
    "set_state": "tests/generate/test_state.py",
    "several wires": "tests/generate/test_wires.py",
    "function now": "tests/generate/test_python.py",
    "function counter": "tests/generate/test_state.py",
    "function": "tests/language/test_functions.py",
    "to depth": "tests/operations/test_nine_operations.py",
    "arranged": "tests/generate/test_examples.py",
    **{f"function {name}": "tests/lowering/test_compressed.py" for name in ("compress", "decompress")},
    **{f"function image_{name}": "tests/lowering/test_compressed.py" for name in ("width", "height", "channels", "depth")},
}
"""What needs programs of its own, and which test has it: messages one after the other, a clock, a caller's functions, images."""


@cache
def case(name: str) -> Case:
    files = {**FILES, "m.mapping": MAPPINGS[name]}
    parameters = {"names": [4, 5]} if "parameter names" in MAPPINGS[name] else {}
    order = ["t/All.msg", *(each for each in files if each not in ("t/All.msg", "m.mapping")), "m.mapping"]
    made = case_of(name, Example({each: files[each] for each in order}, "m.mapping", None, [], parameters))
    assert made.directions == ("decode", "encode")
    return made


def test_every_construct_has_an_example():
    found = {construct for text in (*MAPPINGS.values(), FILES["t/pt.mapping"]) for construct in contained(text)}
    assert EVERY - found - ELSEWHERE.keys() == set()
    assert ELSEWHERE.keys() <= EVERY
    assert all((ROOT / path).exists() for path in ELSEWHERE.values())


def test_constructs_are_told_apart():
    text = next(each for each in EXAMPLES.values() if "frame.mapping" in each and " by .order" in each)
    rules = text.partition("--- frame.mapping\n")[2].partition("--- values")[0]
    assert contained(rules) >= {"arranged", "function planar", "function rows", "both directions", "operator *"}
    assert "table" not in contained(rules)


@pytest.mark.parametrize("name", NAMES)
def test_messages_are_read(name):
    """Or an example would say nothing: some messages become holders that become messages."""
    made, kept = case(name), 0
    decode, encode = made.programs()
    for each in made.messages[:20]:
        with suppress(rj.DecodeError, rj.EncodeError):
            kept += bool(encode(decode(each)))
    assert kept


@pytest.mark.parametrize("name", NAMES)
def test_in_the_python_backend(name):
    compare(name, "python", 8)


@pytest.mark.parametrize("name", SHORT[:1])
def test_in_numba(name):
    compare(name, "numba", 8)


@pytest.mark.campaign
@pytest.mark.parametrize("backend", ["python", "interpreter", "numba"])
@pytest.mark.parametrize("name", NAMES)
def test_each_in_a_backend(name, backend):
    compare(name, backend, 1)


def compare(name: str, backend: str, every: int) -> None:
    """Every so many messages and holders, in a backend and in LLVM's."""
    made = case(name)
    made = replace(made, messages=made.messages[::every], holders=made.holders[::every])
    decode = rj.Decoder(made.made.mapping, **made.options, backend=backend)
    encode = rj.Encoder(made.made.mapping, **made.options, backend=backend)
    assert [decoded(decode, each) for each in made.messages] == results(made, "decode")
    assert [encoded(encode, each) for each in made.holders] == results(made, "encode")


@pytest.mark.parametrize("name", SHORT)
def test_in_generated_python(name):
    in_generated_python(name)


@pytest.mark.campaign
@pytest.mark.parametrize("name", NAMES)
def test_each_in_generated_python(name):
    in_generated_python(name)


def in_generated_python(name: str) -> None:
    made = case(name)
    unit = module(made.request, made.directions, NO_WISHES)
    for message, wanted in zip(made.messages, made.wanted(), strict=True):
        found = answer(unit, message)
        assert same_line(found, wanted), (message.hex(), found, wanted)


@needs_gcc
@pytest.mark.parametrize("name", SHORT[:1])
def test_in_c(name, monkeypatch):
    in_c(name, monkeypatch)


@needs_gcc
@pytest.mark.campaign
@pytest.mark.parametrize("name", [each for each in NAMES if each != STATE])  # which the bridge into C does not keep
def test_each_in_c(name, monkeypatch):
    in_c(name, monkeypatch)


def in_c(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    made = case(name)
    wanted = [results(made, each) for each in made.directions]
    monkeypatch.setattr(programs, "loaded_of", loaded_in_c)
    assert [results(made, each) for each in made.directions] == wanted


@cpp.needs_cpp
@pytest.mark.parametrize("name", SHORT[:1])
def test_in_cpp(name, tmp_path):
    in_cpp(name, tmp_path)


@cpp.needs_cpp
@pytest.mark.campaign
@pytest.mark.parametrize("name", NAMES)
def test_each_in_cpp(name, tmp_path):
    in_cpp(name, tmp_path)


def in_cpp(name: str, folder: Path) -> None:
    made = case(name)
    unit = cpp.write(folder, generated(made.request, "cpp", made.directions, "unit"))
    main = cpp.encoding_once(folder) if name == STATE else cpp.MAIN
    found = answers(cpp.program(folder, unit, options=QUICK, main=main), made.messages)
    assert found == made.wanted()


@lisp.needs_sbcl
@pytest.mark.parametrize("name", SHORT[:1])
def test_in_lisp(name, tmp_path):
    in_lisp(name, tmp_path, lisp.QUICKLY)


@lisp.needs_sbcl
@pytest.mark.campaign
@pytest.mark.parametrize("name", NAMES)
def test_each_in_lisp(name, tmp_path):
    in_lisp(name, tmp_path)


def in_lisp(name: str, folder: Path, *before: str) -> None:
    made = case(name)
    (found,) = lisp.answers(folder, [(made.request, made.messages)], *before)
    if name == STATE:  # whose messages must not be decoded again to say what is in them
        assert [" ".join(line.split()[:2]) if line.startswith("ok ") else line for line in found] == made.wanted()
        return
    for line, wanted in zip(found, lisp.expected(made.request, *made.programs(), made.messages), strict=True):
        assert line == wanted or ("memory than its size allows" in line and wanted.split()[0] == line.split()[0])
