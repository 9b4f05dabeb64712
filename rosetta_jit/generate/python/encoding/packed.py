"""The parts of a message that an encoder joins, as Python expressions."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.generate.python.encoding.object_rows import ObjectScope

ANY = "?"
"""The order of numbers that have a byte each."""


@dataclass(frozen=True, slots=True)
class Part:
    """Numbers that are packed, of such ``codes``; without these, bytes."""

    order: str
    codes: str
    texts: tuple[str, ...]


def with_numbers(parts: Sequence[Part], order: str, codes: str, texts: tuple[str, ...]) -> list[Part]:
    """Parts and numbers behind them, which are packed together with numbers of the same order; without an ``order`` they have any."""
    last = parts[-1] if parts else None
    if last is None or not last.codes or (order and last.order not in (order, ANY)):
        return [*parts, Part(order or ANY, codes, texts)]
    return [*parts[:-1], Part(order or last.order, last.codes + codes, (*last.texts, *texts))]


def part_text(part: Part, scope: ObjectScope, exact: Mapping[int, int]) -> str:
    """The bytes of a part; ``exact`` says how many elements arrays have, by lane, where that was checked."""
    order = "<" if part.order == ANY else part.order
    if not part.codes:
        return part.texts[0]
    if all(each.isdecimal() for each in part.texts):
        return repr(struct.pack(f"{order}{part.codes}", *map(int, part.texts)))
    return f"{scope.struct(order, part.codes, 'whole')}({', '.join(_starred(part, scope, exact))})"


def starred(local: str, scope: ObjectScope) -> str:
    """All elements of an array as arguments."""
    return f"*_few({local})" if scope.numpy else f"*{local}"


def _starred(part: Part, scope: ObjectScope, exact: Mapping[int, int]) -> list[str]:
    """What is packed: all elements of an array, which follow each other, as it is."""
    texts = list(part.texts)
    for lane, count in exact.items():
        own = scope.sequences[lane].local
        each = [f"{own}[{number}]" for number in range(count)]
        for begin in range(len(texts) - count + 1):
            if count and texts[begin : begin + count] == each:
                texts[begin : begin + count] = [starred(own, scope)]
                break
    return texts
