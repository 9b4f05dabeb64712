"""`rosetta-jit encode`: values as `decode --json` prints them in, messages out."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import cast

from rosetta_jit.catalogue import values as words
from rosetta_jit.cli.arguments import (
    Commands,
    add_command,
    add_mapping_or_type,
    add_options,
    options_of,
)
from rosetta_jit.cli.inputs import program_of
from rosetta_jit.cli.values import load
from rosetta_jit.errors import ReportError
from rosetta_jit.file_errors import named
from rosetta_jit.recording import Message, is_recording, read_file, write_recording


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "encode", "Encode values to messages.", run)
    add_mapping_or_type(command)
    command.add_argument("files", metavar="FILE.json", nargs="+", help="one JSON object, or one a line, as `decode --json` prints them")
    add_options(command)
    command.add_argument(
        "-o", "--output", metavar="OUT", default="-", help="for one message any file, for several a recording (.rec, .rec.xz)"
    )


def run(arguments: argparse.Namespace) -> int:
    """All messages are encoded before anything is written."""
    import rosetta_jit

    encode = program_of(rosetta_jit.Encoder, arguments, **options_of(arguments, arguments.mapping))
    holder = encode.holder_type
    values = [value for file in cast("list[str]", arguments.files) for value in _values(Path(file))]
    messages = [encode(holder.from_dict(value)) for value in values]
    output = Path(arguments.output)
    if is_recording(output):
        write_recording(output, (Message(0.0, message) for message in messages))
    elif len(messages) != 1:
        raise ReportError((words.several_messages(len(messages)),))
    elif arguments.output == "-":
        sys.stdout.buffer.write(messages[0])
    else:
        with named(output):
            output.write_bytes(messages[0])
    return 0


def _values(path: Path) -> Iterator[dict[str, object]]:
    text = read_file(path).decode("utf-8", "surrogateescape")
    for number, line in _documents(text):
        try:
            value = load(line)
        except (ValueError, RecursionError) as error:
            raise ReportError((words.no_json(f"{path}:{number}", str(error)),)) from error
        if not isinstance(value, dict):
            raise ReportError((words.no_json(f"{path}:{number}", "an object is expected"),))
        yield cast("dict[str, object]", value)


def _documents(text: str) -> list[tuple[int, str]]:
    """Lines, where each begins an object of its own; else the text is one document."""
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    return lines if all(line.lstrip().startswith("{") and line.rstrip().endswith("}") for _, line in lines) else [(1, text)]
