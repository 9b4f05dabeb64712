"""Object code: what it exports and wants, that it vectorises, and that it is exact."""

from __future__ import annotations

import re

import pytest

from rosetta_jit.backends.link import SYMBOLS, assembly, compile_program, llvm_text
from rosetta_jit.runtime import native
from tests.backends import kernels

PROGRAMS = [("decode", (kernels.counted(),)), ("borrow", (kernels.tagged(),)), ("encode", kernels.encoder())]


@pytest.mark.parametrize(("entry", "program"), PROGRAMS)
@pytest.mark.parametrize("with_numba", [False, True])
def test_programs_link_with_nothing_but_what_is_allowed(entry, program, with_numba):
    image = compile_program(program, entry, with_numba=with_numba)
    wanted = native.undefined_symbols(image)
    assert wanted <= native.ALLOWED
    assert "PyObject_Vectorcall" in wanted
    library = native.load(image, SYMBOLS[entry])
    assert all(library[symbol] for symbol in SYMBOLS[entry])


@pytest.mark.parametrize("with_numba", [False, True])
def test_the_same_bytes_every_time(with_numba):
    images = {compile_program([kernels.fixed(3)], "decode", with_numba=with_numba) for _ in range(2)}
    assert len(images) == 1 or with_numba  # numba counts its functions, and their mangled names reach the string table


@pytest.mark.parametrize("with_numba", [False, True])
def test_loops_vectorise(with_numba):
    text = llvm_text([kernels.specialised()], "decode", with_numba=with_numba)
    assert re.search(r"fmul <\d+ x double>", text)
    assert re.search(r"fptrunc <\d+ x double>", text)
    assert re.search(r"shufflevector <\d+ x i8>", llvm_text([kernels.swapped()], "decode", with_numba=with_numba))


@pytest.mark.parametrize("with_numba", [False, True])
def test_no_arithmetic_is_relaxed(with_numba):
    text = llvm_text([kernels.specialised()], "decode", with_numba=with_numba)
    assert not re.search(r"\b(fast|contract|reassoc|nnan|ninf|nsz|arcp|afn)\b", text)
    assert "fma" not in assembly([kernels.specialised()], "decode", with_numba=with_numba)
