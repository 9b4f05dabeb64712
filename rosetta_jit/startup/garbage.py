"""Fewer searches for garbage while a program is made: a compiler makes objects by the hundred thousand, and hardly a cycle among them."""

from __future__ import annotations

import gc
import sys
from collections.abc import Generator
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType
from typing import Any

SELDOM = 200_000
"""New objects between two searches; Python's own 700 make searches an eighth of the time. What is garbage meanwhile stays bounded."""


@contextmanager
def seldom_collected() -> Generator[None]:
    """Inside, Python looks for garbage seldom; where it looks seldom or never as it is, this changes nothing.

    Threads may be inside at once: who comes first says what holds, until he leaves.
    """
    before = gc.get_threshold()
    if not 0 < before[0] < SELDOM:
        yield
        return
    gc.set_threshold(SELDOM, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)


def imported(name: str) -> ModuleType:
    """A module; where it is imported now, no search looks through it afterwards, until one looks through all that the process has.

    What modules define is there to stay: to look for garbage in a hundred new ones takes a twentieth of the first program's time.
    """
    if name in sys.modules:
        return import_module(name)  # another thread may not be done with it: this waits
    with seldom_collected():
        module = import_module(name)
        _call_all_old()
    return module


def object_at(place: str) -> Any:
    """What a place `module:name` names; its module is imported when it is first asked for.

    Raises
    ------
    BrokenPackage
        The module is one of another package, and cannot be imported, or has no such name.
    """
    module, _, name = place.partition(":")
    package = module.partition(".")[0]
    try:
        return getattr(imported(module), name)
    except Exception as error:
        if package == __name__.partition(".")[0]:
            raise
        from rosetta_jit.startup.entry_points import broken

        raise broken(package, place, error) from error


def _call_all_old() -> None:
    """Put what is new where old objects are, without a look at it; what a process has frozen stays so.

    Python counts frozen objects one by one, which takes long where a server has frozen all that it had: this asks until there are some.
    """
    if _FROZEN:
        return
    if gc.get_freeze_count():
        _FROZEN.append(True)
        return
    gc.freeze()
    gc.unfreeze()


_FROZEN: list[bool] = []
"""Not empty in a process that has frozen objects."""
