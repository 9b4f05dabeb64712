"""What the commands on logs share: which log, which topics, which stretch of time, and how far the work is."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from rosetta_jit.cli.arguments import add_search_path
from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from rosetta_jit.logs.channel import Channel
    from rosetta_jit.logs.log import Log


def add_log(command: ArgumentParser) -> None:
    """The log, and how it is read."""
    command.add_argument("log", metavar="LOG", help="a file or folder, a URL that fsspec knows, or - for standard input")
    command.add_argument("--format", metavar="NAME", help="its format, where neither its beginning nor its name tells: mcap, bag, lcm, …")
    command.add_argument("--no-check", action="store_true", help="do not compare checksums")


def add_selection(command: ArgumentParser) -> None:
    """Which of its messages."""
    command.add_argument("--topic", metavar="TOPIC", action="append", default=[], help="a topic; several by giving it again (default: all)")
    add_times(command)


def add_times(command: ArgumentParser) -> None:
    """From when to when."""
    command.add_argument("--start", metavar="TIME", type=_moment, help="from when on: seconds since 1970, or 2024-05-01T12:00:00")
    command.add_argument("--end", metavar="TIME", type=_moment, help="until before when")


def add_decoding(command: ArgumentParser) -> None:
    """What decodes them, where the log does not tell."""
    decoding = command.add_mutually_exclusive_group()
    decoding.add_argument("--mapping", metavar="MAPPING", help="decode through a mapping: its path, or its name on the search path")
    decoding.add_argument("--type", metavar="TYPE", help="the type of the messages, where the log does not tell it or has several")
    add_schemas(command)


def add_decodings(command: ArgumentParser) -> None:
    """The same for several topics, each with a mapping or a type of its own."""
    command.add_argument(
        "--mapping",
        metavar="[TOPIC=]MAPPING",
        action="append",
        default=[],
        help="decode through a mapping: its path, or its name on the search path; several, each for its topic, by giving it again",
    )
    command.add_argument(
        "--type",
        metavar="[TOPIC=]TYPE",
        action="append",
        default=[],
        help="the type of the messages, where the log does not tell it or has several",
    )
    add_schemas(command)


def add_schemas(command: ArgumentParser) -> None:
    """Where definitions are found, and which bytes messages are."""
    command.add_argument("--encoding", help="one of those that `rosetta-jit frameworks` lists (default: what the log says)")
    command.add_argument(
        "--import",
        metavar="FILE",
        dest="imports",
        action="append",
        default=[],
        help="a file that declares it, on the search path",
    )
    add_search_path(command)


def _moment(text: str) -> int:
    from rosetta_jit.logs.moments import moment_of

    try:
        return moment_of(text)
    except ValueError as error:
        said = (
            str(error) if text.removeprefix("-").replace(".", "", 1).isdigit() else f"{text!r} is neither seconds since 1970 nor ISO 8601"
        )
        raise ArgumentTypeError(said) from error


def log_of(arguments: Namespace, on_problem: Callable[[Diagnostic], object] | None = None) -> Log:
    """The log that the user names. What is wrong with it goes to stderr."""
    import rosetta_jit

    options: dict[str, Any] = {}
    if getattr(arguments, "encoding", None):
        options["encoding"] = arguments.encoding
    if getattr(arguments, "imports", None):
        options["imports"] = arguments.imports
    if getattr(arguments, "search_path", None):
        options["search_path"] = arguments.search_path
    return rosetta_jit.open(arguments.log, format=arguments.format, check=not arguments.no_check, on_problem=on_problem or show, **options)


def show(problem: Diagnostic) -> None:
    """Say what is wrong with a log."""
    from rosetta_jit.cli.advice import report

    print(report(problem), file=sys.stderr)


def topics_of(arguments: Namespace) -> list[str] | None:
    """The topics that the user names; None for all."""
    return cast("list[str]", arguments.topic) or None


def target_of(arguments: Namespace) -> str | None:
    """The mapping or the type that the user names."""
    return arguments.mapping or arguments.type


def channels_of(log: Log, arguments: Namespace) -> list[Channel]:
    """The channels of the topics that the user names, all by default, each with its mapping or type.

    A mapping or type without a topic is that of all of them.

    Raises
    ------
    LogError
        A topic is not there.
    """
    from rosetta_jit.catalogue import logs as words
    from rosetta_jit.errors import LogError

    named: dict[str, str] = {}
    usual: str | None = None
    for argument in cast("list[str]", [*arguments.type, *arguments.mapping]):
        topic, equals, target = argument.partition("=")
        if equals and topic in log:
            named[topic] = target
        elif equals and not Path(argument).is_file():
            raise LogError((words.unknown_topic(log.name, topic, log.topics),))
        else:
            usual = argument
    topics = topics_of(arguments)
    chosen = list(dict.fromkeys([*(topics or log.topics), *named]))
    found: list[Channel] = []
    for topic in chosen:
        target = named.get(topic, usual)
        own = [each for each in log.channels if each.topic == topic] if target is None else [log[topic, target]]
        found += own or [log[topic]]
    return found


def one_topic(log: Log, topics: list[str] | None) -> str:
    """The topic of a command that takes one: that which is named, or the only one; raises LogError where there are several."""
    from rosetta_jit.catalogue import logs as words
    from rosetta_jit.errors import LogError

    found = topics or list(log.topics)
    if len(found) != 1:
        raise LogError((words.which_topic(log.name, found),))
    return found[0]


@contextmanager
def progress(total: int | None, *, quiet: bool = False) -> Generator[Callable[[int], object]]:
    """How many messages are done, the rate and the time left, on stderr if a person looks at it."""
    if quiet or not sys.stderr.isatty():
        yield int
        return
    from tqdm import tqdm

    with tqdm(total=total, unit=" messages", unit_scale=True, file=sys.stderr) as bar:
        yield bar.update
