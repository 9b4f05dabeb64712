"""`rosetta-jit stubs`: what type checkers and editors must know of a mapping's holders and programs."""

from __future__ import annotations

import argparse
import sys
from keyword import iskeyword
from pathlib import Path
from typing import Any

from rosetta_jit.cli.arguments import Commands, add_command, add_imports, add_parameters, parameters_of
from rosetta_jit.startup.dataclass import replace


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "stubs", "Write a .pyi file of the classes of a mapping's or a type's holders.", run)
    command.add_argument(
        "what", metavar="MAPPING|TYPE", help="a mapping's path or name, which ends in .mapping, or a type (sensor_msgs/Imu)"
    )
    command.add_argument("-o", "--output", metavar="FILE", type=Path, help="the file to write (default: stdout)")
    command.add_argument("--encoding", help="how messages are encoded, where a type is one of several frameworks")
    command.add_argument("--framework", help="whose type it is, where nothing else tells")
    add_imports(command)
    add_parameters(command)


def run(arguments: argparse.Namespace) -> int:
    """Write the stub."""
    from rosetta_jit.api.options import is_mapping, named_request
    from rosetta_jit.api.programs import holder_type_of, wires_of
    from rosetta_jit.stubs.module import stub

    options: Any = {"encoding": arguments.encoding, "framework": arguments.framework, "parameters": parameters_of(arguments)}
    options["imports"] = arguments.imports
    what = str(arguments.what)
    request = named_request("decode", what, options)
    wires = wires_of(request)
    family = holder_type_of(replace(request, wire="") if wires else request).family_
    text = stub(family, what, options, is_mapping=is_mapping(what), wires=_attributes(wires) if wires else None)
    if arguments.output is None:
        sys.stdout.write(text)
    else:
        arguments.output.write_text(text, encoding="ascii")
    return 0


def _attributes(wires: list[str]) -> list[str]:
    """The wires whose programs are attributes of `rosetta_jit.Decoders`: not those whose name another attribute has, or Python itself."""
    from rosetta_jit.api.wires import Decoders

    return [wire for wire in wires if not hasattr(Decoders, wire) and not iskeyword(wire)]
