"""Help of everything answers at once: neither numpy nor the compiler is imported."""

from __future__ import annotations

import subprocess
import sys

import pytest

from rosetta_jit.cli import COMMANDS, main

ASK = """
import sys
from rosetta_jit.cli import main
try:
    main(sys.argv[1:])
except SystemExit as end:
    print(end.code)
heavy = {"numpy", "numba", "llvmlite", "lark", "google.protobuf", "tqdm", "matplotlib", "PIL"} & set(sys.modules)
assert not heavy, heavy
"""


@pytest.mark.parametrize(
    "arguments", [["--help"], ["--version"], *([command.__name__.rpartition(".")[2], "--help"] for command in COMMANDS)]
)
def test_help_imports_nothing_heavy(arguments):
    answer = subprocess.run([sys.executable, "-c", ASK, *arguments], check=True, capture_output=True, text=True)
    assert answer.stdout.endswith("0\n")
    assert "rosetta-jit" in answer.stdout
    assert answer.stderr == ""


@pytest.mark.parametrize("arguments", [[], ["unknown"], ["decode"], ["cache", "eat"], ["dump", "m", "--stage", "x"]])
def test_a_wrong_command_line_is_exit_code_2(arguments, capsys):
    with pytest.raises(SystemExit) as end:
        main(arguments)
    assert end.value.code == 2
    assert "usage: rosetta-jit" in capsys.readouterr().err
