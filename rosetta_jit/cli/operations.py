"""`rosetta-jit operations`: which of the paper's nine operations some mappings use, as its table 2."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping
from typing import TYPE_CHECKING

from rosetta_jit.cli.arguments import Commands, add_command, add_mappings, mappings_of
from rosetta_jit.terminal import columns, printable

if TYPE_CHECKING:
    from rosetta_jit.explain.operations import Operation, Uses

LEGEND = "both: in both directions   unpack: from the wire to the holder   pack: from the holder to the wire   -: not used"


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "operations", "Tell which of nine kinds of operations mappings use, and count them.", run)
    add_mappings(command)
    command.add_argument("--json", action="store_true", help="one JSON object")


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if a mapping is wrong; the table is of the others."""
    from rosetta_jit.errors import ReportError
    from rosetta_jit.explain.operations import operations

    found: dict[str, Uses] = {}
    mappings = mappings_of(arguments)
    for mapping in mappings:
        try:
            found[mapping] = operations(mapping)
        except ReportError as error:
            print(error, end="\n\n", file=sys.stderr)
    if arguments.json:
        print(json.dumps({"mappings": found, "counts": _counts(found)}, indent=2))
    elif found:
        print(_table(found))
    return int(len(found) < len(set(mappings)))


def _counts(found: Mapping[str, Uses]) -> dict[Operation, int]:
    """How many mappings use each operation, in one direction or both."""
    from rosetta_jit.explain.operations import OPERATIONS

    return {each: sum(each in uses for uses in found.values()) for each in OPERATIONS}


def _sign(directions: tuple[str, ...]) -> str:
    return "both" if len(directions) == 2 else "".join(directions) or "-"


def _table(found: Mapping[str, Uses]) -> str:
    counts = _counts(found)
    words = [each.partition(" ") for each in counts]
    head = ("", *(first for first, _, _ in words)), ("mapping", *(second for _, _, second in words))
    rows = [(printable(name), *(_sign(uses.get(each, ())) for each in counts)) for name, uses in found.items()]
    last = (f"of {len(found)}", *map(str, counts.values()))
    return "\n".join([*columns([*head, *rows, last]), "", LEGEND])
