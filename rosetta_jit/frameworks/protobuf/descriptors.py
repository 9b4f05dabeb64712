"""Schemas from protobuf's own descriptors: a `FileDescriptorSet`, or a generated message class.

Only the serialised descriptors are read; no descriptor pool is asked or filled.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.protobuf import file_diagnostics as of_file
from rosetta_jit.frameworks.protobuf.limits import MAX_REPORTED
from rosetta_jit.frameworks.protobuf.proto.descriptor_reading import read_files
from rosetta_jit.frameworks.protobuf.proto.file_set import file_set
from rosetta_jit.frameworks.protobuf.proto.judge import schema_of
from rosetta_jit.model.types import Schema
from rosetta_jit.parsing.idl import refuse

if TYPE_CHECKING:
    from google.protobuf.descriptor import FileDescriptor
    from google.protobuf.descriptor_pb2 import FileDescriptorProto, FileDescriptorSet
    from google.protobuf.message import Message


def from_file_descriptor_set(data: bytes | FileDescriptorSet) -> Schema:
    """The schema of the files that ``protoc --include_imports --descriptor_set_out`` writes.

    Parameters
    ----------
    data
        A ``FileDescriptorSet`` or its bytes. It must hold all that its files import.

    Raises
    ------
    SchemaError
        Where the bytes are damaged, a file is missing, or a file breaks a rule of the language.
    """
    from google.protobuf.descriptor_pb2 import FileDescriptorSet
    from google.protobuf.message import DecodeError

    try:
        files = FileDescriptorSet.FromString(data) if isinstance(data, bytes) else data
    except DecodeError:
        raise SchemaError((of_file.bad_descriptor("its bytes are damaged"),)) from None
    return _schema(list(files.file))


def from_message_class(cls: type[Message]) -> Schema:
    """The schema of a message class of protobuf's Python package: all of its file, and of what that imports.

    Raises
    ------
    SchemaError
        Where the file is of an edition that is not known.
    """
    from google.protobuf.descriptor_pb2 import FileDescriptorProto

    files = _dependencies_first(cast("FileDescriptor", cls.DESCRIPTOR.file))
    return _schema([FileDescriptorProto.FromString(file.serialized_pb) for file in files])


def _schema(files: list[FileDescriptorProto]) -> Schema:
    problems: list[Diagnostic] = []
    found = file_set(read_files(files, problems), problems)
    refuse(problems, MAX_REPORTED)
    return schema_of(found)


def _dependencies_first(root: FileDescriptor) -> list[FileDescriptor]:
    done: dict[str, FileDescriptor] = {}
    stack = [(root, iter(root.dependencies))]
    while stack:
        file, waiting = stack[-1]
        dependency = next((one for one in waiting if one.name not in done), None)
        if dependency is None:
            done[file.name] = file
            stack.pop()
        else:
            stack.append((dependency, iter(dependency.dependencies)))
    return list(done.values())
