"""What a routine has to do with the kernel that calls it: the routines that it calls itself, and the lanes that it names."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain

from rosetta_jit.kernel.ir import Routine
from rosetta_jit.kernel.nodes import (
    Advance,
    Block,
    Call,
    Capacity,
    Copy,
    Expr,
    Fill,
    Get,
    HostCall,
    IsText,
    Nearest,
    Place,
    Reserve,
    SetField,
    Stmt,
    Used,
)
from rosetta_jit.kernel.walk import extents_of, flat, parts_of, subexpressions


def called_routines(body: Block) -> tuple[str, ...]:
    """The names of the routines that a block calls, each once."""
    return tuple(dict.fromkeys(stmt.routine for stmt in flat(body) if type(stmt) is Call))


def named_lanes(routine: Routine) -> set[int]:
    """The lanes that a routine names: those that it reads or writes, and those that its contract is about."""
    every = flat(routine.body)
    claimed = chain.from_iterable(map(subexpressions, (*routine.requires, *routine.ensures)))
    return {lane for node in (*every, *parts_of(every), *claimed) for lane in _lanes(node)}


def _lanes(node: Stmt | Expr) -> Iterable[int]:
    match node:
        case Used(lane) | Capacity(lane) | Reserve(lane) | Advance(lane):
            return (lane,)
        case Get(_, place) | SetField(place):
            return (place.lane,)
        case IsText(address) | Nearest(address) | Fill(address):
            addresses = (address,)
        case Copy(target, source):
            addresses = (target, source)
        case HostCall():
            addresses = tuple(extent.address for extent in extents_of(node))
        case _:
            return ()
    return (each.lane for each in addresses if isinstance(each, Place))
