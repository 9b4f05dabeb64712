"""Arguments that several commands share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable


class Commands(Protocol):
    """What `ArgumentParser.add_subparsers` gives; argparse has no public name for it."""

    def add_parser(self, name: str, *, help: str, description: str) -> ArgumentParser: ...  # noqa: A002 - argparse's name


def add_command(commands: Commands, name: str, summary: str, run: Callable[[Namespace], int]) -> ArgumentParser:
    """A command of that name; its summary is shown in both helps."""
    command = commands.add_parser(name, help=summary, description=summary)
    command.set_defaults(run=run)
    return command


def add_mapping(command: ArgumentParser) -> None:
    """The mapping, by its path or its name on the search path."""
    command.add_argument(
        "mapping", metavar="MAPPING", help="a mapping's path, or its name on the search path (yarp/icub/torso_state.mapping)"
    )


def add_mappings(command: ArgumentParser) -> None:
    """The same, several."""
    command.add_argument("mappings", metavar="MAPPING", nargs="+", help="a mapping's path, or its name on the search path")


def add_encoding(command: ArgumentParser, default: str | None = None) -> None:
    """Which bytes, where a framework has several."""
    shown = default or "the mapping's own"
    command.add_argument("--encoding", default=default, help=f"one of those that `rosetta-jit frameworks` lists (default: {shown})")


def encoding_of(arguments: Namespace) -> str | None:
    """The encoding that the user named."""
    return arguments.encoding or None
