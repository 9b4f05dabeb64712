"""Random relations of bytes: as they are, as texts, and padded or cut out of others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.random_mappings.meaning import TEXTS, Refused
from tests.random_mappings.message_types import OCTETS, Scalar
from tests.random_mappings.relations import Part

if TYPE_CHECKING:
    from collections.abc import Callable

    from tests.random_mappings.blocks import Relations
    from tests.random_mappings.relations import Values

ENCODINGS = {"utf-8": "utf-8", "ascii": "ascii", "latin-1": "latin-1", "utf-16le": "utf-16-le", "utf-16be": "utf-16-be"}
"""Ours, and Python's name."""


def octets(relations: Relations, name: str) -> Part:
    """Bytes on both sides, or texts on one of them."""
    encoding = relations.rng.choice(list(ENCODINGS))
    python = ENCODINGS[encoding]
    texts, data = {name: Scalar("string")}, {name: OCTETS}

    def as_text(fields: Values) -> Values:
        return {name: changed(lambda: fields[name].decode(python))}

    def as_bytes(fields: Values) -> Values:
        return {name: changed(lambda: fields[name].encode(python))}

    match relations.rng.randrange(4):
        case 0:
            return Part(data, data, f".{name} <-> .{name}\n", lambda fields: {name: fields[name]})
        case 1:
            likely = lambda rng: {name: rng.choice(TEXTS).encode(python, "replace")}  # noqa: E731 - one line
            return Part(data, texts, f'.{name} <-> text(.{name}, "{encoding}")\n', as_text, likely)
        case 2:
            return Part(texts, data, f'.{name} <-> bytes(.{name}, "{encoding}")\n', as_bytes)
        case _:
            return padded(relations, name)


def padded(relations: Relations, name: str) -> Part:
    """A text of bytes that are filled up with NUL."""
    size = relations.rng.choice([4, 9])

    def unpack(fields: Values) -> Values:
        if len(fields[name]) > size:
            raise Refused("count/length/range")
        return {name: fields[name].ljust(size, b"\0")}

    data = {name: OCTETS}
    return Part(
        data,
        data,
        f".{name} <-> padded(.{name}, {size})\n",
        unpack,
        holders=lambda rng: {name: rng.randbytes(rng.randrange(size)).ljust(size, b"\0")},
    )


def changed(change: Callable[[], str | bytes]) -> str | bytes:
    try:
        return change()
    except UnicodeError:
        raise Refused("text") from None
