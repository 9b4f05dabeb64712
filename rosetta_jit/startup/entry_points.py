"""What installed packages offer under a group of entry points, and the files of these packages.

`importlib.metadata` finds entry points; but its import takes as long as making sense of a mapping, and hardly a package offers any. So the
folders of `sys.path` are looked at first.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from functools import cache
from importlib.machinery import PathFinder
from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import BrokenPackage

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint


@cache
def offered(group: str) -> tuple[EntryPoint, ...]:
    """The entry points of a group, of all installed packages; looked for once in a process."""
    if not may_be_offered(group):
        return ()
    from importlib.metadata import entry_points

    return tuple(entry_points(group=group))


def loaded(group: str) -> tuple[Any, ...]:
    """What all installed packages offer under a group.

    Raises
    ------
    BrokenPackage
        One of them cannot be imported.
    """
    return tuple(_loaded(each) for each in offered(group))


def _loaded(offer: EntryPoint) -> object:
    try:
        return offer.load()
    except Exception as error:
        package = offer.module if offer.dist is None else offer.dist.name
        raise broken(package, f"{offer.group}: {offer.name} = {offer.value}", error) from error


def broken(package: str, place: str, error: Exception) -> BrokenPackage:
    """What is raised where a place in a package cannot be imported."""
    why = f"`{place}` cannot be imported ({type(error).__name__}: {error})"
    return BrokenPackage(f"the installed package `{package}` is broken: {why}; repair it, or uninstall it")


def files_of_offered(group: str) -> tuple[str, ...]:
    """All files of the packages and modules that offer something under a group, once that was loaded: its code, and data that it reads."""
    packages = dict.fromkeys(each.module.partition(".")[0] for each in offered(group))
    return tuple(file for each in packages for file in _files_of(each))


def _files_of(package: str) -> Iterator[str]:
    module = sys.modules.get(package)
    folders: list[str] = list(getattr(module, "__path__", ()))
    if not folders and getattr(module, "__file__", None):
        yield str(getattr(module, "__file__", None))
    for folder in folders:
        for inside, below, names in os.walk(folder):
            below[:] = [each for each in below if each != "__pycache__"]
            yield from (f"{inside}/{name}" for name in sorted(names))


def may_be_offered(group: str) -> bool:
    """Whether `importlib.metadata` might find entry points of the group; where this cannot be seen in folders, it might."""
    other_finders = any(hasattr(each, "find_distributions") for each in sys.meta_path if each is not PathFinder)
    return other_finders or any(_is_named_in(folder or ".", group.encode()) for folder in sys.path)


def _is_named_in(folder: str, group: bytes) -> bool:
    if folder.lower().endswith(".egg") or os.path.isfile(folder):
        return True
    return group in _entry_points_in(folder)


@cache
def _entry_points_in(folder: str) -> bytes:
    """What all packages in a folder offer; several groups are looked for in it."""
    try:
        with os.scandir(folder) as entries:
            described = [each.path for each in entries if each.name.lower().endswith((".dist-info", ".egg-info"))]
    except OSError:
        return b""
    return b"\n".join([_text_of(f"{each}/entry_points.txt") for each in described])


def _text_of(file: str) -> bytes:
    try:
        with open(file, "rb", buffering=0) as entry_points:
            return entry_points.read()
    except OSError:
        return b""
