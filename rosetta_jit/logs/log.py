"""An open log: its channels, what is wrong with it, and its messages in the order in which they came."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Unpack, cast

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.diagnostics import Diagnostic, render
from rosetta_jit.errors import LogError, LogWarning, MappingError, warn
from rosetta_jit.logs.base import Block, Connection, Format, Wanted
from rosetta_jit.logs.channel import Channel
from rosetta_jit.logs.decoded_parts import OnError
from rosetta_jit.logs.file import LogFile
from rosetta_jit.logs.installed import formats
from rosetta_jit.logs.moments import Moment, nanoseconds, shown
from rosetta_jit.logs.reading.storage import Storage, open_storage

if TYPE_CHECKING:
    from rosetta_jit.api.options import Options
    from rosetta_jit.api.wires import WireOptions
    from rosetta_jit.logs.joining import Joined

MAGIC_BYTES = 64


class Message(NamedTuple):
    """A message of a log: when it was logged, in nanoseconds since 1970, on which topic, and its holder or its bytes."""

    time: int
    topic: str
    message: Any


class Log(LogFile):
    """A log, of which nothing but the index is read when it is opened.

    ``log["/imu"]`` is a `Channel`; so are ``log["/imu", "robot/imu.mapping"]``, through a mapping, and ``log["POSE", "exlcm.pose_t"]``, of
    a type that the log does not tell. Iterating gives the topics.

    Attributes
    ----------
    name : str
    format : str
        ``mcap``, ``bag``, ``lcm``, …
    problems : list of Diagnostic
        What has been noticed to be wrong with the file so far.
    """

    @property
    def channels(self) -> tuple[Channel, ...]:
        """All channels, sorted by topic; of a topic with several types there are several."""
        found: dict[tuple[str, ...], list[Connection]] = {}
        for each in sorted(self.connections, key=lambda one: (one.topic, one.type)):
            found.setdefault((each.topic, *_type_key(each)), []).append(each)
        return tuple(Channel(self, tuple(each), None, self._options) for each in found.values())

    def __iter__(self) -> Iterator[str]:
        return iter(self.topics)

    def __contains__(self, topic: object) -> bool:
        return topic in self.topics

    def __len__(self) -> int:
        return len(self.topics)

    def __getitem__(self, key: str | tuple[str, str | os.PathLike[str]]) -> Channel:
        topic, target = (key, None) if isinstance(key, str) else (key[0], str(key[1]))
        return self.channel(topic, target)

    def channel(self, topic: str, target: str | None = None, **options: Unpack[Options]) -> Channel:
        """The messages of a topic.

        Parameters
        ----------
        topic
            Its name.
        target
            A mapping (``….mapping``), or the name of the messages' type where the log does not tell it or has several.
        **options
            Of the decoder: see `Options`.

        Raises
        ------
        LogError
            There is no such topic, or it has messages of several types.
        """
        found = [each for each in self.connections if each.topic == topic]
        if not found:
            raise LogError((words.unknown_topic(self.name, topic, self.topics),))
        named = [each for each in found if target is not None and each.type == target] or found
        if len({_type_key(each) for each in named}) > 1:
            types = sorted({each.type for each in named})
            if len(types) == 1:
                raise LogError((words.several_definitions(self.name, topic, types[0]),))
            raise LogError((words.several_types(self.name, topic, types),))
        return Channel(self, tuple(named), target, cast("Options", {**self._options, **options}))

    def messages(
        self,
        topics: Iterable[str | Channel] | None = None,
        *,
        start: Moment | None = None,
        end: Moment | None = None,
        raw: bool = False,
        on_error: Literal["raise", "skip"] = "raise",
    ) -> Iterator[Message]:
        """The messages in the order of the file; within a chunk by the time at which they were logged.

        Parameters
        ----------
        topics
            Those to read, or channels of this log, which may be through mappings; all by default.
        start, end
            From when on, and until before when: nanoseconds since 1970, a `datetime` or a `numpy.datetime64`.
        raw
            Bytes instead of decoded messages.
        on_error
            What becomes of messages that their type does not allow.

        Raises
        ------
        DecodeError
            A message is not what its type promises.
        LogError
            A topic is not there, or its type is not known.
        """
        channels = [self[each] if isinstance(each, str) else each for each in topics] if topics is not None else list(self.channels)
        by_number = {each.number: channel for channel in channels for each in channel.connections}
        numbers = frozenset(by_number) if topics is not None else None
        for block in self.blocks(Wanted(numbers, nanoseconds(start), nanoseconds(end))):
            if topics is None:
                by_number |= self._later(by_number)
                self._tell_unknown(block, by_number)
            order = np.argsort(block.rows.log_ns, kind="stable")
            found = _decoded(block, by_number, on_error) if not raw else _bytes(block)
            for row in order.tolist():
                if row in found and int(block.rows.channels[row]) in by_number:
                    yield Message(int(block.rows.log_ns[row]), by_number[int(block.rows.channels[row])].topic, found[row])

    def joined(
        self,
        mapping: str | os.PathLike[str],
        topics: Mapping[str, str],
        *,
        on: str | None = None,
        start: Moment | None = None,
        end: Moment | None = None,
        on_error: Literal["raise", "skip"] = "raise",
        **options: Unpack[WireOptions],
    ) -> Iterator[Joined]:
        """Messages of several topics in one holder, by a mapping of several wires: the holder behind each message, once it is complete.

        Parameters
        ----------
        mapping
            One of several wires: see `rosetta_jit.Decoders`.
        topics
            The topic of each wire.
        on
            The wire behind whose messages the holder is given; by default behind all.
        start, end
            As of `messages`.
        on_error
            What becomes of messages that their wire does not allow; skipped, nothing is given until the next one of the wire.
        **options
            Of the decoders: see `rosetta_jit.api.wires.WireOptions`. The encodings are those of the log.

        Raises
        ------
        DecodeError
            A message is not what its type promises.
        LogError
            A topic is not there, or a wire has none.
        MappingError, SchemaError
            The mapping is wrong, or has no such wire.
        """
        from rosetta_jit.api.wires import Decoders
        from rosetta_jit.catalogue.wires import unknown as unknown_wire
        from rosetta_jit.logs.joining import check_topics, joined

        channels = {wire: self.channel(topic) for wire, topic in topics.items()}
        encodings = {wire: channel.encoding for wire, channel in channels.items()} | dict(options.pop("encodings", {}))
        decoders = Decoders(mapping, encodings=encodings, **cast("Options", {**self._options, **options}))
        check_topics(self.name, decoders, topics)
        if on is not None and on not in decoders:
            raise MappingError((unknown_wire(None, on, list(decoders)),))
        messages = self.messages(dict.fromkeys(topics.values()), start=start, end=end, raw=True)
        return joined(messages, decoders, topics, on, on_error)

    def _later(self, known: dict[int, Channel]) -> dict[int, Channel]:
        """Channels that were defined behind the index, or without one."""
        if all(each.number in known for each in self.connections):
            return {}
        return {each.number: channel for channel in self.channels for each in channel.connections if each.number not in known}

    def _tell_unknown(self, block: Block, known: dict[int, Channel]) -> None:
        """Say which channels have messages, but no definition."""
        for number in np.unique(block.rows.channels).tolist():
            if number not in known:
                self._tell(words.unknown_channel(self.name, number))

    def __reduce__(self) -> tuple[Any, ...]:
        """By its name: whoever unpickles it opens the file. Problems are then warnings, whoever was told of them before."""
        if self.name == "-":
            raise TypeError("standard input cannot be opened a second time: no other process can read this log")
        return _reopened, (self.name, self.format, self._check, self._options)

    def __repr__(self) -> str:
        """The topics with their types and counts, and the time from the first message to the last."""
        times = "" if self.start is None or self.end is None else f", {shown(self.start)} to {shown(self.end)}"
        lines = [f"  {each.topic}  {each.type or '?'}  {'?' if each.count is None else each.count}" for each in self.channels]
        return "\n".join([f"<Log {self.name} ({self.format}){times}>", *lines])


def _type_key(connection: Connection) -> tuple[str, ...]:
    """What tells one type from another: of ROS 1 the md5 sum, because the texts of definitions differ in comments."""
    sum_ = connection.details.get("md5sum", "")
    return connection.type, connection.encoding, sum_ or connection.schema.hex()


def _decoded(block: Block, channels: dict[int, Channel], on_error: OnError) -> dict[int, Any]:
    """The messages of a block by their rows, each channel's in a batch of its own."""
    found: dict[int, Any] = {}
    for channel in set(channels.values()):
        chosen = np.flatnonzero(block.rows.are_of(channel.numbers))
        if len(chosen):
            batch = channel.decoded(block, block.rows.only(chosen), on_error)
            found |= dict(zip(chosen[batch.kept].tolist(), batch, strict=True))
    return found


def _bytes(block: Block) -> dict[int, bytes]:
    view = block.data.data
    return {
        row: bytes(view[begin:end])
        for row, (begin, end) in enumerate(zip(block.rows.begins.tolist(), block.rows.ends.tolist(), strict=True))
    }


def open_log(
    path: str | os.PathLike[str],
    *,
    format: str | None = None,  # noqa: A002 - what else should it be called
    check: bool = True,
    on_problem: Callable[[Diagnostic], object] | None = None,
    **options: Unpack[Options],
) -> Log:
    """Open a log: see `rosetta_jit.open`."""
    if not isinstance(path, str | os.PathLike):  # pyright: ignore[reportUnnecessaryIsInstance] - what users give
        raise TypeError(
            f"a log is opened by its path or its address, not by an object of the type {type(path).__name__}; one in memory is written to "
            "a file first, or to fsspec's memory://"
        )
    storage = open_storage(os.fspath(path))
    try:
        return Log(storage, format_of(storage, format), on_problem or _warn, check=check, options=options)
    except BaseException:
        storage.close()
        raise


def _reopened(name: str, form: str, check: bool, options: Options) -> Log:
    return open_log(name, format=form, check=check, **options)


def format_of(storage: Storage, wanted: str | None = None) -> Format:
    """The format of a log: the one that is named, else by how it begins, else by its name.

    Raises
    ------
    LogError
        It is none that is known.
    """
    known, name = formats(), storage.name
    if storage.is_unpacked:  # drive.bag.gz
        name = name.rpartition(".")[0]
    if wanted is not None:
        if wanted not in known:
            raise LogError((words.unknown_format(f"`{wanted}`", known),))
        return known[wanted]
    if storage.is_folder:
        found = [each for each in known.values() if each.is_folder(storage.path)]
    else:
        begin = storage.read(0, MAGIC_BYTES)
        found = [each for each in known.values() if each.magic and begin.startswith(each.magic)]
        found += [each for each in known.values() if name.endswith(each.suffixes) and not each.folder]
    if not found:
        raise LogError((words.unknown_format(name, known),))
    return found[0]


def _warn(problem: Diagnostic) -> None:
    warn(render(problem), LogWarning)
