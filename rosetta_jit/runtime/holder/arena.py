"""Writing into lanes: spans that grow, presence, and the emptiness of what is absent.

A span is extended in place where it ends its lane, and moves to the end otherwise. It gives rows at the end back where it is the only
one of its lane: others, though empty, may begin behind these rows, and none may begin behind the used rows. Rows of a recursive lane
that have moved may lie behind their children, which encoders do not accept: such lanes are unsettled, and
`rosetta_jit.runtime.holder.values.settle` orders them.
"""

from __future__ import annotations

from typing import assert_never

import numpy as np

from rosetta_jit.model.initial_values import FixedArray
from rosetta_jit.runtime.holder.record import (
    Bit,
    Blob,
    Case,
    Cell,
    Child,
    Choice,
    Entry,
    Items,
    Node,
    Numbers,
    Pairs,
    Presence,
    Record,
    Scalar,
    Spanned,
    Text,
    extent,
)
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
    stride = lanes.plan.strides[lane]
    return lanes.cells[lane << 4 | 2][start * stride : (start + count) * stride]


def resize(lanes: Lanes, node: Spanned, row: int, count: int) -> int:
    """Give a span so many elements, of which it keeps those that it had; the others have their initial values. Its start."""
    span, lane = node.span, node.lane
    start, old = span_of(lanes, span, row)
    old = max(old, 0)
    at_end = start + old == lanes.used(lane)
    if count <= old:
        _waste_in(lanes, node, start + count, old - count, whole=count == 0)
        if at_end and _is_alone(lanes, node):
            lanes.give_back(lane, start + count)
        elif count < old:
            lanes.waste(lane, old - count)
    elif old and at_end:
        lanes.take(lane, count - old)
    else:
        start = _moved(lanes, lane, start, old, count)
    words = lanes.cells[span.key]  # looked up again: of a recursive lane, this may be the one that has grown
    at = row * span.step + span.index
    words[at], words[at + 1] = start, count
    if node.initial and count > old:
        lanes.initialise(node.initial, start + old, count - old)
    return start


def _waste_in(lanes: Lanes, node: Node, start: int, rows: int, *, whole: bool = False) -> None:
    """Note that what elements hold in other lanes is not referred to any more, when so many of them end: ``whole``, if those are all."""
    if not rows:
        return
    match node:
        case Items(element=Text() as text) if whole and rows == lanes.used(text.span.lane):
            lanes.give_back(text.lane, 0)  # none but these rows refer to it
        case Items(element=element):
            _waste_of(lanes, element, start, rows)
        case Pairs(record=record) | Child(record=record):
            _waste_of(lanes, record, start, rows)
        case _:
            pass


def _is_alone(lanes: Lanes, node: Spanned) -> bool:
    """Whether no other span refers to a span's lane: only lanes of messages that contain each other have spans of several fields."""
    return lanes.used(node.span.lane) == 1 and lanes.plan.layout.lanes[node.lane].links is None


def _waste_of(lanes: Lanes, node: Node, row: int, rows: int) -> None:
    """Note the same of the elements that a node of each of these rows refers to."""
    match node:
        case Scalar():
            pass
        case Record():
            for entry in node.entries.values():
                if not isinstance(entry.presence, Case) or (rows == 1 and present(lanes, entry.presence, row)):
                    _waste_of(lanes, entry.node, row, rows)
        case Text(span, lane) | Blob(span, lane) | Numbers(span, lane) | Items(span, lane) | Pairs(span, lane) | Child(span, lane):
            words = lanes.row_words(span.lane, row, rows)[:, span.index : span.index + 2]
            lanes.waste(lane, int(words[:, 1].clip(0).sum()))
            if not isinstance(node, Text | Blob | Numbers):
                for start, count in words[words[:, 1] > 0].tolist():
                    _waste_in(lanes, node, start, count)
        case _:
            assert_never(node)


def _moved(lanes: Lanes, lane: int, start: int, old: int, count: int) -> int:
    """The start of as many rows at the lane's end, into which the old ones are copied."""
    target = lanes.take(lane, count)
    if old:
        stride, buffer = lanes.plan.strides[lane], lanes.buffers[lane]
        buffer[target * stride : (target + old) * stride] = buffer[start * stride : (start + old) * stride]
        lanes.waste(lane, old)
    return target


def replace(lanes: Lanes, node: Text | Blob, row: int, data: memoryview | bytes) -> None:
    """Make bytes the content of a string or blob."""
    source, stride = np.frombuffer(data, np.uint8), lanes.plan.strides[node.lane]
    start = resize(lanes, node, row, source.size // stride) * stride
    lanes.buffers[node.lane][start : start + source.size] = source


def rearrange(lanes: Lanes, node: Spanned, row: int, order: list[int]) -> None:
    """Keep the elements of a span that the order names, in that order. Nothing but rows moves: what they refer to stays."""
    start, count = span_of(lanes, node.span, row)
    stride = lanes.plan.strides[node.lane]
    rows = lanes.buffers[node.lane][start * stride : (start + count) * stride].reshape(count, stride)
    rows[: len(order)] = rows[order]
    resize(lanes, node, row, len(order))


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
    """Make a field present; where it is a case of a union, the others are not any more, and the discriminator says so."""
    match presence:
        case None:
            pass
        case Bit(cell, mask, initial):
            words, at = lanes.cells[cell.key], row * cell.step + cell.index
            if not words[at] & mask:
                words[at] |= mask
                lanes.initialise(initial, row, 1)
        case Case(cell, number, choice=choice):
            if lanes.cells[cell.key][row * cell.step + cell.index] != number:
                _enter(lanes, presence, row)
                if choice is not None and choice.selected(_tag(lanes, choice, row)) != number:
                    lanes.cells[choice.tag.key][row * choice.tag.step + choice.tag.index] = presence.label
        case _:
            assert_never(presence)


def choose(lanes: Lanes, choice: Choice, row: int) -> None:
    """Make the case of a union present that its discriminator selects, with zero value if it was not."""
    number = choice.selected(_tag(lanes, choice, row))
    cell = choice.cases[0].cell
    at = row * cell.step + cell.index
    if lanes.cells[cell.key][at] == number:
        return
    if number:
        _enter(lanes, choice.cases[number - 1], row)
    else:
        _leave(lanes, choice.cases[0], row)


def _tag(lanes: Lanes, choice: Choice, row: int) -> int:
    return int(lanes.cells[choice.tag.key][row * choice.tag.step + choice.tag.index])


def _enter(lanes: Lanes, case: Case, row: int) -> None:
    _leave(lanes, case, row)
    lanes.cells[case.cell.key][row * case.cell.step + case.cell.index] = case.number
    lanes.initialise(case.initial, row, 1)


def _leave(lanes: Lanes, case: Case, row: int) -> None:
    """Make all cases of a union absent."""
    words, at = lanes.cells[case.cell.key], row * case.cell.step + case.cell.index
    left = int(words[at])
    words[at] = 0
    _zero(lanes, case.cell.lane, row, case.start, case.end)
    for each in case.siblings[left - 1].initial if left and case.siblings else ():
        if isinstance(each, FixedArray):
            lanes.waste(each.lane, each.length)


def clear(lanes: Lanes, entry: Entry, row: int) -> None:
    """Make a field absent. One that cannot be, as the case that a discriminator selects, gets its initial value."""
    presence, node = entry.presence, entry.node
    if presence is not None and not present(lanes, presence, row):
        return
    _release(lanes, node, row)
    _zero(lanes, *_at(node, row))
    match presence:
        case None:
            lanes.initialise(entry.initial, row, 1)
            if isinstance(node, Scalar) and node.choice is not None:
                choose(lanes, node.choice, row)
        case Bit(cell, mask):
            lanes.cells[cell.key][row * cell.step + cell.index] &= ~mask
        case Case(cell, choice=choice):
            lanes.cells[cell.key][row * cell.step + cell.index] = 0
            if choice is not None:
                choose(lanes, choice, row)
        case _:
            assert_never(presence)


def _release(lanes: Lanes, node: Node, row: int) -> None:
    """Give back what a node's spans hold, as far as it is known without looking at their elements."""
    match node:
        case Scalar():
            pass
        case Text(span) | Blob(span) | Numbers(span) | Items(span) | Pairs(span) | Child(span):
            if span_of(lanes, span, row)[1] > 0:
                resize(lanes, node, row, 0)
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
