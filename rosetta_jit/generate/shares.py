"""Which fields of an object a decoder sets: all of them, or the share of one of several wires.

Fields are given by the ways to them, as `pose.position`; the empty way is the whole message.
"""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.kernel.ir import Copy, Fill, Kernel, Place, Reserve, SetField, Stmt
from rosetta_jit.kernel.shape import statements

Ways = frozenset[tuple[str, ...]]
WHOLE: Ways = frozenset({()})
"""All of an object."""


def within(ways: Ways, field: str) -> Ways:
    """What is set of a field: `WHOLE`, ways into it, or nothing."""
    return WHOLE if () in ways else frozenset(way[1:] for way in ways if way[0] == field)


def changed_lanes(kernel: Kernel) -> tuple[int, ...]:
    """The lanes whose rows stay from one message to the next, and of which a kernel changes some: of arrays that several wires fill."""
    changed = {lane for body in kernel.bodies for stmt, _ in statements(body) for lane in _changed(stmt)}
    return tuple(sorted(changed & set(kernel.kept) - {0}))


def _changed(stmt: Stmt) -> Iterator[int]:
    match stmt:
        case SetField(place) | Copy(Place() as place) | Fill(Place() as place):
            yield place.lane
        case Reserve(lane, _):
            yield lane
        case _:
            return
