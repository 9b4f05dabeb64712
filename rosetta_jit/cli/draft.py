"""`rosetta-jit draft`: propose a mapping between two types."""

from __future__ import annotations

import argparse
import sys

from rosetta_jit.cli.arguments import Commands, add_command


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "draft", "Propose a mapping between two types, by their names, types, units and structure.", run)
    command.add_argument("holder", metavar="TYPE_A", help="type of the data holder: rst.geometry.Pose")
    command.add_argument("wire", metavar="TYPE_B", help="type of the wire: geometry_msgs/Pose")
    command.add_argument("--import", dest="imports", metavar="FILE", action="append", default=[], help="a file that declares one of them")
    command.add_argument("--encoding", help="encoding of the wire, which tells ROS 1 from ROS 2")


def run(arguments: argparse.Namespace) -> int:
    """Print the mapping; exit code 1 if the checker refuses it, with what it says on stderr."""
    from rosetta_jit.diagnostics import render_all
    from rosetta_jit.draft.draft import draft, worth_telling

    text, problems = draft(arguments.holder, arguments.wire, imports=arguments.imports, encoding=arguments.encoding)
    print(text, end="")
    wrong = worth_telling(problems)
    if wrong:
        print(render_all(wrong), file=sys.stderr)
    return int(bool(wrong))
