"""Compilers have nothing to say about generated C++, however they optimise: each sees other variables that are needless."""

from __future__ import annotations

import shutil

import pytest

from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import generated
from tests.generate import cpp
from tests.generate.driver import SANITIZED

ROS1, ROS2 = {"encoding": "ros1", "framework": "ros1"}, {"encoding": "cdr", "framework": "ros2"}
TYPES = {
    "empty": ("std_msgs/Empty", ROS1),
    "twist": ("geometry_msgs/Twist", ROS1),
    "diagnostics": ("diagnostic_msgs/DiagnosticArray", ROS2),
    "signals": ("t/Signals", ROS1 | {"schema": {"t/Signals.msg": "std_msgs/Empty[] signals\nstd_msgs/Empty[2] pair\n"}}),
    "tree": ("t.tree_t", {"schema": {"t.lcm": "package t; struct tree_t { int32_t n; string names[n]; tree_t branches[n]; }"}}),
}
"""One whose size and encoder cannot fail, one whose size is known, one of which nobody asks how many rows are in use, lists whose elements
have nothing, and messages within others behind a loop."""
BOTH = ("decode", "encode")
CHECKED = ("-Og", "-fsyntax-only", "-Wshadow")
WAYS = [
    ("g++", BOTH, ("-Og", "-Wshadow")),
    ("g++", BOTH, SANITIZED),
    ("g++", BOTH, ("-O2", "-std=c++20", "-fno-exceptions")),
    ("clang++", BOTH, CHECKED),
    ("clang++", BOTH, (*CHECKED, "-std=c++20", "-fno-exceptions")),
    *((compiler, (each,), CHECKED) for compiler in ("g++", "clang++") for each in BOTH),
]
"""What clang has to say it knows before it optimises."""


@pytest.mark.parametrize(("compiler", "directions", "options"), WAYS)
def test_no_variable_is_needless_or_without_a_value(compiler, directions, options, tmp_path):
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    units = [generated(type_request("decode", *of), "cpp", directions, unit) for unit, of in TYPES.items()]
    cpp.compiled(compiler, tmp_path, cpp.write_as_one(tmp_path, "units", units), *options)
