"""Each wrong file has a report of its own, and lcm-gen refuses it too, save where its code could not be used."""

from __future__ import annotations

import pytest

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.lcm.idl import parse
from rosetta_jit.source import Source
from tests.frameworks.lcm.lcm_files import STRICTER, WRONG, nothing, refused
from tests.golden import check_golden

FILES = sorted(path.relative_to(WRONG).as_posix() for path in WRONG.rglob("*.lcm"))


def report(name):
    with pytest.raises(SchemaError) as caught:
        parse(Source(name, (WRONG / name).read_text("utf-8")), nothing)
    return caught.value


@pytest.mark.parametrize("name", FILES)
def test_report(name):
    check_golden((WRONG / name).with_suffix(".err"), f"{report(name)}\n")


@pytest.mark.parametrize("name", FILES)
def test_every_diagnostic_points_at_its_place(name):
    assert all(problem.span and problem.label for problem in report(name).diagnostics)


@pytest.mark.parametrize("name", FILES)
def test_lcm_gen_refuses_it_too(name):
    assert refused(WRONG / name) == ((WRONG / name).parent != STRICTER)
