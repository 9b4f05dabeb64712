"""Random relations to elements that a key tells, to maps and arrays of entries, and of texts that are joined and split."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tests.random_mappings.meaning import TEXTS, Refused, fits
from tests.random_mappings.message_types import Array, Kind, Map, Message, Scalar, some
from tests.random_mappings.relations import Part
from tests.random_mappings.values import quoted

if TYPE_CHECKING:
    import random
    from collections.abc import Callable, Mapping

    from tests.random_mappings.blocks import Relations
    from tests.random_mappings.relations import Values

KEYS = ("a", "b", "é", "long key", "12", "")
NUMBERS = (0, 1, -1, 7, 300, 2**31 - 1)


def some_key(rng: random.Random, type_: str) -> Any:
    return rng.choice(KEYS) if type_ == "string" else rng.choice(NUMBERS)


def shown_key(key: str | int) -> str:
    return quoted(key) if isinstance(key, str) else str(key)


def the_one(entries: list[dict[str, Any]], key: Any) -> Any:
    """The value that stands once beside a key."""
    found = [each["value"] for each in entries if each["key"] == key]
    if len(found) != 1:
        raise Refused("index")
    return found[0]


def entries_of(name: str, side: str, key: str, value: str) -> Array:
    return Array(Message(f"{side}{name.upper()}", {"key": Scalar(key), "value": Scalar(value)}))


def searched(relations: Relations, name: str) -> Part:
    """Fields of their own here, entries with keys there: on the wire, in the holder, or in a map."""
    rng = relations.rng
    key_type, value_type = rng.choice(["string", "int32"]), rng.choice(["float64", "int64", "string"])
    keys = rng.sample(KEYS if key_type == "string" else NUMBERS, rng.choice([1, 2, 3]))
    fields = [f"{name}{letter}" for letter in "abc"[: len(keys)]]
    sign = "-" if value_type == "int64" and rng.random() < 0.5 else ""
    change: Callable[[Any], Any] = (lambda x: fits(-x)) if sign else (lambda x: x)
    places = [f".{name}[.key = {shown_key(key)}].value" for key in keys]
    apart: dict[str, Kind] = dict.fromkeys(fields, Scalar(value_type))

    def values_of(rng: random.Random) -> Values:
        return {each: some(rng, Scalar(value_type)) for each in fields}

    def entries(rng: random.Random) -> Values:
        there = [*keys, *(some_key(rng, key_type) for _ in range(rng.choice([0, 0, 1, 4])))]
        there = [each for each in there if rng.random() < 0.97]
        rng.shuffle(there)
        return {name: [{"key": each, "value": some(rng, Scalar(value_type))} for each in there]}

    if rng.random() < 0.6:
        has_maps = key_type in relations.wire.map_keys and rng.random() < 0.6
        kind: Kind = Map(key_type, value_type) if has_maps else entries_of(name, "Src", key_type, value_type)
        lines = [f".{field} <-> {sign}{place}\n" for field, place in zip(fields, places, strict=True)]
        rng.shuffle(lines)

        def unpack(values: Values) -> Values:
            rows = as_entries(values[name])
            return {field: change(the_one(rows, key)) for field, key in zip(fields, keys, strict=True)}

        wires = (lambda rng: {name: as_map(entries(rng)[name])}) if has_maps else entries
        return Part({name: kind}, apart, "".join(lines), unpack, wires, values_of)
    has_maps = key_type in relations.holder.map_keys and rng.random() < 0.6
    kind = Map(key_type, value_type) if has_maps else entries_of(name, "Dst", key_type, value_type)
    lines = [f"{place} <-> {sign}.{field}\n" for field, place in zip(fields, places, strict=True)]

    def pack(values: Values) -> Values:
        rows = [{"key": key, "value": change(values[field])} for field, key in zip(fields, keys, strict=True)]
        return {name: as_map(rows) if has_maps else rows}

    holders = (lambda rng: {name: as_map(entries(rng)[name])}) if has_maps else entries
    return Part(apart, {name: kind}, "".join(lines), pack, values_of, holders)


def as_map(entries: list[dict[str, Any]]) -> dict[Any, Any]:
    return {each["key"]: each["value"] for each in entries}


def as_entries(held: Mapping[Any, Any] | list[dict[str, Any]]) -> list[dict[str, Any]]:
    return held if isinstance(held, list) else [{"key": key, "value": value} for key, value in held.items()]


def maps(relations: Relations, name: str) -> Part:
    """A map, or an array of entries, as a map or as an array of entries: as a whole, member by member, or in a loop."""
    rng = relations.rng
    key_type, value_type = rng.choice(["string", "int32", "int64"]), rng.choice(["float64", "int64", "string", "bool", "int32"])
    are_maps = [key_type in wire.map_keys and rng.random() < 0.7 for wire in (relations.wire, relations.holder)]
    kinds: list[Kind] = [
        Map(key_type, value_type) if is_map else entries_of(name, side, key_type, value_type)
        for side, is_map in zip(("Src", "Dst"), are_maps, strict=True)
    ]
    sign = "-" if value_type == "float64" and rng.random() < 0.5 else ""
    forms = [
        f".{name}[].key <-> .{name}[].key\n.{name}[].value <-> {sign}.{name}[].value\n",
        (
            f"len(.{name}) <-> len(.{name})\nfor i from 0 to len(.{name})\n"
            f".{name}[i].key <-> .{name}[i].key\n.{name}[i].value <-> {sign}.{name}[i].value\nend\n"
        ),
    ]
    if all(are_maps):
        sign = ""
        forms = [f".{name} <-> .{name}\n"]

    def unpack(values: Values) -> Values:
        rows = [{"key": each["key"], "value": -each["value"] if sign else each["value"]} for each in as_entries(values[name])]
        return {name: as_map(rows) if are_maps[1] else rows}

    def some_of(rng: random.Random, *, is_map: bool) -> Values:
        keys = list(dict.fromkeys(some_key(rng, key_type) for _ in range(rng.choice([0, 1, 3, 9]))))
        rows = [{"key": each, "value": some(rng, Scalar(value_type))} for each in keys]
        return {name: as_map(rows) if is_map else rows}

    return Part(
        {name: kinds[0]},
        {name: kinds[1]},
        rng.choice(forms),
        unpack,
        lambda rng: some_of(rng, is_map=are_maps[0]),
        lambda rng: some_of(rng, is_map=are_maps[1]),
        is_sure=True,
    )


def separated(relations: Relations, name: str) -> Part:
    """Texts with separators between them, on one side or the other."""
    rng = relations.rng
    separator = rng.choice([",", ", ", "/", "aa", "é", "ab"])
    texts: dict[str, Kind] = {name: Array(Scalar("string"))}
    line: dict[str, Kind] = {name: Scalar("string")}
    if rng.random() < 0.5:

        def join(values: Values) -> Values:
            together = separator.join(values[name])
            if split(together, separator) != list(values[name]):
                raise Refused("text")
            return {name: together}

        return Part(
            texts, line, f".{name} <-> join(.{name}, {quoted(separator)})\n", join, lambda rng: {name: some_texts(rng, separator)},
            lambda rng: {name: some_line(rng, separator)},
        )  # fmt: skip
    return Part(
        line,
        texts,
        f".{name} <-> split(.{name}, {quoted(separator)})\n",
        lambda values: {name: split(values[name], separator)},
        lambda rng: {name: some_line(rng, separator)},
        lambda rng: {name: some_texts(rng, separator)},
    )


def split(text: str, separator: str) -> list[str]:
    return text.split(separator) if text else []


def some_texts(rng: random.Random, separator: str) -> list[str]:
    pieces = ["", "x", "é", "b", *TEXTS[:6], *(separator if rng.random() < 0.1 else "")]
    return ["".join(rng.choice(pieces) for _ in range(rng.choice([0, 1, 2]))) for _ in range(rng.choice([0, 1, 2, 5]))]


def some_line(rng: random.Random, separator: str) -> str:
    return "".join(rng.choice([separator, separator[:1], "x", "é", "", "a/b"]) for _ in range(rng.randrange(7)))
