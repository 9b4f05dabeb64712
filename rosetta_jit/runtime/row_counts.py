"""How many rows the lanes of a new message have: those of its initial values, and as many as earlier messages of its layout needed."""

from __future__ import annotations

import operator

import numpy as np

from rosetta_jit.kernel.state import ADDRESS, CLEAN, EPOCH, VALID, lane_word
from rosetta_jit.runtime.lanes import MOST_AT_ONCE, Lanes
from rosetta_jit.runtime.memory_plan import Plan, begun, plan


def initialised(first: Plan) -> Plan:
    """The plan of one message, which has its initial values from the start."""
    if not first.initial:
        return first
    prototype = Lanes(first)
    prototype.initialise(first.initial, 0, 1)
    made = begun_as(prototype)
    assert made is not None, "there is room for the initial values of a message"
    return made


def begun_as(lanes: Lanes) -> Plan | None:
    """The plan of lanes of one message, where it begins as they are; None if they have been given more memory, or are not in order."""
    plan, state = lanes.plan, lanes.words.tolist()
    for lane, offset in enumerate(plan.offsets):
        if state[lane_word(lane, ADDRESS)] != lanes.address + offset or state[VALID] != CLEAN:
            return None
        state[lane_word(lane, ADDRESS)] = 0
    state[EPOCH] = 0
    content = bytes(lanes.memory.first)[plan.state_bytes :].rstrip(b"\0")
    return begun(plan, np.array(state, np.int64).tobytes() + content)


def roomier(plan_: Plan, lanes: Lanes, most: int = MOST_AT_ONCE) -> Plan:
    """The plan of one message with the room that others of its layout have come to, as long as that is no more than so many bytes."""
    room = [lanes.capacity(lane) for lane in range(len(plan_.strides))]
    sizes = tuple(map(operator.mul, room, plan_.strides))
    if sum(sizes) > most or all(map(operator.le, sizes, plan_.sizes)):
        return plan_
    wanted = plan(plan_.layout, initial=plan_.initial, room=room)
    return initialised(wanted) if wanted.size_bytes <= most else plan_
