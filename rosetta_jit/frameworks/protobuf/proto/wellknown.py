"""The files that come with protobuf: `google/protobuf/timestamp.proto` and its kin, wherever no others are found."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rosetta_jit.frameworks.protobuf.proto.tree import File

FOLDER = "google/protobuf/"
WELL_KNOWN = frozenset(
    ("any", "api", "descriptor", "duration", "empty", "field_mask", "source_context", "struct", "timestamp", "type", "wrappers")
)


def well_known(path: str) -> File | None:
    """One of protobuf's own files, from the Python package; None where it has no such file."""
    name = path.removeprefix(FOLDER).removesuffix(".proto")
    if name not in WELL_KNOWN or path != f"{FOLDER}{name}.proto":
        return None
    from google.protobuf.descriptor_pb2 import FileDescriptorProto

    from rosetta_jit.frameworks.protobuf.proto.descriptor_reading import read_files

    module = import_module(f"google.protobuf.{name}_pb2")
    return read_files([FileDescriptorProto.FromString(module.DESCRIPTOR.serialized_pb)], [])[0]
