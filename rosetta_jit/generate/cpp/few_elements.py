"""A decoder's statements for messages that have nothing but lists of structs of numbers, where each of these has few elements.

A list of few elements takes less time than a call does. One of many is read in the source file, where it may be copied at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rosetta_jit.generate.c.lanes import Given, Lanes
from rosetta_jit.generate.cpp.empty_lists import NOT_EMPTY
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.nodes import Block, Stmt
from rosetta_jit.kernel.terms import index
from rosetta_jit.startup.dataclass import replace

FEW = index(16)
"""Elements that are read as soon as a function is called."""
TOO_MANY = NOT_EMPTY
"""What stands for a list of more: nothing is wrong with it, but other statements read it."""


def of_few_elements(body: Block, lanes: Lanes) -> Block:
    """The statements of a body behind checks that its lists have few elements; the body itself if elements have anything but numbers."""
    lists = _lists(lanes)
    return tuple(_checked(body, lists)) if lists and frozenset(lists) == lanes.opened else body


def lanes_of_few_elements(lanes: Lanes) -> Lanes:
    """How such statements reach the object: rows are elements of its lists."""
    given = {lane: Given("", first) for lane, first in _lists(lanes).items()}
    return replace(lanes, given={**lanes.given, **given}, packed={})


def _lists(lanes: Lanes) -> Mapping[int, str]:
    """The lists of the message whose elements have numbers alone, and the pointer to these."""
    found = {each.lane: each.first for (lane, _), each in lanes.straight.items() if lane == 0 and each.first}
    others = {lane for (lane, _), each in lanes.straight.items() if each.is_span or each.copied}
    return {lane: first for lane, first in found.items() if lane not in others}


def _checked(body: Block, lists: Mapping[int, str]) -> Iterator[Stmt]:
    """A list's elements are counted by a loop; its rows in use need not be."""
    counts = {stmt.count.name for stmt in body if isinstance(stmt, nodes.For) and isinstance(stmt.count, nodes.Local)}
    for stmt in body:
        match stmt:
            case nodes.Advance(lane) if lane in lists:
                pass
            case nodes.Let(name) if name in counts:
                yield stmt
                yield nodes.Expect(nodes.Compare("le", nodes.Local("i64", name), FEW), TOO_MANY)
            case _:
                yield stmt
