"""Files after those that they import, and whose names each of them can use."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import file_diagnostics as of_file
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.frameworks.protobuf.proto.tree import File, ImportKind

Edges = tuple[tuple[str, "ImportKind"], ...]
"""What a file imports: names of files, and what for."""


@dataclass(frozen=True, slots=True)
class FileSet:
    """Files after those that they import, and who imports whom."""

    files: tuple[File, ...]
    imports: Mapping[str, Edges]

    def visible_from(self, name: str, *, in_options: bool = False) -> frozenset[str]:
        """The files whose names a file can use: itself, its imports, and what these import publicly."""
        seen = {name}
        waiting = [target for target, kind in self.imports.get(name, ()) if in_options or kind != "option"]
        while waiting:
            target = waiting.pop()
            if target not in seen:
                seen.add(target)
                waiting += [further for further, kind in self.imports.get(target, ()) if kind == "public"]
        return frozenset(seen)


def file_set(files: Iterable[File], problems: list[Diagnostic]) -> FileSet:
    """Files that are at hand already, as those of a descriptor set."""
    files = list(files)
    names = {file.name for file in files}
    imports: dict[str, Edges] = {}
    kept: list[File] = []
    for file in files:
        if file.name in imports:
            problems.append(of_file.repeated_file(file.name))
            continue
        # Files that are imported for options alone need not come along: the options are known to whoever made the descriptor.
        needed = (import_ for import_ in file.imports if import_.kind != "option")
        problems += [of_file.missing_file(None, import_.path) for import_ in needed if import_.path not in names]
        imports[file.name] = tuple((import_.path, import_.kind) for import_ in file.imports)
        kept.append(file)
    return FileSet(tuple(kept), imports)
