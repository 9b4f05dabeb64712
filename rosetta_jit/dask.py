"""Logs as Dask DataFrames: `read_log` gives a frame, of which each partition is a log, or a stretch of a large one."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Literal

from rosetta_jit.errors import MissingPackage
from rosetta_jit.logs.decoded_parts import CLOCKS
from rosetta_jit.logs.shares import Reading, Share, paths_of, shares_of
from rosetta_jit.logs.tables import joined
from rosetta_jit.startup.dataclass import replace

try:
    from dask.dataframe import from_map
except ImportError:
    raise MissingPackage("logs on Dask take its package: pip install 'rosetta-jit[dask]'") from None

if TYPE_CHECKING:
    from dask.dataframe import DataFrame

    from rosetta_jit.logs.moments import Moment

PARTITIONS = 8
"""How many there are at least, if nobody says, and the logs are large enough."""


def read_log(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    topic: str,
    *,
    mapping: str | os.PathLike[str] | None = None,
    columns: Iterable[str] | None = None,
    clocks: Iterable[str] = CLOCKS,
    start: Moment | None = None,
    end: Moment | None = None,
    flatten: bool = True,
    on_error: Literal["raise", "skip"] = "raise",
    on_missing: Literal["raise", "skip"] = "raise",
    npartitions: int = PARTITIONS,
    **options: Any,
) -> DataFrame:
    """The messages of a topic in some logs as a `dask.dataframe.DataFrame`, a row each.

    Parameters
    ----------
    paths
        Logs of any format, which all workers reach by these paths; with ``*`` for all that match.
    topic
        Whose messages. Its type must be the same in all logs.
    mapping
        A mapping that decodes them (``….mapping``), or the name of their type where the logs do not tell it.
    columns
        The fields to read, with dots those of nested messages; all by default. Those that the program does not use are not decoded.
    clocks
        Columns of times that come first: ``log_time``, ``publish_time``, ``header_time``.
    start, end
        From when on, and until before when: nanoseconds since 1970, a `datetime` or a `numpy.datetime64`.
    flatten
        Whether each field of a nested message is a column of its own, named with dots.
    on_error, on_missing
        What becomes of messages that cannot be decoded, and of logs without the topic: an error, or they are left out.
    npartitions
        How many partitions there are at least. If there are fewer logs, large ones become several.
    **options
        As of `rosetta_jit.open`: those of the decoder.

    Raises
    ------
    LogError, MappingError, SchemaError
        The first log cannot be opened, or its messages not be decoded.
    """
    found = paths_of(paths)
    reading = Reading.of(
        topic, mapping, columns, clocks, start, end, form={"flatten": flatten}, on_error=on_error, on_missing=on_missing, options=options
    )
    empty: Any = reading.schema(found).empty_table()
    shares = shares_of(found, reading, npartitions) or [Share(found[0], range(0))]
    return from_map(_Frame(reading, empty), shares, meta=empty.to_pandas(), label="read-log", enforce_metadata=False)


class _Frame:
    """What a task does: it travels to a worker as a recipe."""

    def __init__(self, reading: Reading, empty: Any) -> None:
        self._reading, self._empty = reading, empty

    def __call__(self, share: Share, columns: list[str] | None = None) -> Any:
        reading = self._reading
        if columns is not None:
            reading = replace(reading, names=tuple(columns))
        whole = joined(list(share.tables(reading)) or [self._empty])
        return (whole if columns is None else whole.select(list(columns))).to_pandas()

    def __dask_tokenize__(self) -> object:
        return type(self).__name__, repr(self._reading)
