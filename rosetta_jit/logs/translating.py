"""A log of ROS 1 as a log of ROS 2: a bridge for each topic gives fields their new names, and writes CDR.

A definition of ROS 2 is needed of each type: those that are shipped, and those on the search path. Nothing is altered: a value that the
new field cannot hold, or a field that has no successor but a header's `seq`, is an error.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError
from rosetta_jit.frameworks.ros2.successors import definition, successor
from rosetta_jit.language.imports.search import Reading, SearchPath
from rosetta_jit.logs.base import Connection
from rosetta_jit.logs.writing import written
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from rosetta_jit.api.bridges import Bridge
    from rosetta_jit.logs.base import Block, Wanted
    from rosetta_jit.logs.channel import Channel
    from rosetta_jit.logs.log import Log


@dataclass(frozen=True, slots=True, eq=False)
class Stream:
    """The messages of a topic on their way: where they come from, and what they become."""

    channel: Channel
    connection: Connection
    bridge: Bridge

    def translated(self, block: Block) -> dict[int, bytes]:
        """Those of a block, by their rows."""
        chosen = np.flatnonzero(np.isin(block.rows.channels, [each.number for each in self.channel.connections]))
        if not len(chosen):
            return {}
        buffer, places = self.channel.bridged(block, block.rows.only(chosen), self.bridge)
        octets, ends = buffer.tobytes(), places.tolist()
        return {row: octets[ends[index] : ends[index + 1]] for index, row in enumerate(chosen.tolist())}


def translate_log(
    log: Log,
    channels: Iterable[Channel],
    output: Path,
    wanted: Wanted,
    *,
    folders: Iterable[str] = (),
    advance: Callable[[int], object] = int,
) -> None:
    """Write messages of ROS 1 as those of ROS 2.

    Raises
    ------
    LogError
        A topic is not of ROS 1, or there is no definition of its type in ROS 2.
    DecodeError
        A message is not what its type promises, or has a value that does not fit into a field's successor.
    SchemaError
        A field has no successor.
    """
    search = SearchPath.of(folders)
    streams = [_stream(log, channel, search) for channel in channels]
    with written(output) as writer:
        numbers = [writer.connect(each.connection) for each in streams]
        for block in log.blocks(wanted):
            found: dict[int, tuple[int, bytes]] = {}
            for number, stream in zip(numbers, streams, strict=True):
                found |= {row: (number, data) for row, data in stream.translated(block).items()}
            for row in sorted(found):
                number, data = found[row]
                writer.write(number, int(block.rows.log_ns[row]), int(block.rows.publish_ns[row]), data)
            advance(len(block.rows))


def _stream(log: Log, channel: Channel, search: SearchPath) -> Stream:
    if channel.encoding != "ros1":
        raise LogError((words.not_of_ros1(log.name, channel.topic, channel.encoding),))
    type_ = successor(channel.type)
    text = definition(type_, search.loader(Reading()))
    if text is None:
        raise LogError((words.no_successor(log.name, channel.topic, type_),))
    bridge = channel.bridge_to(type_, {"encoding": "cdr", "schema": text})
    connection = Connection(0, channel.topic, type_, "cdr", "ros2msg", text.encode())
    return Stream(channel, connection, bridge)
