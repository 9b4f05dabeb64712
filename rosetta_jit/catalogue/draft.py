"""What can be wrong with the types that a draft is asked for."""

from __future__ import annotations

from collections.abc import Collection

from rosetta_jit.catalogue.suggestions import nearest
from rosetta_jit.diagnostics import Diagnostic, error


def unknown_type(name: str, known: Collection[str]) -> Diagnostic:
    near = nearest(name, known)
    help_ = f"did you mean `{near}`?" if near else "name the files that declare both types: --import FILE"
    return error("unknown-type", f"no file declares a message `{name}`", help_=help_)
