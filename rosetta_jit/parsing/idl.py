"""What a front end is: a function from a source to declarations.

Each framework offers one for every suffix of its IDL. It resolves imports through the `Load` that it is given, makes every
`Ref` absolute, checks everything that it can check without knowing a wire, and raises one `SchemaError` with all it found.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Protocol

from rosetta_jit.model.types import Schema
from rosetta_jit.source import Source

Load = Callable[[str], Source | None]
"""Finds a file by the path that an import writes, on the search path; None where there is none."""

FrontEnd = Callable[[Source, Load], Schema]
"""All declarations of a source and of what it imports."""


class FrontEnds(Protocol):
    """The front ends of all frameworks."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Of all files that are read."""
        ...

    def guesses(self, type_: str) -> Iterable[str]:
        """The files in which a type of that name is likely declared."""
        ...

    def homes(self, type_: str) -> Iterable[str]:
        """The same, of all frameworks."""
        ...

    def find(self, file: str) -> FrontEnd | None:
        """The front end of a file, None where its suffix is not known."""
        ...
