"""Random relations that together say what the fields of their sums are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tests.random_mappings.message_types import Kind, Scalar
from tests.random_mappings.relations import Part

if TYPE_CHECKING:
    import random

    from tests.random_mappings.blocks import Relations
    from tests.random_mappings.relations import Values

MOST = 1000


def sums(relations: Relations, name: str) -> Part:
    """Two or three numbers, and as many sums of multiples of them."""
    rng = relations.rng
    size = rng.choice([2, 2, 3])
    fields, places = ([f"{name}{letter}" for letter in letters[:size]] for letters in ("abc", "xyz"))
    factors = invertible(rng, size)
    added = [rng.choice([0, 0, 3, -5]) for _ in range(size)]
    is_float = rng.random() < 0.5
    kinds: dict[str, Kind] = dict.fromkeys(fields, Scalar("float64" if is_float else "int32"))
    made: dict[str, Kind] = dict.fromkeys(places, Scalar("float64" if is_float else "int64"))

    def unpack(values: Values) -> Values:
        return {place: total(row, [values[each] for each in fields], more) for place, row, more in zip(places, factors, added, strict=True)}

    def wires(rng: random.Random) -> Values:
        return {each: number(rng, is_float=is_float) for each in fields}

    def holders(rng: random.Random) -> Values:
        found = unpack(wires(rng))
        return found if rng.random() < 0.7 else {place: number(rng, is_float=is_float) for place in places}

    lines = [
        f".{place} <-> {shown(row, fields, more, is_float=is_float)}\n" for place, row, more in zip(places, factors, added, strict=True)
    ]
    return Part(kinds, made, "".join(lines), unpack, wires, holders, is_sure=True, is_bounded=True)


def total(factors: list[int], numbers: list[int | np.float64], added: int) -> int | np.float64:
    """A sum as `shown` writes it: a zero has the sign that it has in this order."""
    first, *rest = zip(factors, numbers, strict=True)
    found = first[1] * abs(first[0]) if first[0] > 0 else -(first[1] * abs(first[0]))
    for factor, each in rest:
        found = found + each * factor if factor > 0 else found - each * abs(factor)
    return found + added if added else found


def invertible(rng: random.Random, size: int) -> list[list[int]]:
    """Factors none of which is 0, so that no relation has one field alone."""
    while True:
        factors = [[rng.choice([1, 1, -1, 2, -3]) for _ in range(size)] for _ in range(size)]
        if round(float(np.linalg.det(np.array(factors)))):
            return factors


def number(rng: random.Random, *, is_float: bool) -> int | np.float64:
    found = rng.randrange(-MOST, MOST)
    return np.float64(found) if is_float else found


def shown(factors: list[int], fields: list[str], added: int, *, is_float: bool) -> str:
    """A sum as text."""
    dot = ".0" if is_float else ""
    text = ""
    for factor, field in zip(factors, fields, strict=True):
        size = f".{field}" if abs(factor) == 1 else f".{field} * {abs(factor)}{dot}"
        text = f"{text} {'+' if factor > 0 else '-'} {size}" if text else size if factor > 0 else f"-({size})"
    return text if not added else f"{text} {'+' if added > 0 else '-'} {abs(added)}{dot}"
