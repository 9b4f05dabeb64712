"""`rosetta-jit prove`: what the kernels of some mappings owe, who proved it, and whether z3 agrees."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from importlib.util import find_spec
from typing import TYPE_CHECKING

from rosetta_jit.cli.arguments import Commands, add_command, add_mappings, add_parameters, encoding_of, mappings_of, parameters_of

if TYPE_CHECKING:
    from rosetta_jit.explain.proof import Judge, MappingProof


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "prove", "Print what the kernels of mappings must not do wrong, and who proved that they do not.", run)
    add_mappings(command)
    command.add_argument("--encoding", help="one of those that `rosetta-jit frameworks` lists (default: all of them)")
    add_parameters(command)
    command.add_argument("--second", action="store_true", help="ask z3, too, about each obligation (pip install 'rosetta-jit[prove]')")
    form = command.add_mutually_exclusive_group()
    form.add_argument("--summary", action="store_true", help="one line a mapping")
    form.add_argument("--json", action="store_true", help="one JSON object a mapping, on stdout")


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if a mapping is wrong, if something is not proven, or if z3 does not agree."""
    from rosetta_jit.errors import ReportError
    from rosetta_jit.explain.proof import proof

    if arguments.second and find_spec("z3") is None:
        print("error: --second needs z3, which is not installed: pip install 'rosetta-jit[prove]'", file=sys.stderr)
        return 1
    judge, proven = _judge() if arguments.second else None, True
    for mapping in mappings_of(arguments):
        try:
            found = proof(mapping, encoding=encoding_of(arguments), parameters=parameters_of(arguments), judge=judge)
        except ReportError as error:
            print(error, end="\n\n", file=sys.stderr)
            proven = False
        else:
            print(_shown(found, as_json=arguments.json, briefly=arguments.summary), flush=True)
            proven = proven and found.is_proved
    return int(not proven)


def _judge() -> Judge:
    from rosetta_jit.kernel.proof.opinion import opinions

    return opinions


def _shown(found: MappingProof, *, as_json: bool, briefly: bool) -> str:
    from rosetta_jit.explain.proof import as_text, summary

    if as_json:
        return json.dumps({**asdict(found), "proved": found.is_proved})
    return summary(found) if briefly else f"{as_text(found)}\n"
