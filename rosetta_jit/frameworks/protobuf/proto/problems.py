"""How much of what is wrong with some files is reported, and in which order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.errors import SchemaError

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic

MAX_REPORTED = 100
"""Problems that one report lists; beyond them nothing is explained that costs time to explain."""

MAX_NAME = 512
"""Characters of an absolute name: a file of n bytes shall not need more than a small multiple of n."""


def refuse(problems: list[Diagnostic]) -> None:
    """Raise what was found, file by file and in the order of the text.

    Raises
    ------
    SchemaError
        Where anything was found.
    """
    if problems:
        raise SchemaError(tuple(sorted(problems[:MAX_REPORTED], key=_place)))


def _place(problem: Diagnostic) -> tuple[str, int]:
    return ("", 0) if problem.span is None else (problem.span.source.name, problem.span.start)
