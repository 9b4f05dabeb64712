"""`rosetta-jit convert`: messages of a log into a table, or into another log."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from rosetta_jit.cli.arguments import Commands, add_command
from rosetta_jit.cli.logs import add_decoding, add_log, add_selection, log_of, one_topic, progress, target_of, topics_of

if TYPE_CHECKING:
    import argparse

    from rosetta_jit.logs.channel import Channel
    from rosetta_jit.logs.log import Log

ON_ERROR = ("stop", "skip", "quarantine")


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "convert", "Write messages of a log as a table, or as another log.", run)
    add_log(command)
    add_selection(command)
    add_decoding(command)
    command.add_argument(
        "-o",
        "--output",
        metavar="OUT",
        required=True,
        help="a table of one topic (.parquet, .arrow, .csv, .npz), or a log (.mcap, .bag, .lcmlog)",
    )
    command.add_argument("--to", choices=("ros2",), help="of a log of ROS 1: write its messages as those of ROS 2")
    command.add_argument("--columns", metavar="A,B.C", help="these fields alone, with dots those of nested messages")
    command.add_argument("--flatten", action="store_true", help="each field of a nested message is a column, named with dots")
    command.add_argument("--header-time", action="store_true", help="a further column with the time of `header.stamp`")
    command.add_argument(
        "--on-error",
        choices=ON_ERROR,
        default="stop",
        help="what becomes of a message that its type does not allow (default: stop); quarantine writes it to OUT.quarantine.jsonl",
    )


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if something is wrong with the log, or if messages were left out; 2 if options do not go together."""
    from rosetta_jit.logs.converting import TABLES

    output = Path(arguments.output)
    misplaced = _misplaced(arguments, of_tables=output.suffix not in TABLES)
    if misplaced:
        kind = "a table" if output.suffix in TABLES else "a log, whose messages are not decoded"
        print(f"error: {', '.join(misplaced)} cannot be used: {output.name} is {kind}", file=sys.stderr)
        return 2
    with log_of(arguments) as log:
        if output.suffix in TABLES:
            topic = one_topic(log, topics_of(arguments))
            target = target_of(arguments)
            return _table(log, log[topic] if target is None else log[topic, target], output, arguments)
        return _log(log, output, arguments)


def _misplaced(arguments: argparse.Namespace, *, of_tables: bool) -> list[str]:
    """The options that were given and do nothing: those that tables alone have, or those that logs alone have."""
    if not of_tables:
        return ["--to"] if arguments.to else []
    given = {
        "--mapping": arguments.mapping,
        "--type": arguments.type,
        "--columns": arguments.columns,
        "--flatten": arguments.flatten,
        "--header-time": arguments.header_time,
        "--on-error": arguments.on_error != "stop",
    }
    return [option for option, value in given.items() if value]


def _table(log: Log, channel: Channel, output: Path, arguments: argparse.Namespace) -> int:
    from rosetta_jit.logs.channel import CLOCKS
    from rosetta_jit.logs.converting import Conversion

    options = {"start": arguments.start, "end": arguments.end, "flatten": arguments.flatten}
    options |= {"clocks": (*CLOCKS, "header_time")} if arguments.header_time else {}
    options |= {"columns": arguments.columns.split(",")} if arguments.columns else {}
    with progress(channel.count) as advance:
        conversion = Conversion(channel, output, arguments.on_error, advance, options=options)
        conversion.run()
    if conversion.left_out:
        where = f"; they are in {conversion.quarantine}" if arguments.on_error == "quarantine" else ""
        print(f"{conversion.left_out} messages of {channel.topic} could not be decoded and were left out{where}", file=sys.stderr)
    return int(bool(conversion.left_out or log.problems))


def _log(log: Log, output: Path, arguments: argparse.Namespace) -> int:
    from rosetta_jit.logs.base import Wanted
    from rosetta_jit.logs.converting import copy_log
    from rosetta_jit.logs.translating import translate_log

    topics = topics_of(arguments)
    channels = log.channels if topics is None else tuple(log[each] for each in topics)
    numbers = None if topics is None else frozenset(one.number for each in channels for one in each.connections)
    counts = [each.count for each in channels]
    with progress(None if None in counts else sum(each or 0 for each in counts)) as advance:
        wanted = Wanted(numbers, arguments.start, arguments.end)
        if arguments.to == "ros2":
            translate_log(log, channels, output, wanted, folders=arguments.search_path, advance=advance)
        else:
            copy_log(log, channels, output, wanted, advance)
    return int(bool(log.problems))
