"""How much of what is wrong with some files is reported, and in which order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.protobuf.limits import MAX_REPORTED

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic


def refuse(problems: list[Diagnostic]) -> None:
    """Raise SchemaError with what was found, file by file and in the order of the text, where anything was."""
    if problems:
        raise SchemaError(tuple(sorted(problems[:MAX_REPORTED], key=_place)))


def _place(problem: Diagnostic) -> tuple[str, int]:
    return ("", 0) if problem.span is None else (problem.span.source.name, problem.span.start)
