"""`rosetta-jit cat`: the messages of a log, one after another."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from itertools import islice
from typing import TYPE_CHECKING

from rosetta_jit.cli.arguments import Commands, add_command, positive
from rosetta_jit.cli.logs import add_decoding, add_log, add_selection, log_of, one_topic, target_of, topics_of
from rosetta_jit.terminal import printable

if TYPE_CHECKING:
    from rosetta_jit.logs.log import Log, Message


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "cat", "Print the messages of a log.", run)
    add_log(command)
    add_selection(command)
    add_decoding(command)
    command.add_argument("-n", "--count", metavar="N", type=positive, help="so many messages and no more")
    form = command.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help='one JSON object a message and line: {"time": …, "topic": …, "message": …}')
    form.add_argument("--raw", action="store_true", help="the bytes in hexadecimal digits")


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if something is wrong with the log."""
    with log_of(arguments) as log:
        for message in islice(_messages(log, arguments), arguments.count):
            print(_text(message, as_json=arguments.json))
        return int(bool(log.problems))


def _messages(log: Log, arguments: argparse.Namespace) -> Iterator[Message]:
    topics, target = topics_of(arguments), target_of(arguments)
    channels = None if target is None else [log[one_topic(log, topics), target]]
    yield from log.messages(channels or topics, start=arguments.start, end=arguments.end, raw=arguments.raw)


def _text(message: Message, *, as_json: bool) -> str:
    from rosetta_jit.cli.values import dump
    from rosetta_jit.logs.moments import shown

    if as_json:
        return dump({"time": message.time, "topic": message.topic, "message": message.message.to_dict()})
    text = message.message.hex(" ") if isinstance(message.message, bytes) else str(message.message)
    return f"{shown(message.time)} {printable(message.topic)}\n{text}"
