"""Play all recordings through their decoders, time them against a dynamic decode of the same bytes, and draw what came out."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np
from tqdm import tqdm

import rosetta_jit
from rosetta_jit.demo.start import start_key, start_times_ms
from rosetta_jit.demo.streams import Stream, load_streams
from rosetta_jit.frameworks.yarp.bottle import read
from rosetta_jit.frameworks.yarp.tags import DIALECTS
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.demo.pictures import Angles, RstImage
    from rosetta_jit.runtime.holder import Holder


DRAWN_JOINTS, DRAWN_FRAME = "left_arm_state", "cam_left"
ROUNDS = 5


class JointAngles(Protocol):
    """What is drawn of an `rst.kinematics.JointAngles`."""

    angles: Angles


@dataclass(frozen=True, slots=True)
class Played:
    """The figures of one stream."""

    stream: Stream
    message_ns: float
    dynamic_ns: float
    cold_ms: float
    warm_ms: float


@dataclass(frozen=True, slots=True)
class Report:
    """What the demo has to show."""

    played: tuple[Played, ...]
    pictures: tuple[Path, ...]


def play(output: Path) -> Report:
    """Decode everything, with a progress bar; the pictures go to ``output``."""
    streams = load_streams()
    cold, warm = start_times_ms()
    played: list[Played] = []
    pictures: list[Path] = []
    output.mkdir(parents=True, exist_ok=True)
    with tqdm(total=sum(len(stream.messages) for stream in streams), unit=" messages", desc="decoding") as progress:
        for stream in streams:
            decode = rosetta_jit.Decoder(stream.mapping, encoding=stream.dialect)
            pictures += _draw(stream, decode, output, progress.update)
            key = start_key(stream.mapping, stream.dialect)
            played.append(Played(stream, _best_ns(decode, stream), _best_ns(dynamic_reader(stream.dialect), stream), cold[key], warm[key]))
    return Report(tuple(played), tuple(pictures))


def _draw(stream: Stream, decode: Callable[[bytes], Holder], output: Path, advance: Callable[[], object]) -> list[Path]:
    """Decode a stream once, and draw it if it is one of those that are drawn."""
    from rosetta_jit.demo.pictures import draw_frame, draw_joints

    rows: list[Angles] = []
    for message in stream.messages:
        holder = decode(message.data)
        if stream.name == DRAWN_JOINTS:
            rows.append(np.array(cast("JointAngles", holder).angles))
        advance()
    match stream.name:
        case name if name == DRAWN_JOINTS:
            times = [message.time_s - stream.messages[0].time_s for message in stream.messages]
            return [draw_joints(times, np.stack(rows), output / f"{stream.dialect}-{name}.png")]
        case name if name == DRAWN_FRAME:
            return [draw_frame(cast("RstImage", decode(stream.messages[0].data)), output / f"{stream.dialect}-{name}.png")]
        case _:
            return []


def _best_ns(decode: Callable[[bytes], object], stream: Stream) -> float:
    """The best of a few rounds through all messages, in nanoseconds a message."""
    messages = [message.data for message in stream.messages]
    best = float("inf")
    for _ in range(ROUNDS):
        started = time.perf_counter_ns()
        for message in messages:
            decode(message)
        best = min(best, (time.perf_counter_ns() - started) / len(messages))
    return best


def dynamic_reader(dialect: str) -> Callable[[bytes], object]:
    """A function from a message of that dialect to its tree."""
    tags = DIALECTS[dialect]
    return lambda message: read(message, tags)


HEADINGS = ("recording", "dialect", "messages", "bytes", "ns a message", "dynamic ns", "ratio", "cold ms", "warm ms")


def table(report: Report) -> str:
    """One line a recording; cold is a first compile, warm a load from the cache in a fresh process."""
    rows = [HEADINGS, *(_cells(played) for played in report.played)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEADINGS))]
    lines = ["  ".join(_padded(cell, width, column) for column, (cell, width) in enumerate(zip(row, widths, strict=True))) for row in rows]
    return "\n".join([lines[0], "-" * len(lines[0]), *lines[1:]])


def _cells(played: Played) -> tuple[str, ...]:
    stream = played.stream
    return (
        stream.name,
        stream.dialect,
        f"{len(stream.messages):,}",
        f"{stream.size_bytes:,}",
        f"{played.message_ns:,.0f}",
        f"{played.dynamic_ns:,.0f}",
        f"{played.dynamic_ns / played.message_ns:,.0f} x",
        f"{played.cold_ms:.1f}",
        f"{played.warm_ms:.1f}",
    )


def _padded(cell: str, width: int, column: int) -> str:
    return cell.ljust(width) if column < 2 else cell.rjust(width)
