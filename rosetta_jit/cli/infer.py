"""`rosetta-jit infer`: draft a schema from captured messages."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from rosetta_jit.cli.arguments import Commands, add_command, add_encoding
from rosetta_jit.cli.inputs import add_topic, messages_of

if TYPE_CHECKING:
    import argparse


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "infer", "Draft a schema from captured messages: of bottles, or of protobuf.", run)
    command.add_argument("files", metavar="FILE", nargs="+", help="one message, a recording (.rec, .rec.xz) or a log; - is standard input")
    add_topic(command)
    command.add_argument("--name", default="captured", help="name of the type (default: captured)")
    add_encoding(command, default="yarp")


def run(arguments: argparse.Namespace) -> int:
    """Print the schema."""
    import rosetta_jit

    messages = [message.data for file in cast("list[str]", arguments.files) for message in messages_of(file, arguments.topic)]
    print(rosetta_jit.infer(messages, name=arguments.name, encoding=arguments.encoding), end="")
    return 0
