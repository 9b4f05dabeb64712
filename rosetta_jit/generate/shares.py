"""Which fields of an object a decoder sets: all of them, or the share of one of several wires.

Fields are given by the ways to them, as `pose.position`; the empty way is the whole message.
"""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Copy, Fill, Place, Reserve, SetField, Stmt
from rosetta_jit.kernel.walk import statements

Ways = frozenset[tuple[str, ...]]
WHOLE: Ways = frozenset({()})
"""All of an object."""


def within(ways: Ways, field: str) -> Ways:
    """What is set of a field: `WHOLE`, ways into it, or nothing."""
    return WHOLE if () in ways else frozenset(way[1:] for way in ways if way[0] == field)


def changed_lanes(kernel: Kernel) -> tuple[int, ...]:
    """The lanes of arrays that several wires fill: those whose rows stay, and of which a kernel changes some, and those that it moves."""
    changed = {lane for body in kernel.bodies for stmt, _ in statements(body) for lane in _changed(stmt)}
    return tuple(sorted((changed & set(kernel.kept) | moved_lanes(kernel)) - {0}))


def moved_lanes(kernel: Kernel) -> frozenset[int]:
    """The lanes of the holder that a kernel starts with empty, but takes something from that the message before has left there."""
    if not kernel.kept:
        return frozenset()
    copied = (stmt.source for body in kernel.bodies for stmt, _ in statements(body) if isinstance(stmt, Copy))
    return frozenset(each.lane for each in copied if isinstance(each, Place) and each.lane < kernel.lanes) - {*kernel.kept}


def _changed(stmt: Stmt) -> Iterator[int]:
    match stmt:
        case SetField(place) | Copy(Place() as place) | Fill(Place() as place):
            yield place.lane
        case Reserve(lane, _):
            yield lane
        case _:
            return
