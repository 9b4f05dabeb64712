"""The Python backend prints the same readable text every time, and nothing of a schema reaches it unescaped."""

from __future__ import annotations

import ast
from dataclasses import replace

import pytest

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.backends.python.function import compile_python, python_text
from rosetta_jit.kernel.ir import Site
from rosetta_jit.kernel.nodes import Let, Local, Require, Return
from rosetta_jit.kernel.terms import BEGIN, index
from tests.backends import kernels
from tests.backends.engines import outcome
from tests.backends.holders import rows
from tests.golden import GOLDEN, check_golden

HOSTILE = (
    "__import__('os').abort()",
    "x\nimport os",
    '"""',
    "'",
    "class",
    "None",
    "kernel",
    "used_0",
    "é",
    "",
    "1",
    "_",
    "a b",
    "a_b",
    "lanes",
    "bytes",
)


@pytest.mark.parametrize("kernel", kernels.DECODERS, ids=lambda kernel: kernel.name)
def test_golden_source(kernel):
    check_golden(GOLDEN / "backends" / f"{kernel.name}.py.txt", python_text(kernel))


def test_hostile_names_are_mangled():
    lets = tuple(Let(name, index(number)) for number, name in enumerate(HOSTILE))
    sites = tuple(Site("truncated", name, name) for name in HOSTILE)
    for position, name in enumerate(HOSTILE):
        body = (Require(BEGIN, index(1), kernels.failure(position)), *lets, Return(Local("i64", name)))
        kernel = replace(kernels.kernel(body, strides=(8,)), name=name, sites=sites)
        tree = ast.parse(python_text(kernel))
        assert {type(each).__name__ for each in tree.body} == {"ImportFrom", "FunctionDef"}
        assert outcome("python", kernel, b"x", rows(kernel))[0] == position


def test_identifiers_are_unique_and_stable():
    names = Namespace(frozenset({"for"}))
    made = [names.identifier(name) for name in ("a b", "a.b", "for", "a" * 200, "a" * 201, "a b")]
    assert len(set(made)) == 5
    assert made[0] == made[5]
    assert all(name.isidentifier() and name != "for" for name in made)


def test_functions_are_callable_by_name():
    assert compile_python(kernels.text()).__name__ == "kernel"
