"""Each wrong file has a report of its own."""

from __future__ import annotations

from pathlib import Path

import pytest

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.orocos import compiler, header, typelib
from rosetta_jit.source import Source
from tests.golden import GOLDEN, check_golden

FOLDER = GOLDEN / "orocos"
FILES = sorted(path.name for path in FOLDER.iterdir() if path.suffix in {".hpp", ".tlb"})


def load(name):
    path = FOLDER / name
    return Source(name, path.read_text()) if path.is_file() else None


def refused(name):
    parse = typelib.parse if Path(name).suffix == ".tlb" else header.parse
    with pytest.raises(SchemaError) as caught:
        parse(Source(name, (FOLDER / name).read_text()), load)
    return caught.value


@pytest.mark.parametrize("name", FILES)
def test_report(name):
    check_golden((FOLDER / name).with_suffix(f"{Path(name).suffix}.err"), f"{refused(name)}\n")


@pytest.mark.parametrize("name", FILES)
def test_every_diagnostic_points_at_its_place(name):
    assert all(problem.span and problem.label for problem in refused(name).diagnostics)


def test_says_what_to_install_without_libclang(monkeypatch, tmp_path):
    (tmp_path / "sitecustomize.py").write_text("import sys; sys.modules['clang'] = None")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(SchemaError, match=r"rosetta-jit\[orocos\]"):
        header.parse(Source("a.hpp", "struct A { int x; };"), load)


def test_a_compiler_that_dies_is_a_report(monkeypatch, tmp_path):
    program = tmp_path / "dies.py"
    program.write_text("import os; os.abort()")
    monkeypatch.setattr(compiler, "PROGRAM", program)
    with pytest.raises(SchemaError, match="too much time or memory"):
        header.parse(Source("a.hpp", "struct A { int x; };"), load)
