"""`rosetta-jit generate`: a mapping or type as source of another language, or as an object file."""

from __future__ import annotations

import argparse
import re
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, cast

from rosetta_jit.cli.arguments import (
    Commands,
    add_command,
    add_options,
    options_of,
)
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.file_errors import folder, named, whole
from rosetta_jit.pipeline.request import Request

if TYPE_CHECKING:
    from rosetta_jit.api.options import Options

DIRECTIONS = ("decode", "encode", "borrow")
MAX_NAME = 40
"""Letters of the names of files that a type gives."""


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "generate", "Write a mapping or type as source that needs neither Python nor this library.", run)
    command.add_argument("subject", metavar="MAPPING|TYPE", help="a mapping (*.mapping), or a type by its qualified name")
    command.add_argument(
        "--language", default="c", metavar="NAME", help="c, cpp, lisp, python, or one that an installed package offers (default: c)"
    )
    command.add_argument(
        "--holder", metavar="NAME", help="whose classes are filled, of languages that have several, as protobuf (default: own)"
    )
    command.add_argument(
        "--include", metavar="HEADER", help="the header that declares these classes (default: by the rules of their framework)"
    )
    command.add_argument(
        "--arrays",
        choices=("list", "numpy"),
        default="list",
        help="what arrays of numbers are in Python: lists, or numpy's (default: list)",
    )
    command.add_argument(
        "--directions",
        type=_directions,
        default=("decode", "encode"),
        metavar="LIST",
        help="of decode, encode and borrow, with commas (default: decode,encode)",
    )
    command.add_argument("-o", "--output", metavar="FOLDER", default=".", help="where the files go (default: here)")
    command.add_argument("--name", help="of the files, and what their names begin with (default: that of the mapping or type)")
    command.add_argument("--emit", choices=("source", "object"), default="source", help="source, or LLVM's object file and a header for C")
    command.add_argument("--target", metavar="TRIPLE", help="of an object: the machine as LLVM names it (default: this one)")
    command.add_argument("--cpu", default="", help="of an object: one of the machine's, as cortex-m7 (default: any)")
    command.add_argument("--freestanding", action="store_true", help="use nothing of a C library but memcpy and memset")
    command.add_argument("--framework", help="the type's, where its name does not tell")
    add_options(command)


def _directions(text: str) -> tuple[str, ...]:
    from argparse import ArgumentTypeError

    chosen = tuple(dict.fromkeys(text.split(",")))
    if unknown := [each for each in chosen if each not in DIRECTIONS]:
        raise ArgumentTypeError(f"{unknown[0]!r} is not one of {', '.join(DIRECTIONS)}")
    return chosen


def run(arguments: argparse.Namespace) -> int:
    """All files are made before any is written, and none gets its name before all are whole; one line says what each is."""
    _check(arguments)
    texts = _object(arguments) if arguments.emit == "object" else _source(arguments)
    output = Path(cast("str", arguments.output))
    _keep(output, texts)
    with ExitStack() as files:
        parts = [files.enter_context(whole(files.enter_context(folder((output / name).parent)) / Path(name).name)) for name in texts]
        for part, (name, text) in zip(parts, texts.items(), strict=True):
            with named(output / name):
                part.write_bytes(text if isinstance(text, bytes) else text.encode())
    for name in texts:
        print(f"wrote {output / name}")
    return 0


def _check(arguments: argparse.Namespace) -> None:
    """Refuse options that what is made knows nothing of, rather than to leave them out in silence."""
    from rosetta_jit.catalogue.generate import needless
    from rosetta_jit.errors import SchemaError

    of_source = {"--holder": arguments.holder, "--include": arguments.include, "--arrays": arguments.arrays == "numpy"}
    meaningless = of_source if arguments.emit == "object" else {"--target": arguments.target, "--cpu": arguments.cpu}
    if wrong := tuple(needless(option, arguments.emit) for option, value in meaningless.items() if value):
        raise SchemaError(wrong)


def _keep(output: Path, texts: Mapping[str, str | bytes]) -> None:
    """Refuse to replace what somebody has written, or what was made from something else: only files that say from what they were made."""
    from rosetta_jit.catalogue.generate import of_another_subject, somebody_elses
    from rosetta_jit.errors import SchemaError
    from rosetta_jit.generate.provenance import is_made, subject_of

    lost: list[Diagnostic] = []
    for name, text in texts.items():
        path = output / name
        if not isinstance(text, str) or not is_made(text) or not path.is_file() or path.is_symlink():
            continue
        there = path.read_text("utf-8", "replace")
        if not is_made(there):
            lost.append(somebody_elses(str(path)))
        elif subject_of(there) != subject_of(text):
            lost.append(of_another_subject(str(path), subject_of(there)))
    if lost:
        raise SchemaError(tuple(lost))


def _source(arguments: argparse.Namespace) -> Mapping[str, str | bytes]:
    from rosetta_jit.generate.build import Wishes, generated

    name = _name(arguments)
    wishes = Wishes(arguments.freestanding, arguments.holder or "", arguments.include or "", numpy=arguments.arrays == "numpy")
    return generated(_request(arguments), arguments.language, arguments.directions, name, wishes)


def _object(arguments: argparse.Namespace) -> Mapping[str, str | bytes]:
    from llvmlite import binding

    from rosetta_jit.catalogue.generate import no_object
    from rosetta_jit.errors import SchemaError
    from rosetta_jit.generate.build import object_of

    if arguments.language != "c":
        raise SchemaError((no_object(arguments.language),))
    triple = arguments.target or binding.get_default_triple()
    return object_of(
        _request(arguments), arguments.directions, _name(arguments), triple, arguments.cpu, freestanding=arguments.freestanding
    )


def _request(arguments: argparse.Namespace) -> Request:
    from rosetta_jit.api.options import named_request

    subject = cast("str", arguments.subject)
    options: Options = {**options_of(arguments, subject), "framework": arguments.framework}
    return named_request("decode", subject, options)


def _name(arguments: argparse.Namespace) -> str:
    return _usual_name(arguments.subject, arguments.language) if arguments.name is None else arguments.name


def _usual_name(subject: str, language: str) -> str:
    """``yarp/icub/torso_state.mapping`` and ``sensor_msgs/JointState`` give ``torso_state`` and ``joint_state``.

    What no identifier has becomes an underscore: ``my-arm.mapping`` gives ``my_arm``. A name that a header of C has, or a word of the
    language, as that of ``std_msgs/String``, is preceded by what stands before it: ``std_msgs_string``.
    """
    from rosetta_jit.generate.languages import language_named

    parts = re.split(r"[./:]+", subject.removesuffix(".mapping"))
    names = [re.sub(r"(?<=[a-z0-9])(?=[A-Z])|[^A-Za-z0-9_]+", "_", part).lower()[:MAX_NAME] for part in parts]
    known = language_named(language)
    is_usable = known is None or known.may_name(names[-1])
    return names[-1] if is_usable else "_".join(names[-2:])
