"""Rows of a recursive struct that are written as they lie: as by a list made of them, or not at all where their order is another."""

from __future__ import annotations

import random
from dataclasses import dataclass, field

import numpy as np
import pytest

from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import IntoObjects, LowByteFirst, unit_of
from rosetta_jit.kernel import interpret
from rosetta_jit.kernel.state import USED, lane_word
from tests.backends.holders import rows

TEXT = 'syntax = "proto3"; package t; message M { int32 value = 1; repeated M kids = 2; int32 behind = 3; }'
LANE, ROOM = 2, 64


@dataclass
class Node:
    value: int
    behind: int
    kids: list[Node] = field(default_factory=list)
    row: int = -1


def tree(chance: random.Random, depth: int) -> Node:
    kids = [tree(chance, depth - 1) for _ in range(chance.randrange(4) if depth else 0)]
    return Node(chance.randrange(1, 1 << chance.choice((7, 20))), chance.randrange(1, 300), kids)


def below(node: Node) -> list[Node]:
    return [each for kid in node.kids for each in (kid, *below(kid))]


def walked(node: Node, used: int = 0) -> int:
    """Give rows as the walk over an object does; how many there are."""
    start, used = used, used + len(node.kids)
    for number, kid in enumerate(node.kids):
        kid.row = start + number
        used = walked(kid, used)
    return used


def written(root: Node, machine) -> bytes | str:
    """The message of a holder that has these rows, or what is wrong with it."""
    options = {"encoding": "protobuf", "schema": {"t.proto": TEXT}}
    unit = unit_of(type_request("decode", "t.M", options), ("encode",), "unit", machine=machine)
    assert [lane for lane, _ in unit.layout.recursive] == [LANE]
    size, encode = unit.kernels["size"], unit.kernels["encode"]
    holder, nodes = rows(size, ROOM), below(root)
    for node, lane in ((root, 0), *((each, LANE) for each in nodes)):
        value, kids, behind = unit.layout.lanes[lane].element.members
        row = holder.lanes[lane][max(node.row, 0) * size.strides[lane] :][: size.strides[lane]]
        row[value.slot.offset :][:4].view(np.int32)[0] = node.value
        row[behind.slot.offset :][:4].view(np.int32)[0] = node.behind
        start = min((each.row for each in node.kids), default=0)
        row[kids.slot.offset :][:16].view(np.int64)[:] = start, len(node.kids)
    holder.state[lane_word(LANE, USED)] = len(nodes)
    length = interpret.run(size, bytearray(), 0, 0, holder.state, holder.lanes, 0)
    if length < 0:
        return size.sites[-1 - length].detail
    room = bytearray(length)
    assert interpret.run(encode, room, 0, length, holder.state, holder.lanes, 0) == length
    return bytes(room)


def message(node: Node) -> bytes:
    def varint(value: int) -> bytes:
        return bytes([value]) if value < 128 else bytes([value & 127 | 128]) + varint(value >> 7)

    kids = b"".join(b"\x12" + varint(len(each)) + each for each in map(message, node.kids))
    return b"\x08" + varint(node.value) + kids + b"\x18" + varint(node.behind)


@pytest.mark.parametrize("seed", range(12))
def test_rows_that_lie_behind_those_they_belong_to(seed):
    root = tree(random.Random(seed), 3)
    assert walked(root) <= ROOM
    assert written(root, IntoObjects) == written(root, LowByteFirst) == message(root)


@pytest.mark.parametrize("seed", range(12))
def test_rows_in_another_order_are_refused(seed):
    root = Node(1, 1, [tree(random.Random(seed), 2), Node(2, 2, [Node(3, 3)])])
    count = walked(root)
    lists = [root, *(each for each in below(root) if each.kids)]
    first = count
    for node in reversed(lists):  # each list lies before that of the message which has it
        first -= len(node.kids)
    for node in reversed(lists):
        for number, kid in enumerate(node.kids):
            kid.row = first + number
        first += len(node.kids)
    assert written(root, LowByteFirst) == message(root)
    assert written(root, IntoObjects) == "the holder changed while it was written"
