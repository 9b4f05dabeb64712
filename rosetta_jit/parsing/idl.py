"""What a front end is: a function from a source to declarations.

Each framework offers one for every suffix of its IDL. It resolves imports through the `Load` that it is given, makes every
`Ref` absolute, checks everything that it can check without knowing a wire, and raises one `SchemaError` with all it found.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Protocol

from rosetta_jit.errors import SchemaError
from rosetta_jit.model.types import Schema
from rosetta_jit.source import Source

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic

Load = Callable[[str], Source | None]
"""Finds a file by the path that an import writes, on the search path; None where there is none."""

FrontEnd = Callable[[Source, Load], Schema]
"""All declarations of a source and of what it imports."""


def refuse(problems: Sequence[Diagnostic], most: int) -> None:
    """Raise SchemaError with the first problems, file by file and in the order of the text, where any were found."""
    if problems:
        raise SchemaError(tuple(sorted(problems[:most], key=_place)))


def _place(problem: Diagnostic) -> tuple[str, int]:
    return ("", 0) if problem.span is None else (problem.span.source.name, problem.span.start)


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
