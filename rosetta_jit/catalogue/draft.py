"""What can be wrong with the types that a draft is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue.resolve import nearest
from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from collections.abc import Collection


def unknown_type(name: str, known: Collection[str]) -> Diagnostic:
    """A type of a draft that no file declares."""
    near = nearest(name, known)
    help_ = f"did you mean `{near}`?" if near else "name the files that declare both types: --import FILE"
    return Diagnostic("error", "unknown-type", f"no file declares a message `{name}`", help=help_)
