"""`rosetta-jit demo`: the main job on bundled recordings."""

from __future__ import annotations

import argparse
import sys
from importlib.util import find_spec
from pathlib import Path

from rosetta_jit.cli.arguments import Commands, add_command


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(
        commands, "demo", "Play recordings of an iCub through compiled kernels; print a table and draw what was decoded.", run
    )
    command.add_argument("--output", metavar="DIR", default="demo-output", help="where the pictures go (default: demo-output)")


def run(arguments: argparse.Namespace) -> int:
    """Print the table and the names of the pictures."""
    missing = [name for name in ("matplotlib", "PIL") if find_spec(name) is None]
    if missing:
        print(f"error: the demo draws with {' and '.join(missing)}: pip install 'rosetta-jit[demo]'", file=sys.stderr)
        return 1
    from rosetta_jit.demo.play import play, table

    report = play(Path(arguments.output))
    print(table(report))
    for picture in report.pictures:
        print(f"wrote {picture}")
    return 0
