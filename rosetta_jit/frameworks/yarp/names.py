"""Names that a schema may declare, and such names for keys that are none."""

from __future__ import annotations

import re
from collections.abc import Iterable

from rosetta_jit.frameworks.yarp.limits import MAX_KEY

FIELD_NAME = re.compile(r"(?!.{101})[A-Za-z_][A-Za-z0-9_]*")
TYPE_NAME = re.compile(r"(?!.{101})[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*)*")


def unique_names(keys: Iterable[str]) -> list[str]:
    """A field name for each key: itself where it is one, or as close to it as its characters and the others allow."""
    names: dict[str, None] = {}
    for key in keys:
        name = re.sub(r"[^A-Za-z0-9_]", "_", key)[:MAX_KEY]
        name = name if FIELD_NAME.fullmatch(name) else f"_{name}"
        while name in names:
            name = f"{name}_{len(names)}"
        names[name] = None
    return list(names)
