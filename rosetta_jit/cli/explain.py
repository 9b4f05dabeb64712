"""`rosetta-jit explain`: what a mapping does, as text, as JSON, or as a page to look at."""

from __future__ import annotations

import argparse
import json
import shutil
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from rosetta_jit.cli.arguments import Commands, add_command, add_encoding, add_mapping, add_wire, encoding_of, wire_of
from rosetta_jit.file_errors import named
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.explain.content import Explanation


def add(commands: Commands) -> None:
    """Declare the arguments."""
    command = add_command(commands, "explain", "Show the types of a mapping, its rules, what they lose, and what the kernels cost.", run)
    add_mapping(command)
    add_encoding(command)
    add_wire(command)
    form = command.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="one JSON object")
    form.add_argument("--html", metavar="FILE", help="write one page that needs nothing else")


def run(arguments: argparse.Namespace) -> int:
    """Exit code 1 if the mapping is wrong; what is wrong goes to stderr."""
    from rosetta_jit.explain.content import explanation

    found = explanation(arguments.mapping, encoding=encoding_of(arguments), wire=wire_of(arguments))
    if arguments.json:
        print(json.dumps(plain(found), indent=2))
    elif arguments.html:
        from rosetta_jit.explain.page import as_page

        with named(Path(arguments.html)) as page:
            page.write_text(as_page(found), "utf-8")
        print(f"wrote {arguments.html}")
    else:
        from rosetta_jit.explain.text import as_text

        print(as_text(found, width=shutil.get_terminal_size((100, 24)).columns))
    return 0


def plain(found: Explanation) -> dict[str, object]:
    """The same as plain values."""
    from rosetta_jit.diagnostics import to_json

    return {**asdict(replace(found, warnings=())), "warnings": [to_json(each) for each in found.warnings]}
