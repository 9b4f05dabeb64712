"""A file and those that declare the types it uses. LCM has no imports: a type is looked for in the file of its name.

``pkg.sub.type_t`` is declared in ``pkg/sub/type_t.lcm`` or ``lcm/pkg/sub/type_t.lcm`` on the search path, or in ``type_t.lcm`` beside the
file that uses it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.lcm import diagnostics as say
from rosetta_jit.frameworks.lcm.limits import MAX_FILES, MAX_PROBLEMS
from rosetta_jit.frameworks.lcm.reading import read
from rosetta_jit.frameworks.lcm.shape import PRIMITIVES
from rosetta_jit.frameworks.lcm.tree import Declaration, File, Member, Name, StructDeclaration, qualified
from rosetta_jit.source import Source
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.parsing.idl import Load


@dataclass(slots=True)
class Gathered:
    """Declarations by qualified name, and the sources that they come from."""

    declarations: dict[str, Declaration] = field(default_factory=dict[str, "Declaration"])
    sources: list[str] = field(default_factory=list[str])

    def add(self, file: File, problems: list[Diagnostic]) -> None:
        self.sources.append(file.source.name)
        for each in file.declarations:
            name = qualified(each.package, each.name.text)
            if len(problems) >= MAX_PROBLEMS:
                return
            if each.name.text in PRIMITIVES:
                problems.append(say.primitive_declared(each.name))
            elif name in self.declarations:
                problems.append(say.repeated_type(each.name, name, self.declarations[name].name.span))
            else:
                self.declarations[name] = each


@dataclass(frozen=True, slots=True)
class _Use:
    """A type that a field names, and the folder of the file that does, as it was asked for."""

    name: str
    place: Name
    folder: str


def gather(source: Source, load: Load, problems: list[Diagnostic]) -> Gathered:
    """Read a source and what it leads to; a type that is found nowhere is a problem."""
    found = Gathered()
    root = read(source, problems)
    found.add(root, problems)
    pending = list(_uses(root, ""))[::-1]
    unknown: set[str] = set()
    while pending and len(problems) < MAX_PROBLEMS:
        use = pending.pop()
        if use.name in found.declarations or use.name in unknown:
            continue
        path_and_file = None if len(found.sources) > MAX_FILES else _declaring(use, load, found, problems)
        if path_and_file is None:
            unknown.add(use.name)
            problems.append(say.unknown_type(use.place, use.name, tuple(_candidates(use)), (*PRIMITIVES, *found.declarations)))
            continue
        path, file = path_and_file
        found.add(file, problems)
        pending += list(_uses(file, path.rpartition("/")[0]))[::-1]
    return found


def _uses(file: File, folder: str) -> Iterator[_Use]:
    for declaration in file.declarations:
        if isinstance(declaration, StructDeclaration):
            for item in declaration.items:
                if isinstance(item, Member) and item.type.text not in PRIMITIVES:
                    yield _Use(qualified(declaration.package, item.type.text), item.type, folder)


def _declaring(use: _Use, load: Load, found: Gathered, problems: list[Diagnostic]) -> tuple[str, File] | None:
    """The file that declares a type, and the path by which it was found; its problems are reported, those of others are not."""
    for path in _candidates(use):
        source = load(path)
        if source is None or source.name in found.sources:
            continue
        mistakes: list[Diagnostic] = []
        file = read(source, mistakes)
        if any(qualified(each.package, each.name.text) == use.name for each in file.declarations):
            problems += mistakes
            return path, file
    return None


def _candidates(use: _Use) -> Iterator[str]:
    path = use.name.replace(".", "/") + ".lcm"
    beside = path.rpartition("/")[2]
    yield from dict.fromkeys((path, f"lcm/{path}", f"{use.folder}/{beside}" if use.folder else beside))
