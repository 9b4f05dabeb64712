"""The front end of protobuf: a `.proto` file and what it imports, to a schema."""

from __future__ import annotations

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf.limits import MAX_REPORTED
from rosetta_jit.frameworks.protobuf.proto.files import gather
from rosetta_jit.frameworks.protobuf.proto.judge import schema_of
from rosetta_jit.model.types import Schema
from rosetta_jit.parsing.idl import Load, refuse
from rosetta_jit.source import Source


def parse(source: Source, load: Load) -> Schema:
    """All declarations of a `.proto` file and of what it imports.

    Messages and enums are keyed by their qualified names (``rst.vision.Image``, ``rst.vision.Image.Depth``).
    ``google/protobuf/*.proto`` need not be on the search path: where ``load`` has none, protobuf's own are taken.

    Parameters
    ----------
    source
        The text, and the name that it has as an import.
    load
        Finds the files that it imports.

    Raises
    ------
    SchemaError
        With everything that is wrong in any of the files.
    """
    problems: list[Diagnostic] = []
    files = gather(source, load, problems)
    refuse(problems, MAX_REPORTED)
    return schema_of(files)
