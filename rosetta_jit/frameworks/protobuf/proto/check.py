"""What protoc refuses although every name in it is known; the list is the table of contents.

https://protobuf.dev/programming-guides/proto2/, .../proto3/ and .../editions/
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.protobuf.proto.check_enums import check_enums
from rosetta_jit.frameworks.protobuf.proto.check_extensions import check_extensions
from rosetta_jit.frameworks.protobuf.proto.check_features import check_features
from rosetta_jit.frameworks.protobuf.proto.check_fields import check_fields
from rosetta_jit.frameworks.protobuf.proto.check_json import check_json
from rosetta_jit.frameworks.protobuf.proto.check_numbers import check_numbers
from rosetta_jit.frameworks.protobuf.proto.options import check_options

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations

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


def check(declared: Declarations) -> Iterator[Diagnostic]:
    """Everything that is wrong with some declarations."""
    for one in CHECKS:
        yield from one(declared)
