"""Which frameworks there are, ours and those of installed packages, and which of them reads a file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import TYPE_CHECKING, cast

from rosetta_jit.model.types import name_parts
from rosetta_jit.source import shipped_folders
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.entry_points import loaded
from rosetta_jit.startup.garbage import imported

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Framework
    from rosetta_jit.parsing.idl import FrontEnd

GROUP = "rosetta_jit.frameworks"
"""The entry-point group in which packages offer frameworks of their own: a `Framework` each."""


OURS = ("yarp", "protobuf", "ros1", "corba", "ros2", "lcm", "orocos")
"""Folders beside this file with a `framework.FRAMEWORK`. Of several that read files of a suffix, the first does if nothing else decides."""


@cache
def _definitions() -> str:
    """Where the shipped definitions lie, each framework's in a folder of its name."""
    return str(shipped_folders()[0])


@cache
def shipped() -> tuple[Framework, ...]:
    """The frameworks that come with rosetta_jit."""
    return tuple(imported(f"rosetta_jit.frameworks.{name}.framework").FRAMEWORK for name in OURS)


@cache
def installed() -> Mapping[str, Framework]:
    """Every framework by name: ours, and those of installed packages, which cannot take the place of ours."""
    ours = {framework.name: framework for framework in shipped()}
    offers = cast("tuple[Framework, ...]", loaded(GROUP))
    return ours | {framework.name: framework for framework in offers if framework.name not in ours}


@dataclass(frozen=True, slots=True)
class Readers:
    """Finds the front end of a file among frameworks, of which a request may name one, or one of its encodings."""

    frameworks: Mapping[str, Framework]
    framework: str | None = None
    encoding: str | None = None

    def owner(self, file: str) -> Framework | None:
        """The framework whose IDL a file is; None if no front end reads it.

        Of several that read such files, it is the one among whose shipped definitions it lies (``idl/ros1/std_msgs/Header.msg``), that the
        request names, that has its encoding, or whose ``files`` the name matches, or the first.
        """
        readers = [each for each in self.frameworks.values() if each.reads(file)]
        shipped = [each for each in readers if file.startswith(f"{_definitions()}/{each.name}/")]
        named = [each for each in readers if each.name == self.framework]
        encoding = [each for each in readers if self.encoding in each.encodings]
        matching = [each for each in readers if each.claims(file)]
        return next(iter([*shipped, *named, *encoding, *matching, *readers]), None)

    def find(self, file: str) -> FrontEnd | None:
        """The front end of a file, or None."""
        owner = self.owner(file)
        return None if owner is None else owner.front_end(file)

    def guesses(self, type_: str) -> Iterator[str]:
        """The files in which a type of that name is likely declared."""
        return self._files(type_, self.likely)

    def homes(self, type_: str) -> Iterator[str]:
        """The same, whichever framework the request means: a mapping has types of two."""
        return self._files(type_, tuple(self.frameworks.values()))

    @staticmethod
    def _files(type_: str, frameworks: tuple[Framework, ...]) -> Iterator[str]:
        parts = name_parts(type_)
        if not parts:
            return
        names = ("/".join((*parts[:-1], "msg", parts[-1])), "/".join(parts)) if len(parts) > 1 else parts
        for framework in sorted(frameworks, key=lambda each: not any(each.claims(type_ + suffix) for suffix in each.idl)):
            for folder in ("", f"{framework.name}/"):
                yield from (folder + name + suffix for name in names for suffix in framework.idl if suffix not in framework.several)
            yield from framework.files_of(parts)

    @property
    def likely(self) -> tuple[Framework, ...]:
        """All frameworks, or the one that the request means."""
        every = tuple(self.frameworks.values())
        return tuple(each for each in every if each.name == self.framework or self.encoding in each.encodings) or every

    @property
    def suffixes(self) -> tuple[str, ...]:
        """All suffixes that are read; those of the framework that the request means come first."""
        return tuple(dict.fromkeys(suffix for each in (*self.likely, *self.frameworks.values()) for suffix in each.idl))
