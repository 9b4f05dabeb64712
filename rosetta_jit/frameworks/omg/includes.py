"""Where the file of an `#include` is looked for."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.parsing.idl import Load
    from rosetta_jit.source import Source

SHIPPED = ("", "openrtm", "ros2")
"""Folders of the search path in which files know each other by their names alone."""


def find(path: str, asked: str, load: Load) -> tuple[str, Source] | None:
    """The file that an `#include` means, and the name under which it was found.

    Parameters
    ----------
    path
        As the `#include` writes it.
    asked
        The name under which the file around it was found: its folder comes first.
    """
    for candidate in dict.fromkeys(_candidates(path, asked)):
        source = load(candidate)
        if source is not None:
            return candidate, source
    return None


def _candidates(path: str, asked: str) -> Iterator[str]:
    folder = PurePosixPath(asked).parent
    for start in (*(() if folder.is_absolute() else (str(folder),)), *SHIPPED):
        candidate = _normal(f"{start}/{path}" if start not in ("", ".") else path)
        if candidate is not None:
            yield candidate


def _normal(path: str) -> str | None:
    """The path without `.` and `..`; None where it leaves the search path, or is no name of a file."""
    if path.startswith(("/", "~")) or "\\" in path or ":" in path or not path.isprintable():
        return None
    parts: list[str] = []
    for part in path.split("/"):
        if part == ".." and not parts:
            return None
        if part == "..":
            parts.pop()
        elif part not in ("", "."):
            parts.append(part)
    return "/".join(parts) or None
