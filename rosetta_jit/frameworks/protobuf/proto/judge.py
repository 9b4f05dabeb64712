"""The way that text and descriptors share: files to a schema, or to everything that is wrong with them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf.limits import MAX_REPORTED
from rosetta_jit.frameworks.protobuf.proto.check_features import check_features
from rosetta_jit.frameworks.protobuf.proto.check_fields import check_extensions, check_fields
from rosetta_jit.frameworks.protobuf.proto.check_json import check_json
from rosetta_jit.frameworks.protobuf.proto.check_numbers import check_enums, check_numbers
from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations, declarations
from rosetta_jit.frameworks.protobuf.proto.names import absolute
from rosetta_jit.frameworks.protobuf.proto.options import check_options
from rosetta_jit.frameworks.protobuf.proto.schema import build
from rosetta_jit.frameworks.protobuf.proto.symbols import declare
from rosetta_jit.model.types import Schema
from rosetta_jit.parsing.idl import refuse

if TYPE_CHECKING:
    from rosetta_jit.frameworks.protobuf.proto.file_set import FileSet


def schema_of(files: FileSet) -> Schema:
    """The schema of files whose imports are all there; raises SchemaError."""
    problems: list[Diagnostic] = []
    symbols = declare(files, problems)
    declared = declarations(absolute(file, symbols, problems) for file in files.files)
    problems += islice(check(declared), MAX_REPORTED)
    refuse(problems, MAX_REPORTED)
    return build(declared)


Check = Callable[["Declarations"], "Iterator[Diagnostic]"]

CHECKS: tuple[Check, ...] = (
    check_numbers,
    check_fields,
    check_enums,
    check_extensions,
    check_json,
    check_options,
    check_features,
)
"""What protoc refuses although every name in it is known.

https://protobuf.dev/programming-guides/proto2/, .../proto3/ and .../editions/
"""


def check(declared: Declarations) -> Iterator[Diagnostic]:
    """Everything that is wrong with some declarations."""
    for one in CHECKS:
        yield from one(declared)
