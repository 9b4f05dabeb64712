"""Logs into other files: the messages of a topic as a table, whole logs as they are.

Messages that cannot be decoded stop the work, are left out, or are written to a file of their own with the reasons (``quarantine``).
"""

from __future__ import annotations

import json
from base64 import b64encode
from contextlib import ExitStack
from dataclasses import field
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from rosetta_jit.logs.writing import whole, written
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path
    from typing import TextIO

    import pyarrow as pa

    from rosetta_jit.logs.base import Wanted
    from rosetta_jit.logs.channel import Channel, Part
    from rosetta_jit.logs.log import Log

Damaged: TypeAlias = Literal["stop", "skip", "quarantine"]
TABLES = (".parquet", ".arrow", ".csv", ".npz")


@dataclass(slots=True)
class Conversion:
    """Messages of one topic on their way into a table.

    Attributes
    ----------
    advance
        Is told how many messages were read.
    left_out
        How many messages could not be decoded.
    """

    channel: Channel
    output: Path
    on_error: Damaged = "stop"
    advance: Callable[[int], object] = int
    left_out: int = 0
    options: dict[str, Any] = field(default_factory=dict[str, Any])

    @property
    def quarantine(self) -> Path:
        """The file of messages that could not be decoded."""
        return self.output.with_name(f"{self.output.name}.quarantine.jsonl")

    def run(self) -> None:
        """Write the table. It has its name when it is whole.

        Raises
        ------
        DecodeError
            A message is not what its type promises, and ``on_error`` is to stop.
        """
        from rosetta_jit.runtime.arrow.files import write_tables

        with whole(self.output) as part, ExitStack() as stack:
            write_tables(self._tables(stack), part, self.output.suffix)

    def _tables(self, stack: ExitStack) -> Iterator[pa.Table]:
        rejected: TextIO | None = None
        for part, table in self.channel.tables_of_parts(on_error="raise" if self.on_error == "stop" else "skip", **self.options):
            if part.batch.errors and self.on_error == "quarantine":
                rejected = rejected or stack.enter_context(self.quarantine.open("w", encoding="utf-8"))
                rejected.writelines(_rejected(part))
            self.left_out += len(part.batch.errors)
            self.advance(len(part.staged.log_ns))
            yield table


def _rejected(part: Part) -> Iterator[str]:
    """A line a message: its number, when it was logged, why it was left out, and its bytes."""
    for index, error in part.batch.errors.items():
        data = part.staged.data[part.staged.offsets[index] : part.staged.offsets[index + 1]]
        line = {"message": part.first + index, "log_time": int(part.staged.log_ns[index]), "error": str(error)}
        yield json.dumps({**line, "base64": b64encode(data.tobytes()).decode("ascii")}) + "\n"


def copy_log(log: Log, channels: Iterable[Channel], output: Path, wanted: Wanted, advance: Callable[[int], object] = int) -> None:
    """Messages into a log of another format, or of the same: their bytes stay as they are.

    Raises
    ------
    LogError
        The format cannot carry the messages.
    """
    with written(output) as writer:
        numbers = {each.number: writer.connect(_described(each, channel)) for channel in channels for each in channel.connections}
        for block in log.blocks(wanted):
            rows, view = block.rows, block.data.data
            columns = (each.tolist() for each in (rows.channels, rows.log_ns, rows.publish_ns, rows.begins, rows.ends))
            for number, log_ns, publish_ns, begin, end in zip(*columns, strict=True):
                if number in numbers:
                    writer.write(numbers[number], log_ns, publish_ns, bytes(view[begin:end]))
            advance(len(rows))


def _described(connection: Any, channel: Channel) -> Any:
    """A connection with what other formats must know of it: bags have md5 sums."""
    from dataclasses import replace

    if connection.encoding != "ros1" or "md5sum" in connection.details or not connection.type:
        return connection
    holder: Any = channel.decoder.holder_type
    return replace(connection, details={**connection.details, "md5sum": str(holder._md5sum)})  # noqa: SLF001 - it is genpy's name
