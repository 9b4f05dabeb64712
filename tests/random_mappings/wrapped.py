"""Random relations of fields within messages: of one, of each of an array, and of the cases of a union."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from tests.random_mappings.meaning import Refused, fits
from tests.random_mappings.message_types import Array, Choice, Kind, Message, Scalar, some
from tests.random_mappings.nested import unpacked_in_order
from tests.random_mappings.relations import Part, below_all
from tests.random_mappings.values import quoted

if TYPE_CHECKING:
    import random
    from collections.abc import Callable

    from tests.random_mappings.blocks import Relations
    from tests.random_mappings.relations import Values

FIELD = re.compile(r"(?<![\w\]])\.(f\d+\w*)")
"""A path to a field of a relation, at its begin."""


def inner(relations: Relations) -> list[Part]:
    """Relations that say all there is to them in one block; within those within these there is nothing more."""
    relations.depth += 1
    made = [relations.part() for _ in range(relations.rng.randrange(1, 4))] if relations.depth < 3 else []
    relations.depth -= 1
    kept = [each for each in made if not (each.is_same or each.mappings or each.units or each.pack)]
    relations.made += 1
    return kept or [relations.integers(f"f{relations.made}")]


def messages(parts: list[Part], name: str) -> tuple[Message, Message]:
    return (
        Message(f"Src{name.upper()}", below_all(part.wire for part in parts)),
        Message(f"Dst{name.upper()}", below_all(part.holder for part in parts)),
    )


def within(parts: list[Part], place: str) -> str:
    """The rules of relations whose fields stand at a place."""
    return FIELD.sub(rf"{place}.\1", "".join(part.text for part in parts))


def values_of(parts: list[Part], side: str) -> Callable[[random.Random], Values]:
    return lambda rng: {name: value for part in parts for name, value in getattr(part, f"some_{side}")(rng).items()}


def parameters(parts: list[Part]) -> dict[str, Any]:
    return {"parameters": below_all(part.parameters for part in parts), "is_sure": any(part.is_sure for part in parts)}


def defaults_apart(rules: str, one: str, each: str) -> tuple[str, str]:
    """The rules of one element, and beside them its defaults of elements, of each: these stand in no block."""
    lines = rules.splitlines(keepends=True)
    apart = [line for line in lines if line.startswith("default ") and "[]" in line]
    return "".join(line for line in lines if line not in apart), "".join(apart).replace(one, each)


def held(relations: Relations, name: str) -> Part:
    """The fields of a message."""
    parts = inner(relations)
    src, dst = messages(parts, name)
    wires, holders = values_of(parts, "wire"), values_of(parts, "holder")
    return Part(
        {name: src},
        {name: dst},
        within(parts, f".{name}"),
        lambda values: {name: unpacked_in_order(parts, values[name])},
        lambda rng: {name: wires(rng)},
        lambda rng: {name: holders(rng)},
        **{**parameters(parts), "is_sure": True},
    )


def repeated(relations: Relations, name: str) -> Part:
    """The fields of each of an array of messages."""
    if relations.is_counted:
        return held(relations, name)
    parts = inner(relations)
    src, dst = messages(parts, name)
    wires, holders = values_of(parts, "wire"), values_of(parts, "holder")
    body, beside = defaults_apart(within(parts, f".{name}[k_{name}]"), f".{name}[k_{name}]", f".{name}[]")

    def unpack(values: Values) -> Values:
        found, kinds = [], []
        for each in values[name]:
            try:
                found.append(unpacked_in_order(parts, each))
            except Refused as refused:
                kinds.append(refused.kind)
        if kinds:
            raise Refused("/".join(kinds))
        return {name: found}

    return Part(
        {name: Array(src)},
        {name: Array(dst)},
        f"len(.{name}) <-> len(.{name})\nfor k_{name} from 0 to len(.{name})\n{body}end\n{beside}",
        unpack,
        lambda rng: {name: [wires(rng) for _ in range(rng.choice([0, 1, 2, 3]))]},
        lambda rng: {name: [holders(rng) for _ in range(rng.choice([0, 1, 2, 3]))]},
        **{**parameters(parts), "is_sure": True},
    )


def united(relations: Relations, name: str) -> Part:
    """A case of a union there as the same case of one here."""
    relations.blocks += 1
    if not (relations.wire.has_unions and relations.holder.has_unions) or relations.blocks > 2:
        return held(relations, name)
    a, b = f"{name}a", f"{name}b"
    begin = relations.rng.choice(["a", "é/"])
    cases = {a: Scalar("int64"), b: Scalar("string")}
    there, here = (f".{name}." if wire.has_named_unions else "." for wire in (relations.wire, relations.holder))
    names = [name if wire.has_named_unions else f"{name}_of" for wire in (relations.wire, relations.holder)]
    rest = f"ignore .{names[0]}\ndefault .{names[1]}"
    text = (
        f"when has({there}{a})\n{here}{a} <-> -{there}{a}\nelse when has({there}{b})\n"
        f"{here}{b} <-> {quoted(begin)} + {there}{b}\nelse\n{rest}\nend end\n"
    )

    def chosen(values: Values, *, is_named: bool) -> Values:
        return values.get(name, {}) if is_named else {each: values[each] for each in cases if each in values}

    def laid(case: Values, *, is_named: bool) -> Values:
        return {name: case} if is_named else case

    def unpack(values: Values) -> Values:
        case = chosen(values, is_named=relations.wire.has_named_unions)
        made = {each: fits(-value) if each == a else begin + value for each, value in case.items()}
        return laid(made, is_named=relations.holder.has_named_unions)

    def some_case(rng: random.Random) -> Values:
        case = rng.choice([a, b, ""])
        return {case: some(rng, cases[case])} if case else {}

    def holder_case(rng: random.Random) -> Values:
        case = some_case(rng)
        return {b: begin + case[b]} if b in case and rng.random() < 0.8 else case

    sides: list[Kind] = [Choice(f"{side}{name.upper()}", cases, wire.has_named_unions) for side, wire in
                         (("Src", relations.wire), ("Dst", relations.holder))]  # fmt: skip
    return Part(
        {name: sides[0]},
        {name: sides[1]},
        text,
        unpack,
        lambda rng: laid(some_case(rng), is_named=relations.wire.has_named_unions),
        lambda rng: laid(holder_case(rng), is_named=relations.holder.has_named_unions),
        is_bounded=True,
    )
