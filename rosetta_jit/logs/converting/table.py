"""The messages of one topic as a table in one file."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from rosetta_jit.file_errors import whole
from rosetta_jit.logs.converting.rejected import Damaged, Rejected
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from pathlib import Path

    import pyarrow as pa

    from rosetta_jit.logs.channel import Channel

TABLES = (".parquet", ".arrow", ".csv", ".npz")


@dataclass(slots=True)
class Conversion:
    """Messages of one topic on their way into a table.

    Attributes
    ----------
    advance
        Is told how many messages were read.
    """

    channel: Channel
    output: Path
    on_error: Damaged = "stop"
    advance: Callable[[int], object] = int
    options: dict[str, Any] = field(default_factory=dict[str, Any])

    def run(self) -> Rejected:
        """Write the table, which has its name when it is whole; gives what was left out, in ``….quarantine.jsonl`` if asked for.

        Raises
        ------
        DecodeError
            A message is not what its type promises, and ``on_error`` is to stop.
        """
        from rosetta_jit.runtime.arrow.files import write_tables

        rejected = Rejected(self.output.with_name(f"{self.output.name}.quarantine.jsonl"), self.on_error)
        rejected.begin()
        try:
            with whole(self.output) as part:
                write_tables(self._tables(rejected), part, self.output.suffix)
        finally:
            rejected.close()
        return rejected

    def _tables(self, rejected: Rejected) -> Iterator[pa.Table]:
        for part, table in self.channel.tables_of_parts(on_error=rejected.on_error, **self.options):
            rejected.add(self.channel.topic, part.first, part.batch.errors, part.refused)
            self.advance(part.given)
            yield table
