"""Arguments that several commands share."""

from __future__ import annotations

import json
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Callable
from typing import TYPE_CHECKING, NoReturn, Protocol, cast

from rosetta_jit.pipeline.request import plain_parameters

if TYPE_CHECKING:
    from rosetta_jit.api.options import Options


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


def add_mapping_or_type(command: ArgumentParser) -> None:
    """The same, or a type, whose messages have a holder of its own."""
    command.add_argument(
        "mapping",
        metavar="MAPPING|TYPE",
        help="a mapping, by its path or its name on the search path, or a type (sensor_msgs/Imu)",
    )


def add_mappings(command: ArgumentParser) -> None:
    """The same, several; a folder stands for the mappings in it."""
    command.add_argument(
        "mappings", metavar="MAPPING|FOLDER", nargs="+", help="a mapping's path, its name on the search path, or a folder of mappings"
    )


def add_encoding(command: ArgumentParser) -> None:
    """Which bytes, where a framework has several."""
    usual = "the usual one of the framework; messages of YARP tell theirs"
    command.add_argument("--encoding", help=f"one of those that `rosetta-jit frameworks` lists (default: {usual})")


def add_dialect(command: ArgumentParser) -> None:
    """In which form these bytes are, and what is forgiven."""
    command.add_argument(
        "--byte-order",
        choices=("little", "big"),
        help="of what is written, or of what is read where messages do not tell (default: little)",
    )
    lists = "rosetta-jit frameworks"
    command.add_argument(
        "--lenient", metavar="NAME", action="append", default=[], help=f"what to forgive, by a name that `{lists}` lists for the encoding"
    )


def add_imports(command: ArgumentParser) -> None:
    """The files that declare a type, where its name does not say which."""
    command.add_argument("--import", dest="imports", metavar="FILE", action="append", default=[], help="a file that declares the type")


def add_search_path(command: ArgumentParser) -> None:
    """Folders of definitions."""
    command.add_argument(
        "--search-path", metavar="FOLDER", action="append", default=[], help="a folder to look for definitions in, before all others"
    )


def add_wire(command: ArgumentParser) -> None:
    """Which wire, of a mapping that has several."""
    command.add_argument("--wire", metavar="NAME", help="one of several wires of the mapping")


def add_parameters(command: ArgumentParser) -> None:
    """The values of the mapping's parameters."""
    command.add_argument(
        "--parameter",
        metavar="NAME=JSON",
        action="append",
        default=[],
        type=_parameter,
        help="a parameter of the mapping: --parameter scale=2.5",
    )


def add_options(command: ArgumentParser) -> None:
    """What a program is made with: `options_of` gives it."""
    add_encoding(command)
    add_dialect(command)
    add_imports(command)
    add_search_path(command)
    add_wire(command)
    add_parameters(command)


def positive(text: str) -> int:
    """A number of things: 1 or more."""
    if not text.isdecimal() or not int(text):
        raise ArgumentTypeError(f"{text!r} is no whole number from 1 on")
    return int(text)


def _parameter(text: str) -> tuple[str, object]:
    """A name and a value; what is no JSON is a text."""
    name, equals, value = text.partition("=")
    if not equals or not name:
        raise ArgumentTypeError(f"{text!r} is not NAME=JSON")
    try:
        found: object = json.loads(value)
    except (ValueError, RecursionError):
        return name, value
    try:
        plain_parameters({name: found})
    except TypeError as error:
        raise ArgumentTypeError(str(error)) from error
    return name, found


def mappings_of(arguments: Namespace) -> list[str]:
    """The mappings that the user named, by themselves or by folders; a folder without any stands for itself, which no mapping is."""
    from rosetta_jit.api.warm import members

    return [mapping for name in cast("list[str]", arguments.mappings) for mapping in members(name) or (name,)]


def parameters_of(arguments: Namespace) -> dict[str, object]:
    """The parameters that the user gave; of one that is given twice, the last."""
    return dict(cast("list[tuple[str, object]]", arguments.parameter))


def wire_of(arguments: Namespace) -> str | None:
    """The wire that the user named."""
    return arguments.wire or None


def options_of(arguments: Namespace, subject: str = "") -> Options:
    """What the user said of a program of a mapping or type."""
    from rosetta_jit.api.options import is_mapping

    imports = cast("list[str]", arguments.imports)
    if imports and is_mapping(subject):
        refuse_imports()
    options: Options = {
        "encoding": encoding_of(arguments),
        "byte_order": arguments.byte_order,
        "lenient": cast("list[str]", arguments.lenient),
        "parameters": parameters_of(arguments),
        "wire": wire_of(arguments),
        "search_path": cast("list[str]", arguments.search_path),
    }
    return {**options, "imports": imports} if imports else options


def refuse_imports() -> NoReturn:
    """Say that a mapping names the files itself that declare its types."""
    from rosetta_jit.catalogue.generate import needless_import
    from rosetta_jit.errors import SchemaError

    raise SchemaError((needless_import(),))


def encoding_of(arguments: Namespace) -> str | None:
    """The encoding that the user named."""
    return arguments.encoding or None
