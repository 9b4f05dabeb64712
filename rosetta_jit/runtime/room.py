"""How much room a message starts with: what every message is born with, and what others of its layout have come to need."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING

from rosetta_jit.kernel.state import ADDRESS, lane_word
from rosetta_jit.runtime.lanes import MOST_AT_ONCE, Lanes
from rosetta_jit.runtime.plan import begun, plan

if TYPE_CHECKING:
    from rosetta_jit.runtime.plan import Plan


def born(first: Plan) -> Plan:
    """The plan of one message, which is born from the start."""
    if not first.births:
        return first
    prototype = Lanes(first)
    prototype.bear(first.births, 0, 1)
    for lane in range(len(first.strides)):
        prototype.words[lane_word(lane, ADDRESS)] = 0
    return begun(first, bytes(prototype.memory.first).rstrip(b"\0"))


def roomier(plan_: Plan, lanes: Lanes, most: int = MOST_AT_ONCE) -> Plan:
    """The plan of one message with the room that others of its layout have come to, as long as that is no more than so many bytes."""
    room = [lanes.capacity(lane) for lane in range(len(plan_.strides))]
    sizes = tuple(map(operator.mul, room, plan_.strides))
    if sum(sizes) > most or all(map(operator.le, sizes, plan_.sizes)):
        return plan_
    wanted = plan(plan_.layout, births=plan_.births, room=room)
    return born(wanted) if wanted.size_bytes <= most else plan_
