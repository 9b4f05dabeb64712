"""The text of kernels, as golden files."""

from __future__ import annotations

import pytest

from rosetta_jit.kernel.nodes import Const, Let, Return
from rosetta_jit.kernel.printer import to_text
from rosetta_jit.kernel.terms import index
from tests.golden import GOLDEN, check_golden
from tests.kernel import kernels


@pytest.mark.parametrize("name", kernels.ALL)
def test_text_is_as_before(name):
    check_golden(GOLDEN / "kernel" / f"{name}.txt", to_text(kernels.ALL[name]))


def test_different_kernels_have_different_texts():
    def text(value: Const, name: str = "x") -> str:
        return to_text(kernels.kernel((Let(name, value), Return(index(0)))))

    values = [Const("i64", 1), Const("u64", 1), Const("f64", 1.0), Const("f64", -0.0), Const("f64", 0.0), Const("bool", value=True)]
    assert len({text(value) for value in values}) == len(values)


def test_hostile_names_stay_on_their_line():
    name = "x = 1\nreturn 7"
    text = to_text(kernels.kernel((Let(name, index(3)), Return(index(0)))))
    assert "let 'x = 1\\nreturn 7' = 3\n" in text
