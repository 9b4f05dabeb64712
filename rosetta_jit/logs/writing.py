"""Writing logs: a format's writer is given connections and messages; what it cannot carry is refused before anything is written."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from shutil import rmtree
from typing import TYPE_CHECKING, Protocol

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError
from rosetta_jit.file_errors import named, whole
from rosetta_jit.startup.garbage import object_at

if TYPE_CHECKING:
    from pathlib import Path

    from rosetta_jit.logs.base import Connection

WRITERS = {
    ".mcap": "rosetta_jit.logs.mcap.writer:McapWriter",
    ".bag": "rosetta_jit.logs.bag.writer:BagWriter",
    ".lcmlog": "rosetta_jit.logs.lcm.writer:LcmWriter",
}
"""By the suffix of the file."""


class Writer(Protocol):
    """A log that is being written."""

    def connect(self, connection: Connection) -> int:
        """Add a stream of messages; gives the number by which it is written. LogError if the format cannot carry it."""
        ...

    def write(self, number: int, log_ns: int, publish_ns: int, data: bytes) -> None:
        """Write a message."""
        ...

    def finish(self) -> None:
        """Write the index."""
        ...


FOLDERS = {"yarpdatadumper": "rosetta_jit.logs.yarp.writer:DumperWriter"}
"""Those of folders, by the name of the format."""


@contextmanager
def written(path: Path, format_: str | None = None) -> Generator[Writer]:
    """A new log. It has its name when it is whole; until then, and if the process is killed, it is called `….part`.

    Parameters
    ----------
    format_
        Of a log that is a folder; of a file, its name tells.

    Raises
    ------
    LogError
        No format has such files, or the folder is there already.
    """
    if format_ is not None:
        make = object_at(FOLDERS[format_])
        with whole_folder(path) as folder:
            writer: Writer = make(str(path), folder)
            yield writer
            writer.finish()
        return
    place = next((each for suffix, each in WRITERS.items() if path.name.endswith(suffix)), None)
    if place is None:
        raise LogError((words.no_writer(str(path), WRITERS),))
    make = object_at(place)
    with whole(path) as part, part.open("wb") as file:
        writer = make(str(path), file)
        yield writer
        writer.finish()


@contextmanager
def whole_folder(path: Path) -> Generator[Path]:
    """The same for a folder, which must not be there already."""
    if path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise LogError((words.folder_is_there(str(path)),))
    part = path.with_name(f"{path.name}.part")
    with named(path):
        rmtree(part, ignore_errors=True)
        part.mkdir(parents=True)
        try:
            yield part
        except BaseException:
            rmtree(part, ignore_errors=True)
            raise
        part.replace(path)
