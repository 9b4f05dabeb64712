"""The names of cache files: SHA-256 of all that their content depends on.

Compiled code depends on the kernel's text and on the `surroundings`: the versions of what compiled it, the instruction set of the CPU, and
the layout of CPython's objects, which the entry reads directly. A file of other surroundings is simply never found.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from functools import cache

from rosetta_jit.runtime.code.processor import processor
from rosetta_jit.startup.sha import sha256

NO_CODE = frozenset(("bridge", "cli", "demo", "draft", "explain", "generate", "logs", "transports"))
"""Our packages that use compiled code and have no part in it: nothing that compiles or loads it imports them."""

ABI = 2
"""Raise it when a kernel, the holder's state or the entry changes its meaning without a change of text."""


def entry_name(kernel_text: str) -> str:
    """The name of the entry with the code of a kernel, for this machine and these versions."""
    return _name("entry", kernel_text)


def request_name(request: Mapping[str, object]) -> str:
    """The name of the answer to a request: a mapping's path, the search path, options, as plain values."""
    return _name("request", repr(sorted(request.items())))


@cache
def surroundings() -> str:
    """All that compiled code depends on besides its kernel, as text. It stays the same as long as a process lives."""
    import llvmlite

    facts: dict[str, object] = {
        "abi": ABI,
        "package": _package_digest(),
        "llvmlite": llvmlite.__version__,
        "numba": numba_version(),
        "processor": processor(),
        "python": [sys.implementation.cache_tag, getattr(sys, "abiflags", ""), hasattr(sys, "gettotalrefcount")],
    }
    return repr(facts)


def _name(kind: str, text: str) -> str:
    return sha256(f"{kind}\0{surroundings()}\0{text}".encode("utf-8", "surrogatepass")).hexdigest()


def _package_digest() -> str:
    """Stands for our version: changes with each installation and, for us who work on the compiler, with each edit of a source file."""
    package = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
    folders, files, skipped = [package], list[str](), {f"{package}/{name}" for name in (*NO_CODE, "share")}
    for folder in folders:  # grows while it is gone through
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.is_dir(follow_symlinks=False):
                    folders += [entry.path] if entry.name != "__pycache__" and entry.path not in skipped else []
                else:
                    status = entry.stat()
                    files.append(f"{entry.path} {status.st_size} {status.st_mtime_ns}\n")
    files.sort()
    return sha256("".join(files).encode("utf-8", "surrogatepass")).hexdigest()


@cache
def numba_version() -> str:
    """The name of numba's metadata folder, because neither numba nor importlib.metadata may be imported at a warm start: both are slow."""
    found = (finder.find_spec("numba", None) for finder in sys.meta_path)  # `importlib.util` would have to be imported
    spec = next(filter(None, found), None)
    if spec is None or spec.origin is None:
        return ""
    beside = os.listdir(os.path.dirname(os.path.dirname(spec.origin)))
    return ", ".join(sorted(name for name in beside if name.startswith("numba-") and name.endswith(".dist-info")))
