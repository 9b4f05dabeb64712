"""Random relations of numbers whose digits are fields, of moments in seconds and nanoseconds, and of integers that divide."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tests.random_mappings.meaning import Refused, exact_quotient, fits
from tests.random_mappings.message_types import Kind, Scalar
from tests.random_mappings.nested import shown, told
from tests.random_mappings.relations import Part

if TYPE_CHECKING:
    import random
    from collections.abc import Callable

    from tests.random_mappings.blocks import Relations
    from tests.random_mappings.relations import Values

SECOND = 10**9
FACTORS = (2, 3, 10, 60, 256, 1000, 10**6)
LONG = Scalar("int64")
MOST = 2**63 - 2**42
"""A number that is so far from what an int64 holds that its digits, put together, are in between, too."""


def some_number(rng: random.Random) -> int:
    return rng.choice([0, 1, -1, 59, 60, -60, MOST, -MOST, rng.randrange(-MOST, MOST), rng.randrange(-(10**6), 10**6)])


def digits(relations: Relations, name: str) -> Part:
    """One number of two or three fields; the lower ones in the range of their digits."""
    rng = relations.rng
    factors = [rng.choice(FACTORS) for _ in range(rng.choice([1, 1, 2]))]
    fields = [f"{name}{letter}" for letter in "abc"[: len(factors) + 1]]
    text = f".{fields[0]}"
    for factor, below in zip(factors, fields[1:], strict=True):
        text = text if " " not in text else f"({text})"
        product = rng.choice([f"{text} * {factor}", f"{factor} * {text}"])
        text = rng.choice([f"{product} + .{below}", f".{below} + {product}"])
    added = rng.choice([0, 0, 7, -3])
    if added:
        text = f"{text} + {added}" if added > 0 else f"{text} - {-added}"
    narrow = rng.random() < 0.3

    def unpack(values: Values) -> Values:
        total = values[fields[0]]
        for factor, below in zip(factors, fields[1:], strict=True):
            if not 0 <= values[below] < factor:
                raise Refused("rejected/range")
            total = fits_or(total * factor + values[below])
        return {name: fits(fits(total + added), "int32" if narrow else "int64")}

    def wires(rng: random.Random) -> Values:
        lower = {
            below: rng.choice([0, factor - 1, rng.randrange(factor), rng.choice([factor, -1]) if rng.random() < 0.2 else 0])
            for factor, below in zip(factors, fields[1:], strict=True)
        }
        return {fields[0]: rng.choice([0, -1, rng.randrange(-1000, 1000), some_number(rng)]), **lower}

    return Part(
        dict.fromkeys(fields, LONG),
        {name: Scalar("int32" if narrow else "int64")},
        f".{name} <-> {f'int32({text})' if narrow else text}\n",
        unpack,
        wires,
        lambda rng: {name: rng.randrange(-(2**31), 2**31) if narrow else some_number(rng)},
        is_bounded=True,
    )


def fits_or(value: int) -> int:
    """What is beyond 64 bits may be found before or behind a digit that is refused."""
    try:
        return fits(value)
    except Refused:
        raise Refused("rejected/range") from None


def taken_apart(relations: Relations, name: str) -> Part:
    """The quotient and the rest of one number as two fields."""
    factor, unit = relations.rng.choice(FACTORS), relations.rng.choice([1, 1, 1000, 7])
    a, b = f"{name}a", f"{name}b"
    rest = f"modulo(.{name}, {factor})"
    lines = [f".{a} <-> floor_divide(.{name}, {factor})\n", f".{b} <-> {rest if unit == 1 else f'{rest} * {unit}'}\n"]
    relations.rng.shuffle(lines)

    def unpack(values: Values) -> Values:
        quotient, left = divmod(values[name], factor)
        return {a: quotient, b: left * unit}

    def holders(rng: random.Random) -> Values:
        left = rng.choice([0, factor - 1, factor, -1, rng.randrange(factor)]) * unit + rng.choice([0, 0, 0, 1])
        return {a: rng.choice([0, -1, rng.randrange(-1000, 1000), some_number(rng)]), b: left}

    return Part({name: LONG}, {a: LONG, b: LONG}, "".join(lines), unpack, lambda rng: {name: some_number(rng)}, holders, is_bounded=True)


def divided(relations: Relations, name: str) -> Part:
    """A quotient: rounded down, or without a rest."""
    factor = relations.rng.choice([2, 7, 1000, -3])
    shown_factor = str(factor) if factor > 0 else f"({factor})"
    exact = relations.rng.random() < 0.5
    text = f".{name} <-> {'divide' if exact else 'floor_divide'}(.{name}, {shown_factor})\n"

    def unpack(values: Values) -> Values:
        return {name: exact_quotient(values[name], factor) if exact else fits(values[name] // factor)}

    def wires(rng: random.Random) -> Values:
        number = rng.choice([some_number(rng), factor * rng.randrange(-1000, 1000)])
        return {name: number}

    kinds: dict[str, Kind] = {name: LONG}
    return Part(kinds, kinds, text, unpack, wires)


def moment(relations: Relations, name: str) -> Part:
    """Seconds and nanoseconds, as one number or as a text."""
    a, b = f"{name}a", f"{name}b"
    is_split = relations.rng.random() < 0.4
    pair: dict[str, Kind] = {a: LONG, b: LONG}

    def apart(rng: random.Random) -> Values:
        return {
            a: rng.choice([0, -1, rng.randrange(-(10**10), 10**10), some_number(rng)]),
            b: rng.choice([0, 500_000_000, SECOND - 1, SECOND, -1, rng.randrange(SECOND)]),
        }

    match relations.rng.randrange(3):
        case 0 if is_split:
            text = f".{a} <-> floor_divide(.{name}, {SECOND})\n.{b} <-> modulo(.{name}, {SECOND})\n"
            return Part(
                {name: LONG},
                pair,
                text,
                lambda values: dict(zip((a, b), divmod(values[name], SECOND), strict=True)),
                lambda rng: {name: some_number(rng)},
                apart,
                is_bounded=True,
            )
        case 0:
            return Part(
                pair, {name: LONG}, f".{name} <-> nanoseconds(.{a}, .{b})\n", lambda values: {name: joined(values[a], values[b])}, apart
            )
        case 1 if is_split:
            text = f".{a} <-> seconds(.{name})\n.{b} <-> fraction(.{name})\n"
            texts: dict[str, Kind] = {name: Scalar("string")}
            return Part(
                texts,
                pair,
                text,
                lambda values: dict(zip((a, b), told(values[name]), strict=True)),
                lambda rng: {name: shown(rng.randrange(-62167219200, 253402300800), rng.choice([0, 1, rng.randrange(SECOND)]))},
                apart,
                is_sure=True,
            )
        case 1:
            texts = {name: Scalar("string")}
            return Part(
                pair,
                texts,
                f".{name} <-> iso8601(.{a}, .{b})\n",
                lambda values: {name: shown(values[a], values[b])},
                apart,
                lambda rng: {name: shown(rng.randrange(-62167219200, 253402300800), rng.choice([0, 1, rng.randrange(SECOND)]))},
            )
        case _:
            return stamp(name, pair, apart)


def stamp(name: str, pair: dict[str, Kind], apart: Callable[[random.Random], Values]) -> Part:
    """Seconds as a float."""
    a, b = pair

    def unpack(values: Values) -> Values:
        if not 0 <= values[b] < SECOND:
            raise Refused("range")
        return {name: nearest(values[a], values[b])}

    return Part(pair, {name: Scalar("float64")}, f".{name} <-> timestamp(.{a}, .{b})\n", unpack, apart)


def nearest(second: int, behind: int) -> np.float64:
    return np.float64(second) + np.float64(behind) / np.float64(1e9)


def joined(second: int, behind: int) -> int:
    if not 0 <= behind < SECOND:
        raise Refused("range")
    return fits(second * SECOND + behind)
