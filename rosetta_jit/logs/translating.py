"""A log of ROS 1 as a log of ROS 2: a bridge for each topic gives fields their new names, and writes CDR.

A definition of ROS 2 is needed of each type: those that are shipped, and those on the search path. Nothing is altered: a value that the
new field cannot hold, or a field that has no successor but a header's `seq`, is an error.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError
from rosetta_jit.frameworks.ros2.successors import definition, successor
from rosetta_jit.logs.base import Block, Connection
from rosetta_jit.parsing.search import Reading, SearchPath
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.api.bridges import Bridge
    from rosetta_jit.logs.channel import Channel
    from rosetta_jit.logs.log import Log


@dataclass(frozen=True, slots=True, eq=False)
class Stream:
    """The messages of a topic on their way: where they come from, and what they become."""

    channel: Channel
    connection: Connection
    bridge: Bridge

    @property
    def connections(self) -> list[tuple[frozenset[int], Connection]]:
        """Those of the topic become one."""
        return [(self.channel.numbers, self.connection)]

    def messages(self, block: Block) -> dict[int, bytes]:
        """Those of a block, by their rows."""
        chosen = np.flatnonzero(block.rows.are_of(self.channel.numbers))
        if not len(chosen):
            return {}
        buffer, places = self.channel.bridged(block, block.rows.only(chosen), self.bridge)
        octets, ends = buffer.tobytes(), places.tolist()
        return {row: octets[ends[index] : ends[index + 1]] for index, row in enumerate(chosen.tolist())}


def translated(log: Log, channel: Channel, folders: Iterable[str] = ()) -> Stream:
    """The way of a topic's messages from ROS 1 to ROS 2.

    Raises
    ------
    LogError
        The topic is not of ROS 1, or there is no definition of its type in ROS 2.
    DecodeError
        A message is not what its type promises, or has a value that does not fit into a field's successor.
    SchemaError
        A field has no successor.
    """
    if channel.encoding != "ros1":
        raise LogError((words.not_of_ros1(log.name, channel.topic, channel.encoding),))
    type_ = successor(channel.type)
    text = definition(type_, SearchPath.of(folders).loader(Reading()))
    if text is None:
        raise LogError((words.no_successor(log.name, channel.topic, type_),))
    bridge = channel.bridge_to(type_, {"encoding": "cdr", "schema": text})
    connection = Connection(0, channel.topic, type_, "cdr", "ros2msg", text.encode())
    return Stream(channel, connection, bridge)
