"""Blocks of messages that come one by one, from formats whose records need no compiled walk."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.logs.base import Block
from rosetta_jit.logs.reading.walking import Rows

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from typing import TypeAlias

    One: TypeAlias = tuple[int, int, int, bytes]
    """A message: its channel, when it was logged and published, its bytes."""

BYTES, MESSAGES = 4 << 20, 8192


def blocks_of(messages: Iterable[One]) -> Iterator[Block]:
    """The same messages, some megabytes at a time."""
    waiting, size = list[tuple[int, int, int, bytes]](), 0
    for each in messages:
        waiting.append(each)
        size += len(each[3])
        if size >= BYTES or len(waiting) >= MESSAGES:
            yield _block(waiting)
            waiting, size = [], 0
    if waiting:
        yield _block(waiting)


def _block(messages: list[One]) -> Block:
    channels, log_ns, publish_ns, pieces = zip(*messages, strict=True)
    places = np.cumsum([0, *map(len, pieces)], dtype=np.int64)
    rows = Rows(np.array(channels, np.int64), np.array(log_ns, np.int64), np.array(publish_ns, np.int64), places[:-1], places[1:])
    return Block(np.frombuffer(b"".join(pieces), np.uint8), rows)
