"""`rosetta-jit dump`: what became of a mapping, stage by stage."""

from __future__ import annotations

import argparse

from rosetta_jit.cli.arguments import (
    Commands,
    add_command,
    add_mapping_or_type,
    add_options,
    options_of,
)
from rosetta_jit.cli.inputs import add_topic, channel_of, program_of
from rosetta_jit.pipeline.stages import STAGES


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "dump", "Print what a mapping became at one stage of compilation.", run)
    add_mapping_or_type(command)
    command.add_argument(
        "log", metavar="LOG", nargs="?", help="for the messages of a log: by its definitions, in its encoding; - is standard input"
    )
    add_topic(command)
    command.add_argument("--stage", choices=[stage.name for stage in STAGES], default="kernel", help="default: kernel")
    command.add_argument("--direction", choices=("decode", "encode"), default="decode", help="default: decode")
    add_options(command)


def run(arguments: argparse.Namespace) -> int:
    """Print the text of the stage."""
    import rosetta_jit

    program = rosetta_jit.Encoder if arguments.direction == "encode" else rosetta_jit.Decoder
    if arguments.log:
        with rosetta_jit.open(arguments.log) as log:
            made = channel_of(log, arguments).program(program)
    else:
        made = program_of(program, arguments, **options_of(arguments, arguments.mapping))
    print(made.stage(arguments.stage))
    return 0
