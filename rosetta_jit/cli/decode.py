"""`rosetta-jit decode`: messages in, their values out as text, JSON or numpy arrays."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from rosetta_jit.cli.arguments import Commands, add_command, add_mapping_or_type, add_options
from rosetta_jit.cli.inputs import add_topic, decoders_of
from rosetta_jit.errors import DecodeError

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder import Holder


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "decode", "Decode messages and print their values.", run)
    add_mapping_or_type(command)
    command.add_argument("files", metavar="FILE", nargs="+", help="one message, a recording (.rec, .rec.xz) or a log; - is standard input")
    add_topic(command)
    add_options(command)
    form = command.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help='one JSON object a message and line; bytes as {"base64": …}')
    form.add_argument("--npz", metavar="OUT", help="write the columns of all messages to a numpy archive")


def run(arguments: argparse.Namespace) -> int:
    """Messages that cannot be decoded are reported and skipped; then the exit code is 1."""
    failures: list[str] = []
    holders = _holders(arguments, failures)
    if arguments.npz:
        from rosetta_jit.cli.columns import write_columns

        write_columns(holders, Path(arguments.npz))
    else:
        for holder in holders:
            print(_text(holder, as_json=arguments.json))
    return int(bool(failures))


def _holders(arguments: argparse.Namespace, failures: list[str]) -> Iterator[Holder]:
    """The decoder's own holder, filled anew for each message."""
    for file, decode, messages in decoders_of(arguments):
        for index, message in enumerate(messages):
            try:
                yield decode(message.data)
            except DecodeError as error:
                failures.append(file)
                print(f"{file}: message {index}: {error}", file=sys.stderr)


def _text(holder: Holder, *, as_json: bool) -> str:
    if not as_json:
        return str(holder)
    from rosetta_jit.cli.values import dump

    return dump(holder.to_dict())
