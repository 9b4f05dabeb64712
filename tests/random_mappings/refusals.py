"""Random relations that refuse messages on conditions, and fields that `same names` maps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tests.random_mappings.meaning import COMPARED, INTEGERS, TEXTS, Refused, fits
from tests.random_mappings.message_types import Array, Kind, Scalar, some
from tests.random_mappings.relations import Part
from tests.random_mappings.values import quoted

if TYPE_CHECKING:
    import random
    from collections.abc import Callable

    from tests.random_mappings.blocks import Relations
    from tests.random_mappings.relations import Values

FLOATS = ("float32", "float64")
LONG = Scalar("int64")
TEXT = Scalar("string")


def near(rng: random.Random) -> int:
    return rng.choice([rng.randrange(-5, 6), rng.randrange(-200, 200), rng.randrange(-(2**40), 2**40)])


def rejected(relations: Relations, name: str) -> Part:
    """A condition on one field or two, above or below what maps them; it holds in both directions."""
    rng = relations.rng
    a, b = f"{name}a", f"{name}b"
    limit, operator = rng.choice([0, 3, -4]), rng.choice(list(COMPARED))
    first, second = COMPARED[operator], rng.choice(["and", "or", "only", "not"])
    text = rng.choice(["", "a", "é"])
    numbers, texts = f".{a} {operator} {limit}", f".{b} == {quoted(text)}"
    condition = {"and": f"{numbers} and {texts}", "or": f"{numbers} or {texts}", "only": numbers, "not": f"not ({numbers} or {texts})"}[
        second
    ]

    def holds(values: Values) -> bool:
        left, right = first(values[a], limit), values[b] == text
        return {"and": left and right, "or": left or right, "only": left, "not": not (left or right)}[second]

    change, run = relations.chain(f".{a}", rng.randrange(2))

    def unpack(values: Values) -> Values:
        if holds(values):
            raise Refused("rejected/range")
        return {a: run(values[a]), b: "<" + values[b]}

    def wires(rng: random.Random) -> Values:
        return {a: near(rng), b: rng.choice(TEXTS)}

    def holders(rng: random.Random) -> Values:
        values = wires(rng)
        try:
            return {a: run(values[a]), b: "<" + values[b]}
        except Refused:
            return values

    lines = [f".{a} <-> {change}\n", f'.{b} <-> "<" + .{b}\n', f'reject "{{.{a}}} and {{.{b}}}" when {condition}\n']
    rng.shuffle(lines)
    kinds: dict[str, Kind] = {a: LONG, b: TEXT}
    return Part(kinds, kinds, "".join(lines), unpack, wires, holders)


def of_elements(relations: Relations, name: str) -> Part:
    """A condition on each element of an array, or on its length."""
    limit = relations.rng.choice([0, 50, 2])
    conditions: list[tuple[str, Callable[[list[int]], bool]]] = [
        (f".{name}[] > {limit}", lambda a: any(x > limit for x in a)),
        (f".{name}[] == {limit}", lambda a: limit in a),
        (f"len(.{name}) > {limit}", lambda a: len(a) > limit),
        (f"len(.{name}) == {limit}", lambda a: len(a) == limit),
    ]
    condition, holds = relations.rng.choice(conditions)

    def unpack(values: Values) -> Values:
        if holds(values[name]):
            raise Refused("rejected")
        return {name: list(values[name])}

    def some_of(rng: random.Random) -> Values:
        return {name: [rng.randrange(-60, 60) for _ in range(rng.choice([0, 1, 2, 3, 8]))]}

    lines = [f'reject "no {{len(.{name})}}" when {condition}\n', f".{name} <-> .{name}\n"]
    relations.rng.shuffle(lines)
    kinds: dict[str, Kind] = {name: Array(Scalar("int32"))}
    return Part(kinds, kinds, "".join(lines), unpack, some_of, some_of)


def within_blocks(relations: Relations, name: str) -> Part:
    """A `when` of which some blocks refuse, by a condition of their own or always; two of a mapping, for their ways multiply."""
    relations.blocks += 1
    if relations.blocks > 2:
        return rejected(relations, name)
    rng = relations.rng
    a, b = f"{name}a", f"{name}b"
    low, high = sorted(rng.sample(range(-4, 8), 2))
    then, run = relations.chain(f".{b}", 1)
    inner = rng.choice([f'reject "low {{.{b}}}" when .{b} < 0\n', ""])
    middle = rng.choice(['reject "between"\n', f".{b} <-> -.{b}\n"])
    rules = f".{a} <-> .{a}\nwhen .{a} < {low}\n{inner}.{b} <-> {then}\nelse when .{a} < {high}\n{middle}else\n.{b} <-> .{b}\nend end\n"

    def unpack(values: Values) -> Values:
        if values[a] < low:
            if inner and values[b] < 0:
                raise Refused("rejected/range")
            return {a: values[a], b: run(values[b])}
        if values[a] < high:
            if middle.startswith("reject"):
                raise Refused("rejected")
            return {a: values[a], b: fits(-values[b])}
        return {a: values[a], b: values[b]}

    def some_of(rng: random.Random) -> Values:
        return {a: rng.choice([low, high, low - 1, high - 1, rng.randrange(-10, 12)]), b: near(rng)}

    kinds: dict[str, Kind] = {a: LONG, b: LONG}
    return Part(kinds, kinds, rules, unpack, some_of, some_of)


def same(relations: Relations, name: str) -> Part:
    """A field of one name on both sides, that no rule names; numbers may be of other widths."""
    rng = relations.rng
    if rng.random() < 0.2:
        origin, aim = rng.choice([("float32", "float64"), ("float64", "float32")])
        return Part({name: Scalar(origin)}, {name: Scalar(aim)}, "", lambda values: {name: rounded(values[name], aim)}, is_same=True)
    if rng.random() < 0.5:
        both = [relations.integer_type(relations.wire), relations.integer_type(relations.holder)]
        origin, aim = both if is_within(*both) or is_within(*reversed(both)) else ("int32", "int64")
        return Part({name: Scalar(origin)}, {name: Scalar(aim)}, "", lambda values: {name: fits(values[name], aim)}, is_same=True)
    kind: Kind = rng.choice([Scalar("float64"), Scalar("float32"), TEXT, Scalar("bool"), LONG])
    return Part({name: kind}, {name: kind}, "", dict, is_same=True)


def rounded(value: float, type_: str) -> np.floating:
    """A float as another type has it."""
    with np.errstate(over="ignore"):
        return np.float32(value) if type_ == "float32" else np.float64(value)


def is_within(narrow: str, wide: str) -> bool:
    return INTEGERS[wide][0] <= INTEGERS[narrow][0] and INTEGERS[narrow][1] <= INTEGERS[wide][1]


def same_arrays(relations: Relations, name: str) -> Part:
    """An array of one name on both sides; floats may be of other widths."""
    if relations.rng.random() < 0.3 and all(each in side.scalars for side in (relations.wire, relations.holder) for each in FLOATS):
        origin, aim = relations.rng.choice([FLOATS, FLOATS[::-1]])
        kinds = Array(Scalar(origin)), Array(Scalar(aim))
        return Part(
            {name: kinds[0]}, {name: kinds[1]}, "", lambda values: {name: [rounded(each, aim) for each in values[name]]}, is_same=True
        )
    types = [each for each in ("int8", "int16", "int32", "int64", "uint32", "float64") if each in relations.wire.scalars]
    kind = Array(Scalar(relations.rng.choice([each for each in types if each in relations.holder.scalars])))
    if relations.rng.random() < 0.3:
        kind = Array(TEXT)

    def some_of(rng: random.Random) -> Values:
        return {name: [some(rng, kind.element) for _ in range(rng.choice([0, 1, 5]))]}

    return Part({name: kind}, {name: kind}, "", lambda values: {name: list(values[name])}, some_of, some_of, is_same=True)
