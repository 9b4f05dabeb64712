"""`rosetta-jit convert`: messages of a log into a table, a folder of tables, or another log."""

from __future__ import annotations

import argparse
import sys
from argparse import ArgumentTypeError
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from rosetta_jit.cli.arguments import Commands, add_command
from rosetta_jit.cli.logs import add_decodings, add_log, add_selection, channels_of, log_of, one_topic, progress, show

if TYPE_CHECKING:
    from rosetta_jit.logs.channel import Channel
    from rosetta_jit.logs.converting.rejected import Rejected
    from rosetta_jit.logs.converting.routes import Route
    from rosetta_jit.logs.log import Log

    Kind: TypeAlias = Literal["table", "folder", "log"]

ON_ERROR = ("stop", "skip", "quarantine")
FOLDERS = ("parquet", "arrow", "csv", "yarpdatadumper")
STRETCHES = {"s": 1, "min": 60, "h": 3600, "d": 86400}
KINDS = {"table": "a table", "folder": "a folder of tables", "log": "a log"}


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "convert", "Write messages of a log as a table, as a folder of tables, or as another log.", run)
    add_log(command)
    add_selection(command)
    add_decodings(command)
    command.add_argument(
        "-o",
        "--output",
        metavar="OUT",
        required=True,
        help="a table of one topic (.parquet, .arrow, .csv, .npz), a log (.mcap, .bag, .lcmlog), or a folder, whose name ends with /",
    )
    command.add_argument(
        "--as",
        dest="folder",
        choices=FOLDERS,
        help="what is written into a folder: tables by topic and time (default: parquet), or the log of yarpdatadumper",
    )
    command.add_argument("--every", metavar="TIME", type=_stretch, help="the stretch of time of a folder: 30s, 10min, 1h (default), 1d")
    command.add_argument("--resume", action="store_true", help="go on with a folder of tables whose conversion was stopped")
    command.add_argument("--to", choices=("ros2",), help="into a log: messages of ROS 1 become those of ROS 2")
    command.add_argument("--columns", metavar="A,B.C", help="these fields alone, with dots those of nested messages")
    command.add_argument("--flatten", action="store_true", help="each field of a nested message is a column, named with dots")
    command.add_argument("--header-time", action="store_true", help="a further column with the time of `header.stamp`")
    command.add_argument(
        "--on-error",
        choices=ON_ERROR,
        default="stop",
        help="what becomes of a message that its type does not allow (default: stop); quarantine writes it to OUT.quarantine.jsonl, in a "
        "folder to _quarantine.jsonl",
    )


def _stretch(text: str) -> int:
    """Nanoseconds of `10min`."""
    number = text.rstrip("abcdefghijklmnopqrstuvwxyz")
    unit = text[len(number) :]
    if not number.isdigit() or not int(number) or unit not in STRETCHES:
        raise ArgumentTypeError(f"{text!r} is not a number of s, min, h or d: 10min")
    return int(number) * STRETCHES[unit] * 10**9


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if something is wrong with the log, or if messages were left out; 2 if options do not go together."""
    output = Path(arguments.output)
    kind = _kind(arguments, output)
    misplaced = _misplaced(arguments, kind)
    if misplaced:
        print(f"error: {', '.join(misplaced)} cannot be used: {output.name} is {KINDS[kind]}", file=sys.stderr)
        return 2
    with log_of(arguments) as log:
        match kind:
            case "table":
                rejected = _table(log, output, arguments)
            case "folder":
                rejected = _folder(log, output, arguments)
            case "log":
                rejected = _log(log, output, arguments)
        _tell(rejected)
        return int(bool(rejected.total or log.problems))


def _kind(arguments: argparse.Namespace, output: Path) -> Kind:
    from rosetta_jit.catalogue.logs import no_output
    from rosetta_jit.errors import LogError
    from rosetta_jit.logs.converting.table import TABLES
    from rosetta_jit.logs.writing import WRITERS

    if arguments.folder == "yarpdatadumper":
        return "log"
    if arguments.folder or arguments.output.endswith("/") or output.is_dir():
        return "folder"
    if output.suffix not in (*TABLES, *WRITERS):
        raise LogError((no_output(arguments.output, TABLES, WRITERS),))
    return "table" if output.suffix in TABLES else "log"


def _misplaced(arguments: argparse.Namespace, kind: Kind) -> list[str]:
    """The options that were given and do nothing."""
    of_tables = {"--columns": arguments.columns, "--flatten": arguments.flatten, "--header-time": arguments.header_time}
    of_folders = {"--every": arguments.every, "--resume": arguments.resume}
    of_logs = {"--to": arguments.to}
    of_decoded = {"--on-error": arguments.on_error != "stop"}
    match kind:
        case "table":
            idle = of_folders | of_logs
        case "folder":
            idle = of_logs
        case "log" if arguments.mapping and not arguments.to:
            idle = of_tables | of_folders
        case "log":
            idle = of_tables | of_folders | of_decoded | ({"--mapping": arguments.mapping} if arguments.to else {})
    return [option for option, value in idle.items() if value]


def _options(arguments: argparse.Namespace) -> dict[str, Any]:
    """How tables are to look."""
    from rosetta_jit.logs.decoded_parts import CLOCKS

    options: dict[str, Any] = {"flatten": arguments.flatten}
    options |= {"clocks": (*CLOCKS, "header_time")} if arguments.header_time else {}
    return options | ({"columns": arguments.columns.split(",")} if arguments.columns else {})


def _table(log: Log, output: Path, arguments: argparse.Namespace) -> Rejected:
    from rosetta_jit.logs.converting.table import Conversion

    channels = channels_of(log, arguments)
    named = [each for each in channels if each.target is not None and "=" in "".join([*arguments.mapping, *arguments.type])]
    topic = one_topic(log, list(dict.fromkeys(each.topic for each in named or channels)))
    target = next((each.target for each in named or channels if each.topic == topic), None)
    channel = log.channel(topic, target)
    options = {"start": arguments.start, "end": arguments.end, **_options(arguments)}
    with progress(channel.count) as advance:
        return Conversion(channel, output, arguments.on_error, advance, options=options).run()


def _folder(log: Log, output: Path, arguments: argparse.Namespace) -> Rejected:
    from rosetta_jit.logs.converting.folder import FolderConversion

    channels = channels_of(log, arguments)
    with progress(_total(channels)) as advance:
        conversion = FolderConversion(log, channels, output, start=arguments.start, end=arguments.end, advance=advance)
        conversion.suffix, conversion.every_ns = f".{arguments.folder or 'parquet'}", arguments.every or conversion.every_ns
        conversion.on_error, conversion.options, conversion.resume = arguments.on_error, _options(arguments), arguments.resume
        return conversion.run()


def _log(log: Log, output: Path, arguments: argparse.Namespace) -> Rejected:
    from rosetta_jit.logs.base import Wanted
    from rosetta_jit.logs.converting.log import write_log
    from rosetta_jit.logs.converting.rejected import Rejected
    from rosetta_jit.logs.writing import written

    channels = channels_of(log, arguments)
    rejected = Rejected(output.with_name(f"{output.name}.quarantine.jsonl"), arguments.on_error)
    rejected.begin()
    route = _router(log, arguments, rejected)
    try:
        with written(output, arguments.folder) as writer, progress(_total(channels)) as advance:
            numbers = frozenset(number for each in channels for number in each.numbers) if len(channels) < len(log.channels) else None
            write_log(log, [route(each) for each in channels], writer, Wanted(numbers, arguments.start, arguments.end), advance)
    finally:
        rejected.close()
    return rejected


def _router(log: Log, arguments: argparse.Namespace, rejected: Rejected) -> Callable[[Channel], Route]:
    """What finds the way of a topic's messages into the new log."""
    from rosetta_jit.logs.converting.routes import Copied, Mapped
    from rosetta_jit.logs.translating import translated

    def route(channel: Channel) -> Route:
        if arguments.to == "ros2":
            return translated(log, channel, arguments.search_path)
        if channel.target is not None and channel.target.endswith(".mapping"):
            return Mapped.through(channel, rejected)
        return Copied(channel, show)

    return route


def _total(channels: Sequence[Channel]) -> int | None:
    counts = [each.count for each in channels]
    return None if None in counts else sum(each or 0 for each in counts)


def _tell(rejected: Rejected) -> None:
    where = f"; they are in {rejected.path}" if rejected.policy == "quarantine" else ""
    for topic, count in rejected.counts.items():
        if count:
            print(f"{count} messages of {topic} could not be decoded and were left out{where}", file=sys.stderr)
