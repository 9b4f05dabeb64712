"""Random relations of bytes that are numbers, and of the triangles that stand for symmetric matrices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tests.random_mappings.meaning import INTEGERS, Refused
from tests.random_mappings.message_types import OCTETS, Array, Kind, Scalar, some
from tests.random_mappings.relations import Part

if TYPE_CHECKING:
    import random

    from tests.random_mappings.blocks import Relations
    from tests.random_mappings.relations import Values

VIEWED = {"int16": "int32", "int32": "int32", "float32": "float32", "float64": "float64"}
"""What bytes are seen as, and what elements of the array beside are."""


def viewed(relations: Relations, name: str) -> Part:
    """Bytes on one side, and on the other the numbers that they have."""
    rng = relations.rng
    type_ = rng.choice([each for each in VIEWED if VIEWED[each] in relations.wire.scalars and VIEWED[each] in relations.holder.scalars])
    is_big = rng.random() < 0.4
    shown = f", {type_}, true" if is_big else f", {type_}"
    kind = np.dtype(type_).newbyteorder(">" if is_big else "<")
    data: dict[str, Kind] = {name: OCTETS}
    numbers: dict[str, Kind] = {name: Array(Scalar(VIEWED[type_]))}

    def seen(values: Values) -> Values:
        if len(values[name]) % kind.itemsize:
            raise Refused("range/rejected")
        found = np.frombuffer(values[name], kind).astype(kind.newbyteorder("="))
        return {name: [each if kind.kind == "f" else int(each) for each in found]}

    def put(values: Values) -> Values:
        if kind.kind == "i" and not all(INTEGERS[type_][0] <= each <= INTEGERS[type_][1] for each in values[name]):
            raise Refused("range")
        return {name: np.array(values[name], kind).tobytes()}

    def bytes_of(rng: random.Random) -> Values:
        count = rng.choice([0, 1, 3, 8]) * kind.itemsize
        return {name: bytes(rng.randrange(120) for _ in range(count + rng.choice([0, 0, 0, 1])))}

    def numbers_of(rng: random.Random) -> Values:
        some_numbers = [some(rng, Scalar(type_)) for _ in range(rng.choice([0, 1, 3, 8]))]
        return {name: [0 if np.isnan(each) else each for each in some_numbers]}

    if rng.random() < 0.5:
        return Part(data, numbers, f".{name} <-> numbers(.{name}{shown})\n", seen, bytes_of, numbers_of, is_sure=True)
    return Part(numbers, data, f".{name} <-> number_bytes(.{name}{shown})\n", put, numbers_of, bytes_of, is_bounded=True)


def triangle(relations: Relations, name: str) -> Part:
    """The upper triangle of a square on one side, on the other all of a symmetric one."""
    rng = relations.rng
    size = rng.choice([1, 2, 3, 6])
    kinds: dict[str, Kind] = {name: Array(Scalar("float64"))}
    places = [(row, column) for row in range(size) for column in range(row, size)]

    def upper(square: list[Any]) -> list[Any]:
        if len(square) != size * size:
            raise Refused("range/rejected/index")
        return [square[row * size + column] for row, column in places]

    def whole(triangle: list[Any]) -> list[Any]:
        if len(triangle) != len(places):
            raise Refused("range/rejected/index")
        found = dict(zip(places, triangle, strict=True))
        return [found[min(row, column), max(row, column)] for row in range(size) for column in range(size)]

    def some_triangle(rng: random.Random) -> list[Any]:
        return [some(rng, Scalar("float64")) for _ in range(len(places) + rng.choice([0, 0, 0, 0, 1]))]

    def triangles(rng: random.Random) -> Values:
        return {name: some_triangle(rng)}

    def squares(rng: random.Random) -> Values:
        made = some_triangle(rng)
        return {name: whole(made[: len(places)]) + made[len(places) :]}

    if rng.random() < 0.5:
        text = f".{name} <-> upper_triangle(.{name}, {size})\n"
        return Part(kinds, kinds, text, lambda values: {name: upper(values[name])}, squares, triangles)
    text = f".{name} <-> symmetric(.{name}, {size})\n"
    return Part(kinds, kinds, text, lambda values: {name: whole(values[name])}, triangles, squares)
