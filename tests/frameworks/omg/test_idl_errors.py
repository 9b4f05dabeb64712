"""Each wrong file has a report of its own, and omniidl refuses it too; those in ``ours`` need what omniidl does not know or check."""

from __future__ import annotations

import pytest

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.omg.idl import parse
from tests.frameworks.omg.idl_files import WRONG, load_from, names, needs_omniidl, omniidl, source
from tests.golden import check_golden

FILES = names(WRONG)


def refused(name):
    """What is wrong with a file, or why nothing in it can be represented."""
    with pytest.raises(SchemaError) as caught:
        raise SchemaError(tuple(parse(source(WRONG, name), load_from(WRONG)).left_out.values()))
    return caught.value


@pytest.mark.parametrize("name", FILES)
def test_report(name):
    check_golden((WRONG / name).with_suffix(".err"), f"{refused(name)}\n")


@needs_omniidl
@pytest.mark.parametrize("name", [name for name in FILES if not name.startswith("ours/")])
def test_omniidl_refuses_it_too(name):
    assert omniidl("-bdump_ast", f"-p{str(__file__).rpartition('/')[0]}", WRONG / name).returncode != 0


def test_every_diagnostic_points_at_its_place():
    for name in FILES:
        assert all(problem.span and problem.label for problem in refused(name).diagnostics)
