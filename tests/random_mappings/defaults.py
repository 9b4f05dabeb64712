"""Random relations beside fields that none sets: a rejection says what they are, or they have their default, in elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.random_mappings.meaning import Refused
from tests.random_mappings.message_types import Array, Kind, Message, Scalar, some
from tests.random_mappings.refusals import rejected
from tests.random_mappings.relations import Part

if TYPE_CHECKING:
    import random
    from collections.abc import Callable

    from tests.random_mappings.blocks import Relations
    from tests.random_mappings.relations import Values

BYTE = 256


def demanded(relations: Relations, name: str) -> Part:
    """A field that a rejection asks to be what is computed of another one: packing writes that, but not in elements."""
    if relations.depth:
        return rejected(relations, name)
    rng = relations.rng
    a, check = f"{name}a", f"{name}c"
    computed: list[tuple[str, Callable[[int], int]]] = [
        (f".{a} & 255", lambda value: value & 255),
        (f"modulo(.{a}, 97) + 3", lambda value: value % 97 + 3),
        (f"100 - (.{a} & 15)", lambda value: 100 - (value & 15)),
    ]
    text, run = rng.choice(computed)
    lines = [f".{a} <-> .{a}\n", f'reject "damaged {{.{check}}}" when {rng.choice([f".{check} != {text}", f"{text} != .{check}"])}\n']
    rng.shuffle(lines)

    def unpack(values: Values) -> Values:
        if values[check] != run(values[a]):
            raise Refused("rejected")
        return {a: values[a]}

    def wires(rng: random.Random) -> Values:
        value = rng.randrange(-(2**31), 2**31)
        return {a: value, check: run(value) if rng.random() < 0.8 else rng.randrange(BYTE)}

    kinds: dict[str, Kind] = {a: Scalar("int64"), check: Scalar(rng.choice(["int32", "int64"]))}
    return Part(kinds, {a: Scalar("int64")}, "".join(lines), unpack, wires, lambda rng: {a: rng.randrange(-(2**31), 2**31)})


def defaulted(relations: Relations, name: str) -> Part:
    """Elements some fields of which no rule sets, or reads: each has its default."""
    rng = relations.rng
    type_, nothing = rng.choice([("float64", 0.0), ("int64", 0), ("string", ""), ("bool", False)])
    members: dict[str, Kind] = {"u": Scalar("int32"), "v": Scalar(type_)}
    known: dict[str, Kind] = {"u": members["u"]}
    side = rng.choice(["default", "ignore"])
    of_wire, of_holder = (known, members) if side == "default" else (members, known)
    wire, holder = Message(f"Src{name.upper()}", of_wire), Message(f"Dst{name.upper()}", of_holder)
    lines = [f".{name}[].u <-> .{name}[].u\n", f"{side} .{name}[].v\n"]
    rng.shuffle(lines)
    left = {} if side == "ignore" else {"v": nothing}

    def unpack(values: Values) -> Values:
        return {name: [{"u": each["u"], **left} for each in values[name]]}

    def elements(fields: dict[str, Kind], rng: random.Random) -> Values:
        return {name: [{each: some(rng, kind) for each, kind in fields.items()} for _ in range(rng.choice([0, 1, 4]))]}

    return Part(
        {name: Array(wire)},
        {name: Array(holder)},
        "".join(lines),
        unpack,
        lambda rng: elements(of_wire, rng),
        lambda rng: elements(of_holder, rng),
    )
