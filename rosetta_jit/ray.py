"""Logs as a source of Ray Data: `read_log` gives a dataset, of which each task reads a log, or a stretch of a large one.

The schema is known before any message is read. Columns that the dataset does not use are not made, and chunks outside of the times by
which it is filtered are not read.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Literal

from rosetta_jit.errors import MissingPackage
from rosetta_jit.logs.decoded_parts import CLOCKS
from rosetta_jit.logs.moments import nanoseconds
from rosetta_jit.logs.shares import Reading, Share, paths_of, shares_of
from rosetta_jit.startup.dataclass import replace

try:
    from ray.data import Datasource, read_datasource
    from ray.data.block import BlockMetadata
    from ray.data.datasource import ReadTask
except ImportError:
    raise MissingPackage("logs on Ray take its package: pip install 'rosetta-jit[ray]'") from None

if TYPE_CHECKING:
    import pyarrow as pa
    from ray.data import Dataset
    from ray.data.expressions import Expr

    from rosetta_jit.logs.moments import Moment

GROWTH = 2
"""How much larger tables are than logs, as far as Ray wants to know before they are read."""

BOUNDS = {"ge": ("start", 0), "gt": ("start", 1), "lt": ("end", 0), "le": ("end", 1)}
"""Which bound of time a comparison with ``log_time`` is, and how far behind the value."""

MIRRORED = {"ge": "le", "gt": "lt", "lt": "gt", "le": "ge"}


def read_log(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    topic: str,
    *,
    mapping: str | os.PathLike[str] | None = None,
    columns: Iterable[str] | None = None,
    clocks: Iterable[str] = CLOCKS,
    start: Moment | None = None,
    end: Moment | None = None,
    flatten: bool = False,
    on_error: Literal["raise", "skip"] = "raise",
    on_missing: Literal["raise", "skip"] = "raise",
    override_num_blocks: int | None = None,
    concurrency: int | None = None,
    **options: Any,
) -> Dataset:
    """The messages of a topic in some logs as a `ray.data.Dataset`, a row each.

    Parameters
    ----------
    paths
        Logs of any format, which all workers reach by these paths; with ``*`` for all that match.
    topic
        Whose messages. Its type must be the same in all logs.
    mapping
        A mapping that decodes them (``….mapping``), or the name of their type where the logs do not tell it.
    columns
        The fields to read, with dots those of nested messages; all by default.
    clocks
        Columns of times that come first: ``log_time``, ``publish_time``, ``header_time``.
    start, end
        From when on, and until before when: nanoseconds since 1970, a `datetime` or a `numpy.datetime64`.
    flatten
        Whether each field of a nested message is a column of its own, named with dots.
    on_error, on_missing
        What becomes of messages that cannot be decoded, and of logs without the topic: an error, or they are left out.
    override_num_blocks
        How many tasks there are at least. If there are fewer logs, large ones are read by several.
    concurrency
        How many tasks may run at once.
    **options
        As of `rosetta_jit.open`: those of the decoder.

    Raises
    ------
    LogError, MappingError, SchemaError
        The first log cannot be opened, or its messages not be decoded.
    """
    reading = Reading.of(
        topic, mapping, columns, clocks, start, end, form={"flatten": flatten}, on_error=on_error, on_missing=on_missing, options=options
    )
    return read_datasource(LogDatasource(paths_of(paths), reading), override_num_blocks=override_num_blocks, concurrency=concurrency)


class LogDatasource(Datasource):
    """The messages of a topic in some logs, as Ray Data reads them."""

    def __init__(self, paths: Sequence[str], reading: Reading) -> None:
        super().__init__()
        self._paths, self._reading = list(paths), reading
        self._schema = reading.schema(self._paths)
        self._projection_map: dict[str, str] | None = None

    def get_name(self) -> str:
        return "Log"

    def estimate_inmemory_data_size(self) -> int | None:
        """Ray asks for it to choose a number of tasks; the files' sizes tell, where they are local."""
        from pathlib import Path

        sizes = [Path(each).stat().st_size for each in self._paths if "://" not in each and Path(each).is_file()]
        return GROWTH * sum(sizes) * len(self._paths) // len(sizes) if sizes else None

    def supports_projection_pushdown(self) -> bool:
        return True

    def supports_predicate_pushdown(self) -> bool:
        return True

    def get_read_tasks(self, parallelism: int, per_task_row_limit: int | None = None, data_context: object = None) -> list[ReadTask]:
        """One task a share of the logs."""
        del data_context
        names, predicate = self._get_data_columns(), self.get_current_predicate()
        reading = _bounded(self._reading, predicate)
        schema = self._schema if names is None else self._schema.empty_table().select(names).schema
        tasks: list[ReadTask] = []
        for share in shares_of(self._paths, reading, parallelism):
            rows = None if predicate is not None else share.rows
            size = None if share.size is None else GROWTH * share.size
            about = BlockMetadata(num_rows=rows, size_bytes=size, exec_stats=None, input_files=(share.path,))
            tasks.append(ReadTask(_Read(share, reading, names, predicate), about, schema, per_task_row_limit))
        return tasks


class _Read:
    """What a task does: it travels to a worker as the recipe of its share."""

    def __init__(self, share: Share, reading: Reading, names: list[str] | None, predicate: Expr | None) -> None:
        self._share, self._reading, self._names, self._predicate = share, reading, names, predicate

    def __call__(self) -> Iterator[pa.Table]:
        names, predicate, reading = self._names, self._predicate, self._reading
        if names is not None:
            needed = [*names, *([] if predicate is None else _columns(predicate))]
            reading = replace(reading, names=tuple(dict.fromkeys(needed or ["log_time"])))
        for table in self._share.tables(reading):
            kept: Any = table if predicate is None else table.filter(predicate.to_pyarrow())
            yield kept if not names else kept.select(names)


def _columns(predicate: Any) -> list[str]:
    """The columns that a predicate reads."""
    if hasattr(predicate, "left"):
        return [*_columns(predicate.left), *_columns(predicate.right)]
    if hasattr(predicate, "operand"):
        return _columns(predicate.operand)
    return [predicate.name] if type(predicate).__name__ == "ColumnExpr" else []


def _bounded(reading: Reading, predicate: Any) -> Reading:
    """What is read if rows must fulfil a predicate: no chunks outside of the times that it allows."""
    if type(predicate).__name__ != "BinaryExpr":
        return reading
    if predicate.op.value == "and":
        return _bounded(_bounded(reading, predicate.left), predicate.right)
    left, right, word = predicate.left, predicate.right, predicate.op.value
    if type(left).__name__ == "LiteralExpr":
        left, right, word = right, left, MIRRORED.get(word, word)
    if word not in BOUNDS or getattr(left, "name", "") != "log_time" or type(right).__name__ != "LiteralExpr":
        return reading
    which, behind = BOUNDS[word]
    try:
        moment = (nanoseconds(right.value) or 0) + behind
    except TypeError:
        return reading
    if which == "start":
        return replace(reading, start_ns=moment if reading.start_ns is None else max(moment, reading.start_ns))
    return replace(reading, end_ns=moment if reading.end_ns is None else min(moment, reading.end_ns))
