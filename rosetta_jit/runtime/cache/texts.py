"""Code that is written by hand, as LLVM text: compiled once a machine, then found in the cache."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.runtime.cache.kernels import Cache
from rosetta_jit.runtime.cache.names import entry_name


def known(text: str) -> bytes | None:
    """The code of a text, if the cache has it."""
    cache = Cache.default()
    entry = None if cache.keeps_nothing else cache.get(entry_name(text))
    return None if entry is None else entry.image


def kept(kind: str, text: str, compiled: Callable[[], bytes]) -> bytes:
    """The code of a text: from the cache, or compiled now and put there. ``kind`` says what it is to people who look at the cache."""
    cache = Cache.default()
    if cache.keeps_nothing:  # then nobody needs a name, for which all files of the package are looked at
        return compiled()
    name = entry_name(text)
    entry = cache.get(name)
    if entry is not None:
        return entry.image
    image = compiled()
    cache.put(name, {"entry": kind}, image)
    return image
