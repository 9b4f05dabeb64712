"""Messages of a topic on their way into another log: as they are, or through a mapping into the data of another framework."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import LogError, ReportError
from rosetta_jit.logs.base import Block, Connection
from rosetta_jit.logs.decoded_parts import Refused
from rosetta_jit.startup.dataclass import dataclass, field, replace

if TYPE_CHECKING:
    from rosetta_jit.logs.channel import Channel
    from rosetta_jit.logs.converting.rejected import Rejected


class Route(Protocol):
    """The way of a topic's messages."""

    @property
    def connections(self) -> list[tuple[frozenset[int], Connection]]:
        """The connections of the new log, and the numbers of those from which their messages come."""
        ...

    def messages(self, block: Block) -> dict[int, bytes]:
        """Those of a block, by their rows."""
        ...


@dataclass(frozen=True, slots=True)
class Copied:
    """Messages as they are. Their definition is looked for where the log has none, and ``notice`` is told if it is nowhere."""

    channel: Channel
    notice: Callable[[Diagnostic], object]

    @property
    def connections(self) -> list[tuple[frozenset[int], Connection]]:
        return [(frozenset({each.number}), self._described(each)) for each in self.channel.connections]

    def _described(self, connection: Connection) -> Connection:
        channel = self.channel
        if connection.encoding == "ros1" and connection.type and "md5sum" not in connection.details:
            holder: Any = channel.decoder.holder_type
            connection = replace(connection, details={**connection.details, "md5sum": str(holder._md5sum)})  # noqa: SLF001 - genpy's name
        if connection.schema:
            return connection
        try:
            decoder = channel.decoder
            definition = decoder.definition
        except ReportError:
            self.notice(words.without_definition(channel.topic))
            return connection
        if definition is None:
            return connection
        return replace(
            connection, type=decoder.holder_type.family_.struct.name, schema_encoding=definition.language, schema=definition.data
        )

    def messages(self, block: Block) -> dict[int, bytes]:
        view, rows = block.data.data, block.rows
        chosen = np.flatnonzero(rows.are_of(self.channel.numbers)).tolist()
        begins, ends = rows.begins.tolist(), rows.ends.tolist()
        return {row: bytes(view[begins[row] : ends[row]]) for row in chosen}


@dataclass(slots=True)
class Mapped:
    """Messages through a mapping, encoded as the framework of its data holders does; what cannot be decoded goes to ``rejected``."""

    channel: Channel
    rejected: Rejected
    encode: Any
    connections: list[tuple[frozenset[int], Connection]]
    seen: int = field(default=0)

    @classmethod
    def through(cls, channel: Channel, rejected: Rejected) -> Mapped:
        """The way of a channel that has a mapping.

        Raises
        ------
        LogError
            The framework of the mapping's data holders has no bytes for them.
        """
        holder: Any = channel.decoder.holder_type
        manners, definition = holder.family_.manners, channel.decoder.definition
        if manners.serialising is None:
            raise LogError((words.no_bytes(channel.topic, holder.family_.struct.name),))
        _, encoding = manners.serialising
        language, schema = ("", b"") if definition is None else (definition.language, definition.data)
        details = {"md5sum": str(holder._md5sum)} if hasattr(holder, "_md5sum") else {}  # noqa: SLF001 - genpy's name
        type_ = holder.family_.struct.name
        connection = Connection(0, channel.topic, type_, encoding.removesuffix("-partial"), language, schema, details=details)
        return cls(channel, rejected, holder.programs_.encode, [(channel.numbers, connection)])

    def messages(self, block: Block) -> dict[int, bytes]:
        chosen = np.flatnonzero(block.rows.are_of(self.channel.numbers))
        if not len(chosen):
            return {}
        rows = block.rows.only(chosen)
        batch = self.channel.decoded(block, rows, self.rejected.on_error)
        if batch.errors:
            spans = {index: slice(rows.begins[index], rows.ends[index]) for index in batch.errors}
            refused = {index: Refused(int(rows.log_ns[index]), block.data[span].tobytes()) for index, span in spans.items()}
            self.rejected.add(self.channel.topic, self.seen, batch.errors, refused)
        self.seen += len(rows)
        buffer, places = self.encode.many(batch)
        octets, ends = buffer.tobytes(), places.tolist()
        return {row: octets[ends[index] : ends[index + 1]] for index, row in enumerate(chosen[batch.kept].tolist())}
