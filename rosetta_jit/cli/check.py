"""`rosetta-jit check`: all mistakes of some mappings, and nothing else."""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from contextlib import suppress

from rosetta_jit.catalogue import pipeline as words
from rosetta_jit.cli.arguments import Commands, add_command, add_mappings, mappings_of
from rosetta_jit.diagnostics import Diagnostic, render_all, to_json
from rosetta_jit.errors import ReportError
from rosetta_jit.terminal import printable

MAX_LISTED = 1_000
"""Diagnostics of one mapping that are listed as JSON; more are counted."""


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "check", "Report what is wrong with mappings and the schemas that they import.", run)
    add_mappings(command)
    command.add_argument("--encoding", help="the messages' encoding, which tells ROS 1 from ROS 2")
    command.add_argument("--framework", help="whose imported files are that several frameworks can read")
    command.add_argument("--log", metavar="LOG", help="check them for the messages of a log: in its encoding")
    command.add_argument("--strict", action="store_true", help="warnings are errors")
    command.add_argument("--json", action="store_true", help="one JSON object a mapping, on stdout")


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if any mapping has an error; warnings are shown, and forgiven unless `--strict` is given."""
    encoding = _encoding_of(arguments.log) if arguments.log and not arguments.encoding else arguments.encoding
    reports = [(each, _diagnostics(each, encoding, arguments.framework)) for each in mappings_of(arguments)]
    for mapping, diagnostics in reports:
        if arguments.json:
            print(json.dumps(_plain(mapping, diagnostics)))
        elif diagnostics:
            print(render_all(diagnostics), _summary(mapping, diagnostics), sep="\n\n", end="\n\n", file=sys.stderr)
    counted = ("error", "warning") if arguments.strict else ("error",)
    return int(any(diagnostic.severity in counted for _, diagnostics in reports for diagnostic in diagnostics))


def _encoding_of(name: str) -> str:
    """That of all messages of a log."""
    from rosetta_jit.catalogue.logs import several_encodings
    from rosetta_jit.errors import LogError
    from rosetta_jit.logs.log import open_log

    with open_log(name) as log:
        encodings = sorted({each.encoding for each in log.connections} - {""})
    if len(encodings) != 1:
        raise LogError((several_encodings(name, encodings),))
    return encodings[0]


def _plain(mapping: str, diagnostics: tuple[Diagnostic, ...]) -> dict[str, object]:
    shown = diagnostics[:MAX_LISTED]
    return {"mapping": mapping, "diagnostics": [to_json(each) for each in shown], "more": len(diagnostics) - len(shown)}


def _summary(mapping: str, diagnostics: tuple[Diagnostic, ...]) -> str:
    """How many of each a mapping has."""
    counts = Counter(each.severity for each in diagnostics)
    counted = [f"{count} {severity}{'' if count == 1 else 's'}" for severity, count in sorted(counts.items())]
    return f"{printable(mapping)}: {', '.join(counted)}"


def _diagnostics(mapping: str, encoding: str | None, framework: str | None) -> tuple[Diagnostic, ...]:
    import rosetta_jit

    try:
        checked = rosetta_jit.check(mapping, encoding=encoding, framework=framework)
    except ReportError as error:
        other = None if encoding or framework else _without_mistakes(mapping)
        return error.diagnostics if other is None else (*error.diagnostics, words.other_framework(mapping, other))
    return (*checked.warnings, *checked.notes)


def _without_mistakes(mapping: str) -> str | None:
    """The framework by whose language the imported files, and so the mapping, have no mistakes; None if there is none."""
    import rosetta_jit
    from rosetta_jit.frameworks.installed import installed

    every = installed().values()
    for framework in every:
        if any(framework is not other and set(framework.idl) & set(other.idl) for other in every):
            with suppress(ReportError):
                rosetta_jit.check(mapping, framework=framework.name)
                return framework.name
    return None
