"""Writing folders as `yarpdatadumper` does: of each port `data.log`, a line a message, `info.log`, and a file an image.

Bottles are written as text, which loses the widths of integers and that a float had 32 bits. Times have six decimals.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, BinaryIO

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import DecodeError, LogError
from rosetta_jit.frameworks.yarp import bottle
from rosetta_jit.frameworks.yarp.tags import DIALECTS, Dialect
from rosetta_jit.frameworks.yarp.text import to_text
from rosetta_jit.logs.folder_names import folder_names
from rosetta_jit.logs.yarp.images import ImageError, image_file
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from pathlib import Path

    from rosetta_jit.logs.base import Connection

IMAGES = ("yarp.sig.ImageOfPixelRgb", "yarp.sig.ImageOfPixelMono", "yarp.sig.ImageOfPixelFloat")
"""Types whose messages become files."""


@dataclass(slots=True)
class _Port:
    folder: Path
    lines: BinaryIO
    dialect: Dialect
    has_images: bool
    count: int = 0


class DumperWriter:
    """A folder a port. Both times are written: the sender's, and that at which the message was logged."""

    def __init__(self, name: str, folder: Path) -> None:
        self._name, self._folder = name, folder
        self._connections: list[Connection] = []
        self._ports: dict[int, _Port] = {}

    def connect(self, connection: Connection) -> int:
        if connection.encoding not in DIALECTS:
            raise LogError((words.not_carried(self._name, connection.topic, connection.encoding, "bottles of YARP alone"),))
        self._connections.append(connection)
        return len(self._connections) - 1

    def _port(self, number: int) -> _Port:
        """The folder of a port, which is made when all ports are known: for the first message."""
        if number not in self._ports:
            connection = self._connections[number]
            folder = self._folder / folder_names(each.topic for each in self._connections)[connection.topic]
            folder.mkdir(exist_ok=True)
            has_images = connection.type in IMAGES
            (folder / "info.log").write_text(f"Type: {'Image' if has_images else 'Bottle'};\nStamp: tx+rx;\n")
            self._ports[number] = _Port(folder, (folder / "data.log").open("ab"), DIALECTS[connection.encoding], has_images)
        return self._ports[number]

    def write(self, number: int, log_ns: int, publish_ns: int, data: bytes) -> None:
        port = self._port(number)
        try:
            content = self._image(port, data) if port.has_images else to_text(bottle.read(data, port.dialect))
        except (DecodeError, ImageError) as error:
            topic = self._connections[number].topic
            raise LogError((words.not_written(self._name, topic, port.count, str(error)),)) from error
        port.lines.write(b"%d %s %s %s\n" % (port.count, _seconds(publish_ns), _seconds(log_ns), content))
        port.count += 1

    def _image(self, port: _Port, data: bytes) -> bytes:
        suffix, pixels, content = image_file(data)
        name = f"{port.count:08d}{suffix}"
        (port.folder / name).write_bytes(content)
        return f"{name} [{pixels}]".encode()

    def finish(self) -> None:
        for number in range(len(self._connections)):
            self._port(number).lines.close()


def _seconds(time_ns: int) -> bytes:
    """Seconds with the six decimals that YARP writes."""
    seconds, microseconds = divmod(time_ns // 1000, 1_000_000)
    return b"%d.%06d" % (seconds, microseconds)
