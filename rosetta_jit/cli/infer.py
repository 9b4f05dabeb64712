"""`rosetta-jit infer`: draft a schema from captured messages."""

from __future__ import annotations

import argparse
from typing import cast

from rosetta_jit.cli.arguments import Commands, add_command
from rosetta_jit.cli.inputs import add_topic, encoded_messages_of


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "infer", "Draft a schema from captured messages: of bottles, or of protobuf.", run)
    command.add_argument("files", metavar="FILE", nargs="+", help="one message, a recording (.rec, .rec.xz) or a log; - is standard input")
    add_topic(command)
    command.add_argument("--name", default="captured", help="name of the type (default: captured)")
    command.add_argument("--encoding", help="one of those that `rosetta-jit frameworks` lists (default: the log's, else yarp)")


def run(arguments: argparse.Namespace) -> int:
    """Print the schema."""
    import rosetta_jit

    found = [encoded_messages_of(file, arguments.topic) for file in cast("list[str]", arguments.files)]
    encoding = arguments.encoding or next((each for _, each in found if each is not None), "yarp")
    messages = [message.data for some, _ in found for message in some]
    print(rosetta_jit.infer(messages, name=arguments.name, encoding=encoding), end="")
    return 0
