"""`rosetta-jit compile`: compile mappings now, so that later processes load them from the cache."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, cast

from rosetta_jit.cli.arguments import Commands, add_command, add_encoding, add_mappings, add_parameters, encoding_of, parameters_of

if TYPE_CHECKING:
    import argparse

DIRECTIONS = ("decode", "encode")


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "compile", "Compile mappings in both directions and keep the kernels in the cache.", run)
    add_mappings(command)
    add_encoding(command)
    add_parameters(command)
    command.add_argument("--direction", choices=DIRECTIONS, action="append", help="only this direction, for mappings that have no other")


def run(arguments: argparse.Namespace) -> int:
    """One line a kernel: how long it took to compile or to load."""
    import rosetta_jit

    programs = {"decode": rosetta_jit.Decoder, "encode": rosetta_jit.Encoder}
    for mapping in cast("list[str]", arguments.mappings):
        for direction in cast("list[str] | None", arguments.direction) or DIRECTIONS:
            started = time.perf_counter()
            programs[direction](mapping, encoding=encoding_of(arguments), parameters=parameters_of(arguments))
            print(f"{mapping}: {direction} ready in {1000 * (time.perf_counter() - started):.1f} ms")
    return 0
