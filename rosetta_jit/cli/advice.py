"""What errors advise, in words of the command line: ``search_path=[folder]`` of a program is ``--search-path FOLDER`` of a command."""

from __future__ import annotations

import re

from rosetta_jit.diagnostics import Diagnostic, render, render_all
from rosetta_jit.errors import ReportError, RosettaError
from rosetta_jit.startup.dataclass import replace

OPTION = re.compile(r'\b(encoding|framework|byte_order|lenient|imports|search_path)=(?:\["?([^"\]]*)"?\]|"([^"]*)")?')
SPELLED = {"imports": "import"}
"""Options that commands call otherwise."""
PLACES = {"file", "folder"}
"""Values that stand for any."""


def said_of(error: RosettaError) -> str:
    """What a person at the command line reads."""
    return render_all(tuple(map(_typed, error.diagnostics))) if isinstance(error, ReportError) else str(error)


def report(diagnostic: Diagnostic) -> str:
    """The same of one diagnostic that a command has found."""
    return render(_typed(diagnostic))


def _typed(diagnostic: Diagnostic) -> Diagnostic:
    return replace(diagnostic, help=OPTION.sub(_option, diagnostic.help))


def _option(found: re.Match[str]) -> str:
    name, value = found[1], found[2] or found[3] or ""
    option = f"--{SPELLED.get(name, name).replace('_', '-')}"
    return f"{option} {value.upper() if value in PLACES else value}".strip()
