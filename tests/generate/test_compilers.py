"""Compilers have nothing to say about generated C++, however they optimise: each sees other variables that are needless."""

from __future__ import annotations

import shutil

import pytest

from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import generated
from tests.generate import cpp

ROS1, ROS2 = {"encoding": "ros1", "framework": "ros1"}, {"encoding": "cdr", "framework": "ros2"}
TYPES = {
    "empty": ("std_msgs/Empty", ROS1),
    "twist": ("geometry_msgs/Twist", ROS1),
    "diagnostics": ("diagnostic_msgs/DiagnosticArray", ROS2),
}
"""One whose size and encoder cannot fail, one whose size is known, and one of which nobody asks how many rows are in use."""
OPTIONS = [
    ("-Og",),
    ("-O1", "-fsanitize=address,undefined", "-fno-sanitize-address-use-after-scope"),
    ("-O2", "-std=c++20", "-fno-exceptions"),
]
CHECKED = ("-Og", "-fsyntax-only")


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
@pytest.mark.parametrize(
    ("directions", "options"),
    [*((("decode", "encode"), each) for each in OPTIONS), (("decode",), CHECKED), (("encode",), CHECKED)],
)
def test_no_variable_is_needless_or_without_a_value(directions, options, compiler, tmp_path):
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    units = [generated(type_request("decode", *of), "cpp", directions, unit) for unit, of in TYPES.items()]
    cpp.compiled(compiler, tmp_path, cpp.write_as_one(tmp_path, "units", units), *options)
