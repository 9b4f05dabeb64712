"""`rosetta-jit generate`: a mapping or type as source of another language, or as an object file."""

from __future__ import annotations

import re
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, cast

from rosetta_jit.cli.arguments import Commands, add_command, add_encoding, add_parameters, encoding_of, parameters_of
from rosetta_jit.file_errors import named

if TYPE_CHECKING:
    import argparse

    from rosetta_jit.api.options import Options
    from rosetta_jit.pipeline.request import Request

DIRECTIONS = ("decode", "encode", "borrow")


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "generate", "Write a mapping or type as source that needs neither Python nor this library.", run)
    command.add_argument("subject", metavar="MAPPING|TYPE", help="a mapping (*.mapping), or a type by its qualified name")
    command.add_argument("--language", default="c", metavar="NAME", help="c, or one that an installed package offers (default: c)")
    command.add_argument(
        "--directions",
        type=_directions,
        default=("decode", "encode"),
        metavar="LIST",
        help="of decode, encode and borrow, with commas (default: decode,encode)",
    )
    command.add_argument("-o", "--output", metavar="FOLDER", default=".", help="where the files go (default: here)")
    command.add_argument("--name", help="of the files, and what their names begin with (default: that of the mapping or type)")
    command.add_argument("--freestanding", action="store_true", help="use nothing of a C library but memcpy and memset")
    command.add_argument("--framework", help="the type's, where its name does not tell")
    add_encoding(command)
    add_parameters(command)


def _directions(text: str) -> tuple[str, ...]:
    from argparse import ArgumentTypeError

    chosen = tuple(dict.fromkeys(text.split(",")))
    if unknown := [each for each in chosen if each not in DIRECTIONS]:
        raise ArgumentTypeError(f"{unknown[0]!r} is not one of {', '.join(DIRECTIONS)}")
    return chosen


def run(arguments: argparse.Namespace) -> int:
    """All files are made before any is written; one line says what each is."""
    from rosetta_jit.generate.build import generated

    texts = generated(
        _request(arguments),
        arguments.language,
        arguments.directions,
        arguments.name or _name(arguments.subject),
        freestanding=arguments.freestanding,
    )
    folder = Path(cast("str", arguments.output))
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        with named(folder / name) as path:
            path.write_text(text, "utf-8", newline="\n")
        print(f"wrote {folder / name}")
    return 0


def _request(arguments: argparse.Namespace) -> Request:
    from rosetta_jit.api.options import request_of, type_request

    options: Options = {"encoding": encoding_of(arguments), "framework": arguments.framework, "parameters": parameters_of(arguments)}
    subject = cast("str", arguments.subject)
    if _is_mapping(subject):
        return request_of("decode", options, mapping=subject)
    return type_request("decode", subject, options)


def _is_mapping(subject: str) -> bool:
    return subject.endswith(".mapping")


def _name(subject: str) -> str:
    """``yarp/icub/torso_state.mapping`` and ``sensor_msgs/JointState`` give ``torso_state`` and ``joint_state``."""
    last = PurePath(subject).stem if _is_mapping(subject) else re.split(r"[./:]+", subject)[-1]
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", last).lower()
