"""The front end of OMG IDL, for OpenRTM's CORBA and for what rosidl and DDS write: a `.idl` file and what it includes, to a schema.

text ─ lexer ─▶ tokens ─ preprocessor ─▶ tokens of all files ─ grammar ─▶ tree ─ declare ─▶ declarations ─ usable ─▶ schema
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.omg.declare import declare
from rosetta_jit.frameworks.omg.grammar import parse as definitions_of
from rosetta_jit.frameworks.omg.limits import MAX_REPORTED
from rosetta_jit.frameworks.omg.preprocessor import preprocess
from rosetta_jit.frameworks.omg.usable import attach_constants, usable
from rosetta_jit.model.types import Schema

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.parsing.idl import Load
    from rosetta_jit.source import Source


def parse(source: Source, load: Load) -> Schema:
    """All structs, unions and enums of a `.idl` file and of what it includes, keyed by qualified names (``RTC::TimedDouble``).

    A declaration that the model has nothing for (``any``, ``long double``, references to objects) is left out, and so is what needs it;
    `Schema.left_out` says why.

    Parameters
    ----------
    source
        The text, and the name that it has on the search path.
    load
        Finds the files that it includes.

    Raises
    ------
    SchemaError
        With everything that is wrong.
    """
    problems: list[Diagnostic] = []
    tokens, files = preprocess(source, load, problems)
    _refuse(problems)
    definitions = definitions_of(tokens, problems)
    _refuse(problems)
    declared = declare(definitions, problems)
    _refuse(problems)
    types, left_out = usable(declared.types)
    types, constants = attach_constants(types, declared.constants)
    return Schema(types, files, constants, left_out)


def _refuse(problems: list[Diagnostic]) -> None:
    """Raise what was found, file by file and in the order of the text."""
    if problems:
        raise SchemaError(tuple(sorted(problems[:MAX_REPORTED], key=_place)))


def _place(problem: Diagnostic) -> tuple[str, int]:
    return ("", 0) if problem.span is None else (problem.span.source.name, problem.span.start)
