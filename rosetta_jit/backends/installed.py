"""Which backends there are: ours, and those of installed packages."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import cast

from rosetta_jit.backends.backend import Backend
from rosetta_jit.startup.entry_points import loaded

GROUP = "rosetta_jit.backends"
"""The entry-point group in which packages offer backends of their own: a `Backend` each."""

USUAL = "llvm"
"""What runs kernels if nothing is said: what numba adds, a type for users' own functions, `Decoder.kernel` has in any case."""

OURS = (
    Backend("numba", types_kernels=True),
    Backend(USUAL),
    Backend("python", "rosetta_jit.backends.python.function:runnable", "rosetta_jit.backends.python.function:python_text"),
    Backend("interpreter", "rosetta_jit.kernel.interpret:runnable"),
)


@cache
def installed() -> Mapping[str, Backend]:
    """Every backend by name; none takes the place of ours."""
    return {each.name: each for each in (*cast("tuple[Backend, ...]", loaded(GROUP)), *OURS)}


def backend_named(name: str | None) -> Backend | None:
    """The backend of a name, or the usual one; None where there is none. Others are looked for where it is none of ours."""
    ours = next((each for each in OURS if each.name == (name or USUAL)), None)
    return ours or installed().get(name or USUAL)
