"""Compilers have nothing to say about generated C++, however they optimise: each sees other variables that are needless."""

from __future__ import annotations

import shutil

import pytest

from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import generated
from tests.generate import cpp

TYPES = [
    pytest.param("std_msgs/Empty", {"encoding": "ros1", "framework": "ros1"}, id="neither size nor encoder can fail"),
    pytest.param("geometry_msgs/Twist", {"encoding": "ros1", "framework": "ros1"}, id="the size is known"),
    pytest.param("diagnostic_msgs/DiagnosticArray", {"encoding": "cdr", "framework": "ros2"}, id="nobody asks how many rows are in use"),
]
OPTIONS = [("-Og",), ("-O1", "-fsanitize=address,undefined"), ("-O2", "-std=c++20", "-fno-exceptions")]


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
@pytest.mark.parametrize(("type_", "options"), TYPES)
def test_no_variable_is_needless_or_without_a_value(type_, options, compiler, tmp_path):
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    for directions in (("decode", "encode"), ("decode",), ("encode",)):
        name = cpp.write(tmp_path, generated(type_request("decode", type_, options), "cpp", directions, "unit"))
        for each in OPTIONS if len(directions) == 2 else [("-Og", "-fsyntax-only")]:
            cpp.compiled(compiler, tmp_path, name, *each)
