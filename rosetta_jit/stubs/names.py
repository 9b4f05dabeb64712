"""Identifiers of stubs: of structs in their module, of fields in their class. What is none in Python is left out, or named otherwise."""

from __future__ import annotations

import builtins
import keyword
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

MODULES = ("builtins", "collections", "numpy", "rosetta_jit", "typing", "typing_extensions")
"""What a stub imports."""

RESERVED = frozenset({*dir(builtins), *keyword.kwlist, "Decoder", "Encoder", "decoder", "encoder", *MODULES})
"""Names that mean something else in the text of a stub."""


def is_attribute(name: str) -> bool:
    """Whether an attribute of that name can be written down, and means itself: names of two underscores are changed inside classes."""
    return name.isascii() and name.isidentifier() and not keyword.iskeyword(name) and not name.startswith("__") and name not in MODULES


def class_names(structs: Iterable[str]) -> dict[str, str]:
    """Identifiers for qualified names: the last part alone where no other has it."""
    parts = {name: [re.sub(r"\W", "_", part, flags=re.ASCII) for part in _parts(name)] for name in structs}
    short = [_safe(each[-1]) for each in parts.values()]
    found: dict[str, str] = {}
    for name, each in parts.items():
        wanted = _safe(each[-1])
        candidate = wanted if short.count(wanted) == 1 else _safe("_".join(each))
        while candidate in found.values():
            candidate += "_"
        found[name] = candidate
    return found


def _parts(name: str) -> list[str]:
    return [part for part in name.replace("::", "/").replace(".", "/").split("/") if part] or ["Message"]


def _safe(name: str) -> str:
    """An identifier that begins with a letter, and means nothing else."""
    name = name if name[:1].isalpha() else f"v{name}"
    return f"{name}_" if name in RESERVED else name
