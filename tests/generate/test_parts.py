"""Large kernels are printed for Lisp in parts, which do what the whole does."""

from __future__ import annotations

import re
from collections import Counter
from functools import cache

import pytest

from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import generated, unit_of
from rosetta_jit.generate.lisp import parts
from rosetta_jit.kernel.nodes import Call, Let
from rosetta_jit.kernel.walk import flat
from tests.generate import lisp, test_kernels_in_lisp, test_lisp
from tests.generate.kernels_in_lisp import loaded

LARGE = type_request("decode", "visualization_msgs/msg/InteractiveMarkerUpdate", {"encoding": "cdr"})
DOWN_TO = {"LARGE": 15, "MAX_NODES": 12, "OF_CALL": 3}


@pytest.fixture
def small_parts(monkeypatch):
    """Kernels in parts that are as small as they can be."""
    for name, value in DOWN_TO.items():
        monkeypatch.setattr(parts, name, value)
    loaded.cache_clear()
    yield
    loaded.cache_clear()


@cache
def bodies():
    return [body for kernel in unit_of(LARGE, ("decode", "encode"), "large").kernels.values() for body in kernel.bodies]


def own(block):
    """The statements without those that have blocks inside, which differ where a part stands in one."""
    return Counter(stmt for stmt in flat(block) if not isinstance(stmt, Call) and not hasattr(stmt, "body") and not hasattr(stmt, "then"))


@pytest.mark.parametrize("body", bodies(), ids=range(len(bodies())))
def test_parts_have_all_statements_and_few_nodes(body):
    found = parts.parted(body, "large")
    blocks = [found.body, *found.blocks.values()]
    assert len(blocks) > 2
    assert max(map(parts.weight, blocks)) <= parts.MAX_NODES
    assert sum(map(own, blocks), Counter()) == own(body)
    names = list(found.blocks)
    calls = {name: [stmt.routine for stmt in flat(block) if isinstance(stmt, Call)] for name, block in found.blocks.items()}
    assert all(names.index(called) < names.index(name) for name in names for called in calls[name] if called in names)


def test_locals_of_one_part_are_not_spilled():
    body = bodies()[0]
    found = parts.parted(body, "large")
    bound = {stmt.name for stmt in flat(body) if isinstance(stmt, Let)}
    spilled = set(found.spilled(frozenset(bound)))
    assert spilled
    for name in bound:
        users = [block for block in (found.body, *found.blocks.values()) if name in parts.names_in(block)]
        assert (len(users) > 1) == (name in spilled)


def test_a_large_kernel_is_several_functions():
    text = generated(LARGE, "lisp", ("decode", "encode"), "large")["large.lisp"]
    assert "(defun decode.1.1 (codec data end)" in text
    assert re.search(r"\(run-part \(decode\.1\.1 codec data end\) decode\.1(\.\d+)?\)", text)


@lisp.needs_sbcl
def test_parts_answer_as_the_library_does(tmp_path, small_parts):
    test_lisp.test_lisp_answers_as_the_library_does(tmp_path)


@lisp.needs_sbcl
def test_parts_allocate_nothing_for_numbers(tmp_path, small_parts):
    test_lisp.test_numbers_are_read_and_written_without_allocating(tmp_path)


@lisp.needs_sbcl
@pytest.mark.parametrize("kernel", test_kernels_in_lisp.OF_ONE_MESSAGE, ids=lambda each: each.name)
def test_kernels_in_parts_do_what_the_interpreter_says(kernel, small_parts):
    test_kernels_in_lisp.test_decodes_like_the_interpreter(kernel)
