"""The peer: a bottle reader that knows no schema and makes a tree of Python values of each message."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.frameworks.yarp.bottle import read
from rosetta_jit.frameworks.yarp.tags import DIALECTS

if TYPE_CHECKING:
    from collections.abc import Callable


def dynamic_reader(dialect: str) -> Callable[[bytes], object]:
    """A function from a message of that dialect to its tree."""
    tags = DIALECTS[dialect]
    return lambda message: read(message, tags)
