"""Values in one line, which stays short whatever a message holds: the begin of long texts and arrays, and how long they are."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any, cast

import numpy as np

from rosetta_jit.model.types import Enum
from rosetta_jit.runtime.holder import arena
from rosetta_jit.runtime.holder.message import Message, place
from rosetta_jit.runtime.holder.record import Entry, Scalar
from rosetta_jit.runtime.limits import (
    MAX_TEXT_BYTES,
    MAX_TEXT_CHARACTERS,
    MAX_TEXT_DEPTH,
    MAX_TEXT_FIELDS,
    MAX_TEXT_ITEMS,
    MAX_TEXT_NUMBERS,
)


def brief_message(message: Message, depth: int = 0) -> str:
    """A message as its constructor would be called with what is present."""
    name = type(message).__name__
    if depth > MAX_TEXT_DEPTH:
        return f"{name}(…)"
    shown = [f"{entry.name}={brief(value, depth + 1)}" for entry, value in islice(present_fields(message), MAX_TEXT_FIELDS)]
    rest = ["…"] if len(shown) == MAX_TEXT_FIELDS < len(message.access_.record.entries) else []
    return f"{name}({', '.join((*shown, *rest))})"


def present_fields(message: Message, most: int | None = None) -> Iterator[tuple[Entry, Any]]:
    """The fields that are there, or those among the first ones, and what they are read as, an enum's number as its name."""
    lanes, row = place(message)
    for entry in islice(message.access_.record.entries.values(), most):
        if arena.present(lanes, entry.presence, row):
            yield entry, named(entry, message.access_.getters[entry.name](message))


class Name(str):
    """The name of an enum's value, which is shown without quotes."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


def named(entry: Entry, value: Any) -> Any:
    """An enum's number as its name, where it has one."""
    node = entry.node
    if isinstance(node, Scalar) and isinstance(node.type, Enum):
        name = next((name for name, number in node.type.values if number == value), None)
        return value if name is None else Name(name)
    return value


def brief(value: Any, depth: int = 0) -> str:
    """A value of a field in one line."""
    match value:
        case Message():
            return brief_message(value, depth)
        case np.ndarray():
            array = cast("np.ndarray[Any, Any]", value).view(np.ndarray)  # whose float32 are shown with as many digits as they have
            return _listed(map(str, array.reshape(-1)[:MAX_TEXT_NUMBERS]), array.size, MAX_TEXT_NUMBERS)
        case Name():
            return repr(value)
        case str():
            return repr(value) if len(value) <= MAX_TEXT_CHARACTERS else f"{value[:MAX_TEXT_CHARACTERS]!r}… {len(value)} characters"
        case bytes():
            return repr(value) if len(value) <= MAX_TEXT_BYTES else f"{value[:MAX_TEXT_BYTES]!r}… {len(value)} bytes"
        case Mapping():
            pairs = cast("Mapping[Any, Any]", value)
            shown = (f"{brief(key)}: {brief(each, depth + 1)}" for key, each in islice(pairs.items(), MAX_TEXT_ITEMS))
            return f"{{{_listed(shown, len(pairs), MAX_TEXT_ITEMS)[1:-1]}}}"
        case Sequence():
            items = cast("Sequence[Any]", value)
            return _listed((brief(each, depth + 1) for each in items[:MAX_TEXT_ITEMS]), len(items), MAX_TEXT_ITEMS)
        case _:
            return repr(value)


def _listed(shown: Iterable[str], count: int, most: int) -> str:
    rest = [] if count <= most else [f"… {count} in all"]
    return f"[{', '.join((*shown, *rest))}]"
