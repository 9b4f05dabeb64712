"""Messages of several topics as one: what a mapping of several wires makes of them, in the order in which they came."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import DecodeError, LogError
from rosetta_jit.logs.moments import shown

if TYPE_CHECKING:
    from rosetta_jit.api.wires import Decoders


class Joined(NamedTuple):
    """The holder as it is behind a message.

    Attributes
    ----------
    time : int
        When the message was logged, in nanoseconds since 1970.
    wire : str
        Whose message it was.
    holder : Holder
        The same one each time, filled further.
    ages : dict of str to int
        How many nanoseconds before that the last message of each wire was logged.
    """

    time: int
    wire: str
    holder: Any
    ages: dict[str, int]


def check_topics(log: str, wires: Iterable[str], topics: Mapping[str, str]) -> None:
    """That each wire has a topic. Raises `LogError`."""
    missing = [wire for wire in wires if wire not in topics]
    if missing:
        raise LogError((words.wire_without_topic(log, missing[0]),))


Raw = tuple[int, str, bytes]
"""When a message was logged, its topic, its bytes."""


def joined(
    messages: Iterable[Raw], decoders: Decoders, topics: Mapping[str, str], on: str | None, on_error: Literal["raise", "skip"]
) -> Iterator[Joined]:
    """The holder behind each message, or each of one wire, once it is complete; ``topics`` are those of the wires."""
    wires: dict[str, list[str]] = {}
    for wire, topic in topics.items():
        wires.setdefault(topic, []).append(wire)
    times: dict[str, int] = {}
    missing = set(topics)
    for time, topic, data in messages:
        for wire in wires[topic]:
            try:
                holder = decoders[wire](data)
            except DecodeError as error:
                if on_error == "raise":
                    detail = f"{error.detail} (a message of {topic}, logged {shown(time)})"
                    raise DecodeError(error.kind, error.path, detail, error.offset) from None
                missing.add(wire)
                continue
            missing.discard(wire)
            times[wire] = time
            if not missing and on in (None, wire):
                yield Joined(time, wire, holder, {each: time - last for each, last in times.items()})
