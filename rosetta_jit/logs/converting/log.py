"""Logs into other logs: the messages of several topics, each on its way, in the order in which they lie."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rosetta_jit.logs.base import Wanted
    from rosetta_jit.logs.converting.routes import Route
    from rosetta_jit.logs.log import Log
    from rosetta_jit.logs.writing import Writer


def write_log(log: Log, routes: Sequence[Route], writer: Writer, wanted: Wanted, advance: Callable[[int], object] = int) -> None:
    """Write messages; ``advance`` is told how many were read.

    Raises
    ------
    LogError
        The format cannot carry the messages.
    DecodeError
        A message that has to be decoded is not what its type promises.
    """
    numbers: dict[int, int] = {}
    for route in routes:
        for origins, connection in route.connections:
            numbers |= dict.fromkeys(origins, writer.connect(connection))
    for block in log.blocks_ahead(wanted):
        rows, found = block.rows, dict[int, bytes]()
        for route in routes:
            found |= route.messages(block)
        channels, logged, published = (each.tolist() for each in (rows.channels, rows.log_ns, rows.publish_ns))
        for row in sorted(found):
            writer.write(numbers[channels[row]], logged[row], published[row], found[row])
        advance(len(rows))
