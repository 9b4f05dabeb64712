"""Modules that are imported when something of them is first used.

A process that starts quickly runs compiled code, and hardly what that leaves to Python. Not for what a definition of a class or a function
needs; what was found is an attribute from then on, as a module's own.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any


class Late:
    """Stands for a module."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> Any:
        found = getattr(import_module(self._name), name)
        setattr(self, name, found)
        return found


def late(package: str, *names: str) -> list[Late]:
    """Modules of a package, to be assigned to their names; under ``TYPE_CHECKING`` they are imported as always."""
    return [Late(f"{package}.{name}") for name in names]


def late_modules(package: str, ending: str = "") -> Callable[[str], Late]:
    """The ``__getattr__`` of a package of which some modules, by how their names end, are late wherever they are imported from it."""

    def __getattr__(name: str) -> Late:  # noqa: N807 - what it becomes
        if name.startswith("_") or not name.endswith(ending):
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return Late(f"{package}.{name}")

    return __getattr__
