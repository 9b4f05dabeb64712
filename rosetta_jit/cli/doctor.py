"""`rosetta-jit doctor`: what is wrong with a log, in words."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING

from rosetta_jit.cli.advice import report
from rosetta_jit.cli.arguments import Commands, add_command, add_search_path
from rosetta_jit.cli.logs import add_log, log_of, progress
from rosetta_jit.diagnostics import to_json

if TYPE_CHECKING:
    from rosetta_jit.logs.log import Log


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "doctor", "Read and decode all of a log, and say what is wrong with it.", run)
    add_log(command)
    add_search_path(command)
    command.add_argument("--no-decode", action="store_true", help="read the messages, but do not decode them")
    command.add_argument("--json", action="store_true", help="one JSON object, on stdout")


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if something is wrong."""
    from rosetta_jit.logs.examining import Examination

    with log_of(arguments, str) as log:
        examination = Examination(log, decode=not arguments.no_decode)
        with progress(_total(log), quiet=arguments.json) as advance:
            found = examination.run(advance)
        count = sum(each.count for each in examination.seen.values())
        if arguments.json:
            print(json.dumps({"log": log.name, "messages": count, "problems": [to_json(each) for each in found]}))
        else:
            counted = "1 problem" if len(found) == 1 else f"{len(found) or 'no'} problems"
            print("\n".join([*map(report, found), f"{log.name}: {count} messages read, {counted}"]))
    return int(bool(found))


def _total(log: Log) -> int | None:
    counts = [each.count for each in log.channels]
    return None if None in counts else sum(each or 0 for each in counts)
