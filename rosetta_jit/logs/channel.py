"""The messages of one topic: columns and tables of them, read when they are asked for, a few megabytes at a time."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import DecodeError, LogError, SchemaError
from rosetta_jit.logs.base import Block, Connection, Wanted
from rosetta_jit.logs.decoded_parts import CLOCKS, Collector, OnError, Part, nothing
from rosetta_jit.logs.moments import nanoseconds, shown
from rosetta_jit.runtime.batches.transposing import prepare
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    import pyarrow as pa
    from numpy.typing import NDArray

    from rosetta_jit.api.bridges import Bridge
    from rosetta_jit.api.decoder import Decoder
    from rosetta_jit.api.encoder import Encoder
    from rosetta_jit.api.options import Options
    from rosetta_jit.logs.file import LogFile
    from rosetta_jit.logs.moments import Moment
    from rosetta_jit.logs.reading.walking import Rows
    from rosetta_jit.runtime.batches.batch import Batch

    Program = TypeVar("Program", bound=Decoder | Encoder)

MOST_OF_EMPTY = 8
"""Bytes that a message without fields takes at most: in CDR the header, one byte, and three that fill up the last four."""


class Channel:
    """The messages of a topic, lazy: nothing is read before a column, a table or a message is asked for.

    Attributes
    ----------
    topic, type, encoding : str
    schema : str or bytes
        The definition that the log has: a text, or a serialised ``FileDescriptorSet``; empty without one.
    """

    def __init__(self, log: LogFile, connections: tuple[Connection, ...], target: str | None, options: Options) -> None:
        self._log, self._target, self._options = log, target, options
        self.connections = connections
        self._spare = list["Batch"]()

    @property
    def topic(self) -> str:
        return self.connections[0].topic

    @property
    def type(self) -> str:
        return self.connections[0].type

    @property
    def encoding(self) -> str:
        return self.connections[0].encoding

    @property
    def schema_encoding(self) -> str:
        """Which language ``schema`` is in: ``ros1msg``, ``ros2msg``, ``ros2idl``, ``protobuf``."""
        return self.connections[0].schema_encoding

    @property
    def schema(self) -> str | bytes:
        schema = self.connections[0].schema
        return schema if self.schema_encoding == "protobuf" else schema.decode("utf-8", "replace")

    @property
    def log(self) -> LogFile:
        """The log that it is of."""
        return self._log

    @property
    def target(self) -> str | None:
        """The mapping, or the type, that was named."""
        return self._target

    @property
    def count(self) -> int | None:
        """How many messages there are, by the index of the log; None where only reading all would tell."""
        counts = [each.count for each in self.connections]
        return None if None in counts else sum(cast("list[int]", counts))

    @cached_property
    def decoder(self) -> Decoder:
        """What decodes the messages; raises as `program` does."""
        from rosetta_jit.api.decoder import Decoder

        return self.program(Decoder)

    def program(self, kind: type[Program]) -> Program:
        """A decoder of the messages, or an encoder of more of them.

        Raises
        ------
        LogError
            The log does not tell the type, and nobody has named it; it is defined nowhere; or no framework has the encoding.
        SchemaError, MappingError
            The definition, or the mapping, is wrong.
        """
        connection = self.connections[0]
        if connection.schema_encoding and not connection.schema.strip() and self._has_content():
            connection = replace(connection, schema_encoding="", schema=b"")
        name, chosen = _type_and_options(self._log, connection, self._target, self._options)
        if name == self._target and name.endswith(".mapping"):
            return kind(name, **chosen)
        try:
            return kind.of(name, **chosen)
        except SchemaError as error:
            if self._target is None and not connection.schema and error.diagnostics[0].code == "unknown-type":
                raise LogError((words.no_definition(self._log.name, self.topic, name),)) from None
            raise

    def _has_content(self) -> bool:
        """Whether the first message is longer than one without fields: then an empty definition is none."""
        block = next(self._blocks(), None)
        return block is not None and int(block.rows.ends[0] - block.rows.begins[0]) > MOST_OF_EMPTY

    def parts(
        self, *, start: Moment | None = None, end: Moment | None = None, pieces: range | None = None, on_error: OnError = "raise"
    ) -> Iterator[Part]:
        """The messages, decoded some megabytes at a time into one batch that is filled again and again. State begins anew."""
        yield from self._parts(self._wanted(start, end, pieces), on_error)

    def _parts(self, wanted: Wanted, on_error: OnError, batch: Batch | None = None) -> Iterator[Part]:
        self.decoder.reset()
        yield from Collector(self.decoder, on_error, expected=self.count, batch=batch).parts(self._log.blocks_ahead(wanted))

    def _parts_of_tables(self, wanted: Wanted, on_error: OnError) -> Iterator[Part]:
        """The same for who keeps only tables. The batch is kept for the next time: fresh memory costs more than filling it."""
        try:
            batch = self._spare.pop()
        except IndexError:  # there was none, or another thread has it
            batch = None
        for part in self._parts(wanted, on_error, batch):
            batch = part.batch
            yield part
        self._spare[:] = () if batch is None else (batch,)

    def decoded(self, block: Block, rows: Rows, on_error: OnError = "raise") -> Batch:
        """Messages of a block, in a batch of their own; an error says of which topic and time the message is."""
        with self._named(rows):
            return self.decoder.many(block.data.data, np.stack([rows.begins, rows.ends]), on_error=on_error)

    def bridge_to(self, type_: str, encode: Options) -> Bridge:
        """What turns the messages into those of another type, which has the same fields (`rosetta_jit.api.bridges.Bridge.of`)."""
        from rosetta_jit.api.bridges import Bridge

        own, options = _type_and_options(self._log, self.connections[0], None, self._options)
        return Bridge.of(own, type_, decode=cast("Options", options), encode=encode)

    def bridged(self, block: Block, rows: Rows, bridge: Bridge) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
        """What messages of a block become, and where each of them begins; an error says of which topic and time the message is."""
        with self._named(rows):
            return bridge.many(block.data.data, np.stack([rows.begins, rows.ends]))

    @contextmanager
    def _named(self, rows: Rows) -> Generator[None]:
        """Around what is done with messages by their numbers among some rows."""
        try:
            yield
        except DecodeError as error:
            number, _, path = error.path.removeprefix("[").partition("]")
            when = shown(int(rows.log_ns[int(number)]))
            raise DecodeError(error.kind, path, f"{error.detail} (a message of {self.topic}, logged {when})", error.offset) from None

    def _blocks(self) -> Iterator[Block]:
        return self._log.blocks(self._wanted(None, None, None))

    def _wanted(self, start: Moment | None, end: Moment | None, pieces: range | None) -> Wanted:
        return Wanted(self.numbers, nanoseconds(start), nanoseconds(end), pieces)

    @property
    def numbers(self) -> frozenset[int]:
        """The numbers of its connections."""
        return frozenset(each.number for each in self.connections)

    def __iter__(self) -> Iterator[Any]:
        """The messages, each a holder of its own."""
        for block in self._blocks():
            batch = list(self.decoded(block, block.rows))
            yield from (batch[row] for row in np.argsort(block.rows.log_ns, kind="stable").tolist())

    def __len__(self) -> int:
        return self.count if self.count is not None else sum(len(each.rows) for each in self._blocks())

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A field of all messages as an array, ``imu["angular_velocity.x"]``; the times as ``["log_time"]``, ``["publish_time"]``.

        Numbers, arrays of one length, and texts, as `str`.

        Raises
        ------
        KeyError
            There is no such field.
        TypeError, ValueError
            The field is a message, or an array of several lengths: take `to_arrow`.
        """
        if name in CLOCKS:
            stamps = [each.rows.log_ns if name == "log_time" else each.rows.publish_ns for each in self._blocks()]
            return (np.concatenate(stamps) if stamps else np.empty(0, np.int64)).view("datetime64[ns]")
        found: list[Any] = []
        for part in self.parts():
            column = part.batch.column(name)
            found.append(column.to_numpy() if hasattr(column, "to_numpy") else column)
            if not isinstance(found[-1], np.ndarray):
                raise TypeError(f"{name!r} has no single array: name a field in it, or take to_arrow(columns=[{name!r}])")
            found[-1] = found[-1].copy()
        return np.concatenate(found) if found else np.empty(0)

    def tables(self, columns: Iterable[str] | None = None, **options: Any) -> Iterator[pa.Table]:
        """The tables of `to_arrow` one by one, for logs that are larger than the memory; at least one, if only for its schema."""
        return (table for _, table in self.tables_of_parts(columns, **options))

    def tables_of_parts(
        self,
        columns: Iterable[str] | None = None,
        *,
        clocks: Iterable[str] = CLOCKS,
        start: Moment | None = None,
        end: Moment | None = None,
        pieces: range | None = None,
        on_error: OnError = "raise",
        **form: Any,
    ) -> Iterator[tuple[Part, pa.Table]]:
        """The same with the messages that each table is of, which are not to be written to: the table has taken their large arrays."""
        from rosetta_jit.logs.tables import table_of

        if isinstance(columns, str):
            raise TypeError(f"columns is a list of names: columns=[{columns!r}]")
        prepare(self.count or 0)
        names, chosen, is_any = None if columns is None else list(columns), tuple(clocks), False
        for part in self._parts_of_tables(self._wanted(start, end, pieces), on_error):
            yield part, table_of(part, names, chosen, form)
            is_any = True
        if not is_any:
            empty = nothing(self.decoder)
            yield empty, table_of(empty, names, chosen, form)

    def to_arrow(self, columns: Iterable[str] | None = None, **options: Any) -> pa.Table:
        """The messages as a `pyarrow.Table`, a row each.

        Parameters
        ----------
        columns
            The fields to take, with dots those of nested messages; all by default.
        flatten, octets, times, errors
            As of `Batch.to_arrow`.
        clocks
            Columns of times that come first: ``log_time``, ``publish_time``, and ``header_time`` where messages have a ``header.stamp``.
        start, end
            From when on, and until before when: nanoseconds since 1970, a `datetime` or a `numpy.datetime64`.
        pieces
            The places of those of the log's pieces (`Log.pieces`) that are read: ``range(0, 10)``; all by default.
        on_error
            As of `Decoder.many`.

        Raises
        ------
        ImportError
            pyarrow is not installed.
        DecodeError
            A message is not what its type promises.
        LogError
            The log does not tell the type.
        """
        from rosetta_jit.logs.tables import joined

        return joined(self.tables(columns, **options))

    def to_pandas(self, columns: Iterable[str] | None = None, **options: Any) -> Any:
        """The table of `to_arrow` as a `pandas.DataFrame`."""
        return self.to_arrow(columns, **options).to_pandas()

    def to_polars(self, columns: Iterable[str] | None = None, **options: Any) -> Any:
        """The table of `to_arrow` as a `polars.DataFrame`."""
        import polars as pl

        return pl.from_arrow(self.to_arrow(columns, **options))

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """For whoever reads Arrow's stream interface: pyarrow, polars, DuckDB."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def __reduce__(self) -> tuple[Any, ...]:
        """By the log, which is opened anew, and the numbers of the connections in it."""
        return _channel_of, (self._log, self.numbers, self._target, self._options)

    def __repr__(self) -> str:
        through = f" through {self._target}" if self._target else ""
        return f"<Channel {self.topic} of {self.type or '?'}{through}, {'?' if self.count is None else self.count} messages>"


def _channel_of(log: LogFile, numbers: frozenset[int], target: str | None, options: Options) -> Channel:
    return Channel(log, tuple(each for each in log.connections if each.number in numbers), target, options)


def _type_and_options(log: LogFile, connection: Connection, target: str | None, options: Options) -> tuple[str, dict[str, Any]]:
    """The mapping or type of a decoder, and the options that it is made with."""
    from rosetta_jit.frameworks.installed import installed

    frameworks = {name: framework for framework in installed().values() for name in framework.encodings}
    chosen = dict[str, Any](options)
    if connection.encoding not in frameworks and "encoding" not in chosen:
        raise LogError((words.unknown_encoding(log.name, connection.topic, connection.encoding),))
    chosen.setdefault("encoding", connection.encoding)
    if target is not None and target.endswith(".mapping"):
        return target, chosen
    type_ = target or connection.type
    if not type_ and "fingerprint" in connection.details:
        type_, chosen["imports"] = _of_fingerprint(connection, chosen)
    if not type_:
        details = "".join(f" ({name} {text})" for name, text in connection.details.items())
        can_be_drafted = connection.encoding in frameworks and bool(frameworks[connection.encoding].infer)
        raise LogError((words.no_type(log.name, connection.topic, details, can_be_drafted=can_be_drafted),))
    if connection.schema_encoding and type_ == connection.type and "schema" not in chosen:
        chosen.pop("imports", None)  # they are for types that the log does not define
        chosen["schema"] = connection.schema if connection.schema_encoding == "protobuf" else connection.schema.decode("utf-8", "replace")
    return type_, chosen


def _of_fingerprint(connection: Connection, options: dict[str, Any]) -> tuple[str, tuple[str, ...]]:
    """The type of LCM's messages, and the files that declare it: those that are named, or one on the search path; empty if none does."""
    from rosetta_jit.catalogue.pipeline import no_such_file
    from rosetta_jit.frameworks.lcm.idl import files_in, type_of
    from rosetta_jit.parsing.search import Reading, SearchPath

    search, imports = SearchPath.of(options.get("search_path", ())), tuple(map(str, options.get("imports", ())))
    for name in imports or files_in(search.folders):
        source = search.named(name) if imports else search.find(name)
        if source is None and imports:
            raise SchemaError((no_such_file(name, tuple(map(str, search.folders))),))
        found = source and type_of(int(connection.details["fingerprint"], 16), source, search.loader(Reading(), source))
        if found:
            return found, imports or (name,)
    return "", imports
