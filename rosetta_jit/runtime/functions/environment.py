"""What numba's compiler depends on besides the function: versions, settings, and packages that extend it.

Numba takes its settings from `NUMBA_…` variables and from a file in the working directory, each time that it compiles. It is not imported
to find out: a process that finds its kernels in the cache never imports it.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from collections.abc import Iterator
from typing import Any, cast

import numpy as np

from rosetta_jit.catalogue import uncertain as words
from rosetta_jit.runtime.cache.names import numba_version

SETTINGS = ".numba_config.yaml"
"""The name of numba's own file of settings (numba/core/config.py)."""

ENTRY_POINTS = b"numba_extensions"
"""The group of entry points that numba calls before it compiles for the first time (numba/core/entrypoints.py)."""

OF_NUMBA = frozenset(("USING_SVML",))
"""Settings that numba itself finds out when it is imported."""


def environment() -> str:
    """Versions and settings, as text."""
    settings = sorted((name, value) for name, value in os.environ.items() if name.startswith("NUMBA_"))
    return repr((sys.version, np.__version__, numba_version(), settings, _read(SETTINGS)))


def doubts() -> Iterator[str]:
    """Why the text of `environment` does not say all."""
    if not numba_version():
        yield words.unknown_numba()
    extending = sorted(_extending())
    if extending:
        yield words.extended_by_package(", ".join(extending))
    config = sys.modules.get("numba.core.config")
    if config is not None:
        yield from map(words.set_by_hand, sorted(_set_by_hand(config)))


def _extending() -> Iterator[str]:
    """The installed packages that extend numba, by their metadata: `importlib.metadata` would take a hundred times as long."""
    for folder in sys.path:
        try:
            beside = os.listdir(folder or ".")  # noqa: PTH208 - pathlib makes an object of each name
        except NotADirectoryError:
            yield from _extending_in_archive(folder)
        except OSError:
            continue
        else:
            packages = [name for name in beside if name.endswith((".dist-info", ".egg-info"))]
            yield from (name for name in packages if ENTRY_POINTS in _read(f"{folder or '.'}/{name}/entry_points.txt"))


def _extending_in_archive(path: str) -> Iterator[str]:
    from importlib.metadata import distributions

    for each in distributions(path=[path]):
        if ENTRY_POINTS in (each.read_text("entry_points.txt") or "").encode():
            yield each.name


def _read(path: str) -> bytes:
    try:
        with open(path, "rb") as file:  # noqa: PTH123 - as above
            return file.read()
    except OSError:
        return b""


def _set_by_hand(config: Any) -> Iterator[str]:
    """Settings that are not what the environment makes of them: those of a second copy of numba's module, made now."""
    config.reload_config()  # as numba does before it compiles
    made: Any = importlib.util.module_from_spec(config.__spec__)
    config.__spec__.loader.exec_module(made)
    now, fresh = cast("dict[str, object]", vars(config)), cast("dict[str, object]", vars(made))
    for name, value in now.items():
        if name.isupper() and name not in OF_NUMBA and (name not in fresh or repr(fresh[name]) != repr(value)):
            yield name
