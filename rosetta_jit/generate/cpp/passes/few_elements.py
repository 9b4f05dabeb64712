"""A decoder's statements for messages whose lists have few elements, which are structs of numbers and of arrays of a fixed count of these.

A list of few elements takes less time than a call does. One of many is read in the source file, where it may be copied at once.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from rosetta_jit.generate.c.holder.lanes import Given, Lanes, Straight
from rosetta_jit.generate.cpp.passes.empty_lists import NOT_EMPTY
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.nodes import Block, Stmt
from rosetta_jit.kernel.terms import END, index
from rosetta_jit.startup.dataclass import replace

FEW, FEW_BYTES = 16, 256
"""Elements of a list that are read as soon as a function is called, and the bytes that these have: more are soon copied."""
TOO_MANY = NOT_EMPTY
"""What stands for a list of more: nothing is wrong with it, but other statements read it."""
OPENED = Given("", "")
"""Elements that are reached once a list is opened."""


def most_elements(size: int) -> int:
    """How many elements are few, if each has so many bytes."""
    return min(FEW, max(1, FEW_BYTES // size))


def of_few_elements(body: Block, lanes: Lanes) -> Block:
    """The statements of a body behind checks that its lists have few elements; the body itself if it opens others within these."""
    lists, within = _lists(lanes)
    return tuple(_checked(body)) if lists and lists | within == lanes.opened else body


def lanes_of_opened(lanes: Lanes) -> Lanes:
    """How statements in the header reach the object: rows are elements of its lists, which are declared where a list is opened."""
    opened = lanes.opened
    fields = Counter(lane for lane, _ in lanes.straight)
    alone = frozenset(lane for lane in opened if fields[lane] == 1)
    straight = {at: replace(each, statement=_statement(each, opened, is_alone=at[0] in alone)) for at, each in lanes.straight.items()}
    return replace(lanes, straight=straight, given={**lanes.given, **dict.fromkeys(opened, OPENED)}, packed={})


def _statement(field: Straight, opened: frozenset[int], *, is_alone: bool) -> str:
    """What opens a list, or sets a field of its elements: of a number alone a compiler would make a call of the C library's function."""
    if field.lane in opened:
        return f"auto const {field.statement}"
    return field.statement.replace("$value", "rosetta_jit::detail::one_of_few($value)") if is_alone else field.statement


def _lists(lanes: Lanes) -> tuple[frozenset[int], frozenset[int]]:
    """The lists of the message, and the arrays of their elements."""
    lists = frozenset(each.lane for (lane, _), each in lanes.straight.items() if lane == 0 and each.lane)
    return lists, frozenset(each.lane for (lane, _), each in lanes.straight.items() if lane in lists and each.lane)


def _checked(body: Block) -> Iterator[Stmt]:
    """A list is found to be short by its count, or by the bytes of the message where lists of numbers are all that may be long there."""
    sizes = {stmt.count.name: 1 for stmt in body if isinstance(stmt, nodes.For) and isinstance(stmt.count, nodes.Local)}
    others, sure = list[Stmt](), 0
    for stmt in body:
        match stmt:
            case nodes.Require(_, nodes.Const(_, size)):
                sure += int(size)
            case nodes.Require(_, nodes.Binary("mul", nodes.Local(_, name), nodes.Const(_, size))) if name in sizes:
                sizes[name] = int(size)
            case nodes.Require():
                others.append(stmt)
            case _:
                pass
    most = {name: most_elements(size) for name, size in sizes.items()}
    for stmt in body:
        yield stmt
        match stmt:
            case nodes.Let(name) if name in most and others:
                yield nodes.Expect(nodes.Compare("le", nodes.Local("i64", name), index(most[name])), TOO_MANY)
            case nodes.Require(nodes.Const(_, 0)) if not others:
                yield nodes.Expect(nodes.Compare("le", END, index(sure + sum(most[name] * size for name, size in sizes.items()))), TOO_MANY)
            case _:
                pass
