"""Messages of any file that a user names: a log, a recording, or a single message; and what decodes them, a mapping or a type."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from rosetta_jit.recording import Message, is_recording, read_messages

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator

    from rosetta_jit.logs.log import Log


def add_topic(command: argparse.ArgumentParser) -> None:
    """Which messages of a log."""
    command.add_argument("--topic", metavar="TOPIC", help="of a log that has several")


def messages_of(file: str, topic: str | None) -> Iterator[Message]:
    """The messages of a log (of one topic), of a recording, or the one message that any other file is; `-` is standard input."""
    if file != "-" and (is_recording(Path(file)) or not Path(file).exists()):
        yield from read_messages(Path(file))
        return
    found = _opened(file)
    match found:
        case None:
            yield from read_messages(Path(file))
        case Message():
            yield found
        case _:
            yield from _of_topic(found, topic)


def _of_topic(log: Log, topic: str | None) -> Iterator[Message]:
    from rosetta_jit.cli.logs import one_topic

    with log:
        for each in log.messages([one_topic(log, None if topic is None else [topic])], raw=True):
            yield Message(each.time / 1e9, each.message)


def _opened(file: str) -> Log | Message | None:
    """The log; the message, where standard input is one; None of any other file."""
    from rosetta_jit.cli.logs import show
    from rosetta_jit.errors import LogError
    from rosetta_jit.logs.log import Log, format_of
    from rosetta_jit.logs.storage import open_storage

    try:
        storage = open_storage(file)
    except LogError:
        return None
    try:
        form = format_of(storage)
    except LogError:
        data = storage.read(0, storage.size)
        storage.close()
        return Message(0.0, data) if file == "-" else None
    return Log(storage, form, show, check=True, options={})


def program_of(program: Any, arguments: argparse.Namespace, **options: Any) -> Any:
    """A decoder or an encoder of the mapping, or of the type, that the user names: names of mappings end with `.mapping`."""
    named = arguments.mapping
    if named.endswith(".mapping") or Path(named).is_file():
        return program(named, **options)
    return program.of(named, **options)
