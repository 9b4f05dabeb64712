"""`rosetta-jit info`: what a log has, by its index."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING

from rosetta_jit.cli.arguments import Commands, add_command
from rosetta_jit.cli.logs import add_log, log_of
from rosetta_jit.terminal import printable

if TYPE_CHECKING:
    from rosetta_jit.logs.log import Log


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "info", "Show what a log has: topics, types, counts and times.", run)
    add_log(command)
    command.add_argument("--json", action="store_true", help="one JSON object, on stdout")


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if something is wrong with the log, as far as its index shows."""
    with log_of(arguments) as log:
        print(json.dumps(_facts(log)) if arguments.json else _text(log))
        return int(bool(log.problems))


def _facts(log: Log) -> dict[str, object]:
    channels = [
        {"topic": each.topic, "type": each.type, "encoding": each.encoding, "schema_encoding": each.schema_encoding, "count": each.count}
        for each in log.channels
    ]
    times = {"start_ns": log.start, "end_ns": log.end}
    return {"log": log.name, "format": log.format, **times, "facts": log.facts, "channels": channels}


def _text(log: Log) -> str:
    from rosetta_jit.logs.moments import shown

    facts = {"format": log.format, **log.facts}
    if log.start is not None and log.end is not None:
        facts |= {"start": shown(log.start), "end": shown(log.end), "duration": f"{(log.end - log.start) / 1e9:.3f} s"}
    rows = [("topic", "messages", "type", "encoding")]
    rows += [(each.topic, "?" if each.count is None else str(each.count), each.type or "?", each.encoding) for each in log.channels]
    widths = [max(len(row[column]) for row in rows) for column in range(4)]
    lines = [f"{row[0]:<{widths[0]}}  {row[1]:>{widths[1]}}  {row[2]:<{widths[2]}}  {row[3]}".rstrip() for row in rows]
    return "\n".join(printable(line) for line in [log.name, *(f"{name + ':':<13}{value}" for name, value in facts.items()), "", *lines])
