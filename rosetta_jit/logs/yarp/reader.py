"""Opening folders of `yarpdatadumper`: of each port `data.log`, a line a message, and `info.log`, which says what the lines are.

    line    = number, time, [time], content        number: the envelope's counter, -1 without an envelope
    content = the text of a bottle, or the name of an image's file and its pixels: `00000007.ppm [rgb]`, or of a video's frame

Opening reads the lines up to their content, and no images.

Bottles come out as YARP 3 writes them. The text has lost the widths of integers, and that a float had 32 bits.
"""

from __future__ import annotations

import re
from decimal import Decimal
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import EncodeError, LogError
from rosetta_jit.frameworks.yarp import bottle
from rosetta_jit.frameworks.yarp.tags import DIALECTS
from rosetta_jit.frameworks.yarp.text import parse_text
from rosetta_jit.logs.base import Block, Connection, Extent, Piece, Wanted, widened
from rosetta_jit.logs.limits import MAX_INFO_BYTES, MAX_LINE_BYTES
from rosetta_jit.logs.reading.blocks import blocks_of
from rosetta_jit.logs.yarp.images import image_message, type_of_images
from rosetta_jit.logs.yarp.videos import Frames, VideoError
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.logs.reading.storage import Storage

DIALECT = DIALECTS["yarp3"]
TIME = re.compile(rb"-?\d{1,10}(\.\d{0,9})?")
"""Seconds: an exponent, or more digits, might become a number without an end, and is nothing that YARP writes."""

END_NS = 1 << 63
"""From here on, in 2262, nanoseconds have more than 64 bits."""

PATH_BYTES = 4096


@dataclass(frozen=True, slots=True)
class Port:
    """The folder of one port: its name, whether it has images, and which times its lines have."""

    folder: Path
    name: str
    kind: str
    stamps: str
    type: str

    def times(self, number: int) -> int:
        """How many columns of times a line has: `--txTime` without an envelope writes both."""
        if self.stamps == "tx+rx" or (self.stamps == "tx" and number < 0):
            return 2
        return 1


@dataclass(frozen=True, slots=True)
class Line:
    """A line that is whole, where it begins, and the content that it names or has."""

    at: int
    log_ns: int
    publish_ns: int
    content: bytes


class DumperReader:
    """Open folders of `yarpdatadumper`: one, or one a port in a folder around them."""

    def __init__(self, storage: Storage, tell: Callable[[Diagnostic], None], *, check: bool) -> None:
        del check  # it has no checksums
        self._tell = tell
        root = storage.path
        folders = [root] if (root / "data.log").is_file() else sorted(each.parent for each in root.glob("*/data.log"))
        if not folders:
            raise LogError((words.not_a(storage.name, "folder of yarpdatadumper: it has no data.log"),))
        self._ports = [_port(folder, tell) for folder in folders]
        self.extent: Extent | None = None
        self.facts, self.pieces = {"ports": str(len(self._ports))}, (Piece(0),)
        self._counts, self._unreadable = [0] * len(self._ports), set[tuple[int, int]]()
        for number, port in enumerate(self._ports):
            for line in self._lines(port):
                self._counts[number] += 1
                self.extent = widened(self.extent, line.log_ns, line.log_ns)

    @property
    def connections(self) -> Mapping[int, Connection]:
        unreadable = [number for number, _ in self._unreadable]
        return {
            number: Connection(number, port.name, port.type, "yarp3", count=count - unreadable.count(number), details={"kind": port.kind})
            for number, (port, count) in enumerate(zip(self._ports, self._counts, strict=True))
        }

    def blocks(self, wanted: Wanted) -> Iterator[Block]:
        for number, port in enumerate(self._ports):
            if wanted.connections is None or number in wanted.connections:
                yield from blocks_of(self._messages(number, port, wanted))

    def _messages(self, number: int, port: Port, wanted: Wanted) -> Iterator[tuple[int, int, int, bytes]]:
        frames = Frames(port.folder)
        for line in self._lines(port):
            if not wanted.overlaps(line.log_ns, line.log_ns):
                continue
            try:
                data = _data(port, line.content, frames)
            except VideoError as error:
                self._tell(words.stopped(str(port.folder), str(error)))
                return
            except (ValueError, EncodeError, OSError) as error:
                self._unreadable.add((number, line.at))
                self._tell(words.bad_line(str(port.folder / "data.log"), line.at, str(error)))
            else:
                yield number, line.log_ns, line.publish_ns, data

    def _lines(self, port: Port) -> Iterator[Line]:
        """The lines of a port that are whole; the others are reported."""
        path = port.folder / "data.log"
        with path.open("rb") as file:
            at = 0
            while text := file.readline(MAX_LINE_BYTES):
                try:
                    yield _line(port, at, text)
                except ValueError as error:
                    cut = not text.endswith(b"\n")
                    self._tell(words.log_cut(str(path), at) if cut else words.bad_line(str(path), at, str(error)))
                at += len(text)


def _port(folder: Path, tell: Callable[[Diagnostic], None]) -> Port:
    """What `info.log` says: `Type: Bottle;`, `Stamp: tx+rx;`, and the ports that were connected."""
    try:
        with (folder / "info.log").open("rb") as file:
            text = file.read(MAX_INFO_BYTES).decode("utf-8", "replace")
    except OSError:
        tell(words.missing_file(str(folder), "info.log"))
        text = ""
    found = {name: value.strip(" ;") for name, _, value in (line.partition(":") for line in text.splitlines()) if value}
    kind = found.get("Type", "Bottle")
    return Port(folder, f"/{folder.name}", kind, found.get("Stamp", "rx"), "" if kind == "Bottle" else _type_of_images(folder))


def _type_of_images(folder: Path) -> str:
    """By the first line."""
    with (folder / "data.log").open("rb") as file:
        parts = file.readline(PATH_BYTES).split()
    return type_of_images(b" ".join(parts[-2:] if parts[-1].startswith(b"[") else parts[-1:])) if parts else ""


def _line(port: Port, at: int, text: bytes) -> Line:
    """What a line says. Where both times are there, the sender's comes first."""
    first, _, rest = text.rstrip(b"\r\n").partition(b" ")
    number = int(first)
    times: list[int] = []
    for _ in range(port.times(number)):
        time, _, rest = rest.partition(b" ")
        time_ns = int(Decimal(time.decode("ascii")) * 10**9) if TIME.fullmatch(time) else END_NS
        if abs(time_ns) >= END_NS:
            raise ValueError(f"{time[:40]!r} is no time")
        times.append(time_ns)
    if not text.endswith(b"\n"):
        raise ValueError("the line has no end")
    return Line(at, times[-1], times[0] if len(times) > 1 and times[0] else times[-1], rest)


def _data(port: Port, content: bytes, frames: Frames) -> bytes:
    """The bytes of a line's message."""
    return bottle.write(parse_text(content, DIALECT), DIALECT) if port.kind == "Bottle" else image_message(port.folder, content, frames)
