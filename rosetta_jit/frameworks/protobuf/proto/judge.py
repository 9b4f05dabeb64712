"""The way that text and descriptors share: files to a schema, or to everything that is wrong with them."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.protobuf.limits import MAX_REPORTED
from rosetta_jit.frameworks.protobuf.proto.check import check
from rosetta_jit.frameworks.protobuf.proto.declarations import declarations
from rosetta_jit.frameworks.protobuf.proto.names import absolute
from rosetta_jit.frameworks.protobuf.proto.problems import refuse
from rosetta_jit.frameworks.protobuf.proto.schema import build
from rosetta_jit.frameworks.protobuf.proto.symbols import declare

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.protobuf.proto.file_set import FileSet
    from rosetta_jit.model.types import Schema


def schema_of(files: FileSet) -> Schema:
    """The schema of files whose imports are all there.

    Raises
    ------
    SchemaError
    """
    problems: list[Diagnostic] = []
    symbols = declare(files, problems)
    declared = declarations(absolute(file, symbols, problems) for file in files.files)
    problems += islice(check(declared), MAX_REPORTED)
    refuse(problems)
    return build(declared)
