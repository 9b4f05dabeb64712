"""Messages of any file that a user names: a log, a recording, or a single message; and what decodes them, a mapping or a type."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from rosetta_jit.cli.arguments import options_of
from rosetta_jit.recording import Message, is_recording, read_messages

if TYPE_CHECKING:
    from rosetta_jit.api.options import Options
    from rosetta_jit.logs.channel import Channel
    from rosetta_jit.logs.log import Log


def add_topic(command: argparse.ArgumentParser) -> None:
    """Which messages of a log."""
    command.add_argument("--topic", metavar="TOPIC", help="of a log that has several")


def messages_of(file: str, topic: str | None) -> Iterator[Message]:
    """The messages of a log (of one topic), of a recording, or the one message that any other file is; `-` is standard input."""
    return encoded_messages_of(file, topic)[0]


def encoded_messages_of(file: str, topic: str | None) -> tuple[Iterator[Message], str | None]:
    """The same, and their encoding where a log tells it."""
    match None if _is_recorded(file) else _opened(file):
        case None:
            return read_messages(Path(file)), None
        case Message() as message:
            return iter([message]), None
        case log:
            return _of_topic(log, topic), log[_one_topic(log, topic)].encoding


def _is_recorded(file: str) -> bool:
    """Whether a file is a recording, or no file at all, which reading says."""
    return file != "-" and (is_recording(Path(file)) or not Path(file).exists())


def _of_topic(log: Log, topic: str | None) -> Iterator[Message]:
    with log:
        for each in log.messages([_one_topic(log, topic)], raw=True):
            yield Message(each.time / 1e9, each.message)


def _one_topic(log: Log, topic: str | None) -> str:
    from rosetta_jit.cli.logs import one_topic

    return one_topic(log, None if topic is None else [topic])


def channel_of(log: Log, arguments: argparse.Namespace) -> Channel:
    """The messages of a topic, which the mapping or the type decodes that the user names: as the log defines it, in its encoding."""
    options = {name: value for name, value in options_of(arguments, arguments.mapping).items() if value}
    return log.channel(_one_topic(log, arguments.topic), arguments.mapping, **cast("Options", options))


def decoders_of(arguments: argparse.Namespace) -> Iterator[tuple[str, Any, Iterator[Message]]]:
    """The files that the user names: of each its name, what decodes its messages, and these."""
    import rosetta_jit

    plain: Any = None
    for file in cast("list[str]", arguments.files):
        found = None if _is_recorded(file) else _opened(file)
        if found is not None and not isinstance(found, Message):
            yield file, channel_of(found, arguments).decoder, _of_topic(found, arguments.topic)
            continue
        plain = plain or program_of(rosetta_jit.Decoder, arguments, **options_of(arguments, arguments.mapping))
        yield file, plain, read_messages(Path(file)) if found is None else iter([found])


def _opened(file: str) -> Log | Message | None:
    """The log; the message, where standard input is one; None of any other file."""
    from rosetta_jit.cli.logs import show
    from rosetta_jit.errors import LogError
    from rosetta_jit.logs.log import Log, format_of
    from rosetta_jit.logs.reading.storage import open_storage

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
    """A decoder or an encoder of the mapping, or of the type, that the user names."""
    from rosetta_jit.api.options import is_mapping

    named = arguments.mapping
    return program(named, **options) if is_mapping(named) else program.of(named, **options)
