"""Undoing: what a change may overwrite is saved before, and put back if the change is refused half-way.

Saved are the rows of a message and of those around it, and whatever lies in the lanes that one field reaches. A lane may move meanwhile.
"""

from __future__ import annotations

from rosetta_jit.kernel.state import VALID, WASTED
from rosetta_jit.runtime.holder.message import Message, known_rows
from rosetta_jit.runtime.holder.record import Child, Items, Node, Pairs, Record, Scalar
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Saved:
    """How many rows each lane had, two words of the state, and bytes: of which lane, and from which on."""

    used: tuple[int, ...]
    words: tuple[int, int]
    contents: tuple[tuple[int, int, bytes], ...]


def lanes_within(node: Node) -> frozenset[int]:
    """The lanes that a field reaches, but for the one of its own row."""
    found: set[int] = set()
    pending, seen = [node], set[int]()
    while pending:
        each = pending.pop()
        if id(each) in seen or isinstance(each, Scalar):
            continue
        seen.add(id(each))
        if isinstance(each, Record):
            pending += [entry.node for entry in each.entries.values()]
            found |= set() if each.unknown is None else {each.unknown.lane}
            continue
        found.add(each.lane)
        if isinstance(each, Items):
            pending.append(each.element)
        elif isinstance(each, Pairs | Child):
            pending.append(each.record)
    return frozenset(found)


def saved(message: Message, within: frozenset[int]) -> Saved:
    """What changing a field of a message may overwrite, given the lanes that the field reaches; inside ``with message.lanes_:``."""
    lanes = message.lanes_
    used = tuple(lanes.used(lane) for lane in range(len(lanes.plan.strides)))
    whole = [(lane, 0, used[lane]) for lane in within]
    rows = [(lane, row, row + 1) for lane, row in known_rows(message)]
    return Saved(used, (lanes.words[VALID], lanes.words[WASTED]), tuple(_content(lanes, *each) for each in (*whole, *rows)))


def _content(lanes: Lanes, lane: int, first: int, last: int) -> tuple[int, int, bytes]:
    stride = lanes.plan.strides[lane]
    return lane, first * stride, bytes(lanes.memory[lane][first * stride : last * stride])


def restore(lanes: Lanes, before: Saved) -> None:
    """Put it back."""
    for lane, used in enumerate(before.used):
        lanes.give_back(lane, used)
    for lane, start, content in before.contents:
        lanes.memory[lane][start : start + len(content)] = content
    lanes.words[VALID], lanes.words[WASTED] = before.words
