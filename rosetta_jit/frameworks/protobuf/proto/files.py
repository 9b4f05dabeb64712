"""A file and all that it imports, dependencies first."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import file_diagnostics as of_file
from rosetta_jit.frameworks.protobuf.limits import MAX_FILES
from rosetta_jit.frameworks.protobuf.proto.file_set import Edges, FileSet
from rosetta_jit.frameworks.protobuf.proto.reading import read
from rosetta_jit.frameworks.protobuf.proto.tree import File, Import, ImportKind
from rosetta_jit.source import Source
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.parsing.idl import Load


@dataclass(frozen=True, slots=True)
class _Open:
    """A file some of whose imports are still to be read."""

    file: File
    waiting: Iterator[Import]
    edges: list[tuple[str, ImportKind]]


def gather(source: Source, load: Load, problems: list[Diagnostic]) -> FileSet:
    """Read a source and what it imports; missing files, cycles and repeated imports are problems."""
    done: dict[str, File] = {}
    imports: dict[str, Edges] = {}
    found: dict[str, File | None] = {}
    root = read(source, problems)
    stack = [_open(root)] if root else []
    while stack:
        top = stack[-1]
        import_ = next(top.waiting, None)
        if import_ is None:
            stack.pop()
            done[top.file.name], imports[top.file.name] = top.file, tuple(top.edges)
            continue
        if import_.path not in found:
            found[import_.path] = _find(import_, load, problems)
        file = found[import_.path]
        if file is not None and _is_new(import_, file, stack, problems):
            top.edges.append((file.name, import_.kind))
            if file.name not in done and len(found) <= MAX_FILES:
                stack.append(_open(file))
    if len(found) > MAX_FILES:
        problems.append(of_file.too_many_files(MAX_FILES))
    return FileSet(tuple(done.values()), imports)


def _open(file: File) -> _Open:
    return _Open(file, iter(file.imports), [])


def _find(import_: Import, load: Load, problems: list[Diagnostic]) -> File | None:
    source = load(import_.path)
    if source is not None:
        return read(source, problems)
    file = well_known(import_.path)
    if file is None:
        problems.append(of_file.missing_file(import_.span, import_.path))
    return file


def _is_new(import_: Import, file: File, stack: list[_Open], problems: list[Diagnostic]) -> bool:
    """Whether an import neither repeats another one of its file nor leads back to a file that is being read."""
    names = [entry.file.name for entry in stack]
    if file.name in names:
        problems.append(of_file.import_cycle(import_.span, [*names[names.index(file.name) :], file.name]))
        return False
    if any(name == file.name for name, _ in stack[-1].edges):
        problems.append(of_file.repeated_import(import_.span, import_.path))
        return False
    return True


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
