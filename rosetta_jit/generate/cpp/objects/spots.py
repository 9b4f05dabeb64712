"""Where values are in the classes that generated C++ fills and reads."""

from __future__ import annotations

from rosetta_jit.generate.c.holder.within import Within
from rosetta_jit.model.types import Type
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Spot:
    """A value of a class: ``at`` is the expression for it, ``owner`` and ``field`` those of what has it, where that is a class."""

    at: str
    owner: str = ""
    field: str = ""


@dataclass(frozen=True, slots=True)
class Direct:
    """A lane whose rows are the elements of a container: its span in the message's row, and the container."""

    lane: int
    row: str
    spot: Spot


@dataclass(frozen=True, slots=True)
class Listed:
    """A list: where it is, and what its elements are."""

    direct: Direct
    element: Type


@dataclass(frozen=True, slots=True)
class ListWithin:
    """A list that elements of lists have: what its own elements are, and how kernels find it."""

    listed: Listed
    within: Within


def container_type(at: str) -> str:
    """The type of a container."""
    return f"std::remove_const_t<std::remove_reference_t<decltype({at})>>"
