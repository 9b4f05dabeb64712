"""How many rows of a lane one message can need: by its type, and by what a decoder reserves."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Const, For, Reserve, While
from rosetta_jit.kernel.walk import blocks_of
from rosetta_jit.model.layout import Layout, Row, Slot, Span, Variant, map_entry
from rosetta_jit.model.types import Array, Bytes, Map, Optional, Schema, String, Struct, Type, Union

Bounds = tuple[int | None, ...]
MOST = 1 << 31
"""Larger bounds help nobody."""


def bounds_of_type(type_: Type, schema: Schema, layout: Layout) -> Bounds:
    """What the type allows: 1 for the message, None where it sets no bound."""
    found: dict[int, int] = {0: 1, **dict(_bounded(type_, schema, layout, layout.root, 1))}
    recursive = {lane for lane, _ in layout.recursive}
    return tuple(None if each in recursive else found.get(each) for each in range(len(layout.lanes)))


def _bounded(type_: Type, schema: Schema, layout: Layout, slot: Slot, around: int) -> Iterator[tuple[int, int]]:
    """The lanes below a slot, of which there are ``around``, that have a bound."""
    resolved = schema.resolve(type_)
    if isinstance(resolved, Optional):
        resolved = schema.resolve(resolved.value)
    match resolved, slot:
        case Struct(_, fields), Row(members=members):
            for each in fields:
                yield from _bounded(each.type, schema, layout, members.named[each.name].slot, around)
        case Union(_, cases), Variant(members=members):
            for each in cases:
                yield from _bounded(each.type, schema, layout, members.named[each.name].slot, around)
        case ((String() | Bytes() | Array() | Map()), Span(_, lane)):
            each = _most(resolved)
            if each is not None and around * each <= MOST:
                yield lane, around * each
                yield from _bounded(_element(resolved), schema, layout, layout.lanes[lane].element, around * each)
        case _:
            return


def _most(type_: String | Bytes | Array | Map) -> int | None:
    match type_:
        case Array(length=int(length)) | Bytes(length=int(length)):
            return length
        case _:
            return type_.maximum


def _element(type_: String | Bytes | Array | Map) -> Type:
    match type_:
        case Array(element):
            return element
        case Map(key, value):
            return map_entry(key, value)
        case _:
            return type_


def reserved(kernel: Kernel) -> Bounds:
    """What a decoder takes of each lane at most, where its counts are constants."""
    totals = [_totals(body, len(kernel.strides)) for body in kernel.bodies]
    return tuple(_largest([total[lane] for total in totals]) for lane in range(len(kernel.strides)))


def _totals(block: Block, lanes: int) -> list[int | None]:
    total: list[int | None] = [0] * lanes
    for stmt in block:
        match stmt:
            case Reserve(lane, Const(_, count)):
                total[lane] = _sum(total[lane], int(count))
            case Reserve(lane, _):
                total[lane] = None
            case For() | While():
                inside = _totals(stmt.body, lanes)
                total = [each if within == 0 else None for each, within in zip(total, inside, strict=True)]
            case _:
                chosen = [_totals(inner, lanes) for inner in blocks_of(stmt)]
                if chosen:
                    total = [_sum(each, _largest([way[lane] for way in chosen])) for lane, each in enumerate(total)]
    return total


def _sum(one: int | None, other: int | None) -> int | None:
    return None if one is None or other is None else one + other


def _largest(counts: list[int | None]) -> int | None:
    return None if None in counts else max((each for each in counts if each is not None), default=0)


def least(*bounds: Bounds) -> Bounds:
    """The lesser of several bounds on each lane."""
    return tuple(min((each for each in some if each is not None), default=None) for some in zip(*bounds, strict=True))
