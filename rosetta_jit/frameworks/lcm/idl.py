"""The front end of LCM: a `.lcm` file and those that it leads to, to a schema."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.lcm.endless import check_endless
from rosetta_jit.frameworks.lcm.files import gather
from rosetta_jit.frameworks.lcm.limits import MAX_PROBLEMS
from rosetta_jit.frameworks.lcm.schema import schema_of

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.model.types import Schema
    from rosetta_jit.parsing.idl import Load
    from rosetta_jit.source import Source


def parse(source: Source, load: Load) -> Schema:
    """All declarations of a `.lcm` file and of the files in which the types that it uses are found.

    Structs and enums are keyed by their qualified names (``exlcm.example_t``). A type ``pkg.type_t`` that the file does not declare is
    looked for in ``pkg/type_t.lcm``, ``lcm/pkg/type_t.lcm``, and ``type_t.lcm`` beside the file that uses it.

    Parameters
    ----------
    source
        The text, and the name by which it was found.
    load
        Finds other files.

    Raises
    ------
    SchemaError
        With everything that is wrong in any of the files.
    """
    problems: list[Diagnostic] = []
    gathered = gather(source, load, problems)
    schema = schema_of(gathered, problems)
    check_endless(schema, problems)
    if problems:
        raise SchemaError(tuple(sorted(problems[:MAX_PROBLEMS], key=_place)))
    return schema


def _place(problem: Diagnostic) -> tuple[str, int]:
    return ("", 0) if problem.span is None else (problem.span.source.name, problem.span.start)
