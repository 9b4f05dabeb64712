"""Writing into lanes: spans that grow, presence, and the emptiness of what is absent.

A span is extended in place where it ends its lane, and moves to the end otherwise. Rows of a recursive lane that have moved may lie behind
their children, which encoders do not accept: such lanes are unsettled, and `rosetta_jit.runtime.holder.values.settle` orders them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

import numpy as np

from rosetta_jit.runtime.holder.record import Bit, Blob, Case, Child, Items, Numbers, Pairs, Record, Scalar, Text, extent

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder.record import Cell, Entry, Node, Presence
    from rosetta_jit.runtime.lanes import Lanes


def span_of(lanes: Lanes, span: Cell, row: int) -> tuple[int, int]:
    """Start and count; the count of a borrowed span is negative (``~count``)."""
    words = lanes.cells[span.key]
    at = row * span.step + span.index
    return words[at], words[at + 1]


def content(lanes: Lanes, span: Cell, lane: int, row: int) -> memoryview:
    """The bytes of a string or blob, wherever they are."""
    start, count = span_of(lanes, span, row)
    if count < 0:
        return lanes.borrowed(start, ~count)
    return lanes.cells[lane << 4 | 2][start : start + count]


def resize(lanes: Lanes, span: Cell, lane: int, row: int, count: int) -> int:
    """Give a span so many elements, of which it keeps those that it had; the others are zero. Its start."""
    start, old = span_of(lanes, span, row)
    old = max(old, 0)
    at_end = start + old == lanes.used(lane)
    if count <= old:
        if at_end:
            lanes.give_back(lane, start + count)
        elif count < old:
            _abandon(lanes, lane, old - count)
    elif old and at_end:
        lanes.take(lane, count - old)
    else:
        start = _moved(lanes, lane, start, old, count)
    words = lanes.cells[span.key]  # looked up again: of a recursive lane, this may be the one that has grown
    at = row * span.step + span.index
    words[at], words[at + 1] = start, count
    return start


def _moved(lanes: Lanes, lane: int, start: int, old: int, count: int) -> int:
    """The start of as many rows at the lane's end, into which the old ones are copied."""
    target = lanes.take(lane, count)
    if old:
        stride, buffer = lanes.plan.strides[lane], lanes.buffers[lane]
        buffer[target * stride : (target + old) * stride] = buffer[start * stride : (start + old) * stride]
        _abandon(lanes, lane, old)
    return target


def _abandon(lanes: Lanes, lane: int, rows: int) -> None:
    lanes.moves += 1
    lanes.waste(lane, rows)


def replace(lanes: Lanes, span: Cell, lane: int, row: int, data: memoryview | bytes) -> None:
    """Make bytes the content of a string or blob."""
    source = np.frombuffer(data, np.uint8)
    start = resize(lanes, span, lane, row, source.size)
    lanes.buffers[lane][start : start + source.size] = source


def rearrange(lanes: Lanes, span: Cell, lane: int, row: int, order: list[int]) -> None:
    """Keep the elements of a span that the order names, in that order. Nothing but rows moves: what they refer to stays."""
    start, count = span_of(lanes, span, row)
    stride = lanes.plan.strides[lane]
    rows = lanes.buffers[lane][start * stride : (start + count) * stride].reshape(count, stride)
    rows[: len(order)] = rows[order]
    lanes.moves += 1
    resize(lanes, span, lane, row, len(order))


def present(lanes: Lanes, presence: Presence | None, row: int) -> bool:
    """Whether a field is there."""
    match presence:
        case None:
            return True
        case Bit(cell, mask):
            return bool(lanes.cells[cell.key][row * cell.step + cell.index] & mask)
        case Case(cell, number, _, _):
            return lanes.cells[cell.key][row * cell.step + cell.index] == number
        case _:
            assert_never(presence)


def mark(lanes: Lanes, presence: Presence | None, row: int) -> None:
    """Make a field present; where it is a case of a union, the others are not any more."""
    match presence:
        case None:
            pass
        case Bit(cell, mask):
            lanes.cells[cell.key][row * cell.step + cell.index] |= mask
        case Case(cell, number, start, end):
            words, at = lanes.cells[cell.key], row * cell.step + cell.index
            if words[at] != number:
                _zero(lanes, cell.lane, row, start, end)
                words[at] = number
        case _:
            assert_never(presence)


def clear(lanes: Lanes, entry: Entry, row: int) -> None:
    """Make a field absent, or empty where it cannot be absent."""
    match entry.presence:
        case Bit(cell, mask):
            lanes.cells[cell.key][row * cell.step + cell.index] &= ~mask
        case Case(cell, number, _, _):
            words, at = lanes.cells[cell.key], row * cell.step + cell.index
            if words[at] != number:
                return
            words[at] = 0
        case None:
            pass
        case _:
            assert_never(entry.presence)
    _release(lanes, entry.node, row)
    _zero(lanes, *_at(entry.node, row))
    lanes.moves += 1


def clear_record(lanes: Lanes, record: Record, row: int) -> None:
    """Make every field of a record absent or empty."""
    for entry in record.entries.values():
        clear(lanes, entry, row)


def _release(lanes: Lanes, node: Node, row: int) -> None:
    """Give back what a node's spans hold, as far as it is known without looking at their elements."""
    match node:
        case Scalar():
            pass
        case Text(span, lane) | Blob(span, lane) | Numbers(span, lane) | Items(span, lane) | Pairs(span, lane) | Child(span, lane):
            if span_of(lanes, span, row)[1] > 0:
                resize(lanes, span, lane, row, 0)
        case Record():
            for entry in node.entries.values():
                _release(lanes, entry.node, row)
        case _:
            assert_never(node)


def _at(node: Node, row: int) -> tuple[int, int, int, int]:
    lane, start, end = extent(node)
    return lane, row, start, end


def _zero(lanes: Lanes, lane: int, row: int, start: int, end: int) -> None:
    at = row * lanes.plan.strides[lane]
    lanes.buffers[lane][at + start : at + end] = 0
