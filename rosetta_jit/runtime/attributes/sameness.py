"""Programs that say whether two messages are the same, which compiled code runs side by side on the rows of both.

An instruction has six words; offsets are in bytes, those of lanes in the state.

    END
    CELLS   offset   count        kind                      numbers that lie together in the row
    BIT     offset   mask         bytes to skip if absent   whether a field is there
    CASE    offset                                          which case of a union is
    WHEN    offset   number       bytes to skip if it is another one
    LEAF    span     lane         kind   bytes of an element
    ROWS    span     lane         address of the elements' program   answer if lengths differ   answer if elements differ

Two rows are the same if their plain values are. Where that takes more than comparing in order (maps, messages in lanes of their own that
are empty or absent), the answer is `ASK`: Python looks.
"""

from __future__ import annotations

from typing import Any, assert_never

import numpy as np

from rosetta_jit.kernel.state import ADDRESS, lane_word
from rosetta_jit.model.layout import WIDTH, scalar_of
from rosetta_jit.runtime.cells import SCALARS
from rosetta_jit.runtime.holder.record import Bit, Blob, Case, Cell, Child, Entry, Items, Node, Numbers, Pairs, Record, Scalar, Text, extent

END, CELLS, BIT, CASE, WHEN, LEAF, ROWS = range(7)
KINDS = {"bool": 1, "f32": 2, "f64": 3}
BYTES = 0
"""The kind of all other numbers, of which only bytes count."""
DIFFERENT, ASK = 0, -1
WORDS = 6
INSTRUCTION_BYTES = 8 * WORDS

_Instruction = list[Any]
"""Its words; the program of elements is its node until all have addresses."""


class Sameness:
    """The programs of the records of one family."""

    def __init__(self) -> None:
        self._tables: dict[int, Any] = {}

    def program(self, node: Node) -> int:
        """The address of a node's program. It is good as long as this object."""
        if id(node) not in self._tables:
            self._write(node)
        return self._address(node)

    def _address(self, node: Node) -> int:
        return self._tables[id(node)][1].ctypes.data

    def _write(self, root: Node) -> None:
        """Write the program of a node and those of all elements that it leads to, which may lead back."""
        written: dict[int, list[_Instruction]] = {}
        pending = [root]
        while pending:
            node = pending.pop()
            if id(node) in self._tables:
                continue
            written[id(node)] = [*_instructions(node), [END, 0, 0, 0, 0, 0]]
            self._tables[id(node)] = node, np.zeros(WORDS * len(written[id(node)]), np.int64)
            pending += [each[3] for each in written[id(node)] if each[0] == ROWS]
        for key, instructions in written.items():
            for each in instructions:
                each[3] = self._address(each[3]) if each[0] == ROWS else each[3]
            self._tables[key][1][:] = [word for each in instructions for word in each]


def _instructions(node: Node) -> list[_Instruction]:
    match node:
        case Scalar(cell):
            scalar = SCALARS[cell.key & 15]
            count = 1 if scalar in KINDS else WIDTH[scalar]
            return [[CELLS, extent(node)[1], count, KINDS.get(scalar, BYTES), 0, 0]]
        case Text(span, lane, type_):
            return [_leaf(span, lane, BYTES, 2 if type_.encoding == "utf-16" else 1)]
        case Blob(span, lane):
            return [_leaf(span, lane, BYTES, 1)]
        case Numbers(span, lane, type_):
            scalar = scalar_of(type_)
            return [_leaf(span, lane, KINDS.get(scalar, BYTES), WIDTH[scalar])]
        case Items(span, lane, element):
            return [_rows(span, lane, element, ASK if node.shape else DIFFERENT, DIFFERENT)]
        case Pairs(span, lane, record):
            return [_rows(span, lane, record, ASK, ASK)]
        case Child(span, lane, record):
            return [_rows(span, lane, record, ASK, DIFFERENT)]
        case Record():
            return _of_record(node)
        case _:
            assert_never(node)


def _of_record(record: Record) -> list[_Instruction]:
    """Of a record each field, and what came that the schema does not know."""
    unknown = [] if record.unknown is None else [_leaf(record.unknown.span, record.unknown.lane, BYTES, 1)]
    unions = {each.presence.cell.index: each.presence for each in record.entries.values() if isinstance(each.presence, Case)}
    cases = [[CASE, 8 * index, 0, 0, 0, 0] for index in unions]
    return _joined([*unknown, *cases, *(each for entry in record.entries.values() for each in _of_entry(entry))])


def _of_entry(entry: Entry) -> list[_Instruction]:
    inner = _instructions(entry.node)
    skipped = INSTRUCTION_BYTES * len(inner)
    match entry.presence:
        case None:
            return inner
        case Bit(cell, mask):
            return [[BIT, 8 * cell.index, _signed(mask), skipped, 0, 0], *inner]
        case Case(cell, number):
            return [[WHEN, 8 * cell.index, number, skipped, 0, 0], *inner]
        case _:
            assert_never(entry.presence)


def _joined(instructions: list[_Instruction]) -> list[_Instruction]:
    """The same with numbers of one kind that lie together compared at once, unless they may be skipped."""
    found: list[_Instruction] = []
    behind = 0
    for index, each in enumerate(instructions):
        last = found[-1] if found else None
        if each[0] in (BIT, WHEN):
            behind = max(behind, index + each[3] // INSTRUCTION_BYTES)
        can = last is not None and index > behind and each[0] == last[0] == CELLS and each[3] == last[3]
        if can and last is not None and last[1] + last[2] * _width(last[3]) == each[1]:
            last[2] += each[2]
        else:
            found.append(each)
    return found


def _width(kind: int) -> int:
    return {2: 4, 3: 8}.get(kind, 1)


def _leaf(span: Cell, lane: int, kind: int, size: int) -> _Instruction:
    return [LEAF, 8 * span.index, 8 * lane_word(lane, ADDRESS), kind, size, 0]


def _rows(span: Cell, lane: int, element: Node, uneven: int, different: int) -> _Instruction:
    return [ROWS, 8 * span.index, 8 * lane_word(lane, ADDRESS), element, uneven, different]


def _signed(mask: int) -> int:
    return mask - (1 << 64) if mask >= 1 << 63 else mask
