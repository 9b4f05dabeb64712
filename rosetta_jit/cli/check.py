"""`rosetta-jit check`: all mistakes of some mappings, and nothing else."""

from __future__ import annotations

import json
import sys
from collections import Counter
from typing import TYPE_CHECKING, cast

from rosetta_jit.cli.arguments import Commands, add_command, add_mappings
from rosetta_jit.diagnostics import Diagnostic, render_all, to_json
from rosetta_jit.errors import ReportError
from rosetta_jit.terminal import printable

if TYPE_CHECKING:
    import argparse

MAX_LISTED = 1_000
"""Diagnostics of one mapping that are listed as JSON; more are counted."""


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "check", "Report what is wrong with mappings and the schemas that they import.", run)
    add_mappings(command)
    command.add_argument("--strict", action="store_true", help="warnings are errors")
    command.add_argument("--json", action="store_true", help="one JSON object a mapping, on stdout")


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if any mapping has an error; warnings are shown, and forgiven unless `--strict` is given."""
    reports = [(mapping, _diagnostics(mapping)) for mapping in cast("list[str]", arguments.mappings)]
    for mapping, diagnostics in reports:
        if arguments.json:
            print(json.dumps(_plain(mapping, diagnostics)))
        elif diagnostics:
            print(render_all(diagnostics), _summary(mapping, diagnostics), sep="\n\n", end="\n\n", file=sys.stderr)
    counted = ("error", "warning") if arguments.strict else ("error",)
    return int(any(diagnostic.severity in counted for _, diagnostics in reports for diagnostic in diagnostics))


def _plain(mapping: str, diagnostics: tuple[Diagnostic, ...]) -> dict[str, object]:
    shown = diagnostics[:MAX_LISTED]
    return {"mapping": mapping, "diagnostics": [to_json(each) for each in shown], "more": len(diagnostics) - len(shown)}


def _summary(mapping: str, diagnostics: tuple[Diagnostic, ...]) -> str:
    """How many of each a mapping has."""
    counts = Counter(each.severity for each in diagnostics)
    told = [f"{count} {severity}{'' if count == 1 else 's'}" for severity, count in sorted(counts.items())]
    return f"{printable(mapping)}: {', '.join(told)}"


def _diagnostics(mapping: str) -> tuple[Diagnostic, ...]:
    import rosetta_jit

    try:
        checked = rosetta_jit.check(mapping)
    except ReportError as error:
        return error.diagnostics
    return (*checked.warnings, *checked.notes)
