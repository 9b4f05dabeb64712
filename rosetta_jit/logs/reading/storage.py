"""The bytes of a log, wherever they lie: a file, standard input, or what `fsspec` reaches."""

from __future__ import annotations

import io
import os
import shutil
import sys
import tempfile
import zlib
from collections.abc import Callable
from contextlib import suppress
from errno import ENOENT
from importlib import import_module
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any, BinaryIO, cast
from weakref import finalize

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError

if TYPE_CHECKING:
    from numpy.typing import NDArray


WINDOW = 4 << 20
"""Bytes that are copied at once."""


GZIP, ZSTD = b"\x1f\x8b", b"\x28\xb5\x2f\xfd"
"""How files begin that are compressed as a whole."""


class Storage:
    """A file that can be read at any place. The size is that when it was opened: a log that is being written is read so far.

    One that is compressed as a whole has the bytes that it was made of: ``is_unpacked`` says that its file is another one than is named.

    Of a log that is a folder, which ``is_folder`` says, it is an empty file: its reader opens the files in it.
    """

    def __init__(self, name: str, file: BinaryIO, *, is_folder: bool = False, is_unpacked: bool = False) -> None:
        self.name, self.is_folder = name, is_folder
        self._file, self.is_unpacked = file, is_unpacked
        self._lock = Lock()
        self._ends: list[Callable[[], object]] = [finalize(self, file.close)]  # who opens a log for one expression closes nothing
        self.size = file.seek(0, os.SEEK_END)
        self._has_places = isinstance(file, io.BufferedReader) and hasattr(os, "preadv")
        self._copy: Path | None = None

    @property
    def path(self) -> Path:
        """The path of a local file or folder; what a log is called that is none."""
        return _path(self.name) or Path(self.name)

    def local(self, suffix: str) -> Path:
        """A local file with these bytes, for who cannot read them here: the log itself, or a copy that is there as long as this is."""
        if (path := _path(self.name)) is not None and not self.is_unpacked:
            return path
        if self._copy is None:
            folder = Path(tempfile.mkdtemp(prefix="rosetta-jit-"))
            self._ends.append(finalize(self, shutil.rmtree, folder, ignore_errors=True))
            self._copy = folder / f"log{suffix}"
            with self._copy.open("wb") as file:
                for at in range(0, self.size, WINDOW):
                    file.write(self.read(at, WINDOW))
        return self._copy

    def read(self, at: int, size: int) -> bytes:
        """So many bytes from a place on; fewer where the file ends."""
        size = max(0, min(size, self.size - at))
        with self._lock:
            self._file.seek(at)
            return self._file.read(size)

    def read_into(self, at: int, memory: NDArray[np.uint8]) -> memoryview:
        """As many bytes as there is memory for; fewer where the file ends. Fresh memory would take as long as reading into it."""
        view = memory[: max(0, min(memory.size, self.size - at))].data
        filled = 0
        with self._lock:  # also where the system needs no place to be sought, so that nobody closes the file meanwhile
            if not self._has_places:
                self._file.seek(at)
            while filled < len(view) and (count := self._fill(view[filled:], at + filled)):
                filled += count
        return view[:filled]

    def _fill(self, view: memoryview, at: int) -> int:
        """Read once into some memory: from a place, or where the file is; how many bytes."""
        return os.preadv(self._file.fileno(), [view], at) if self._has_places else cast("Any", self._file).readinto(view)

    def array(self, at: int, size: int) -> NDArray[np.uint8]:
        """The same as an array."""
        return np.frombuffer(self.read(at, size), np.uint8)

    def close(self) -> None:
        """Close the file, and remove its copy."""
        with self._lock:
            for end in self._ends:
                end()


def open_storage(name: str) -> Storage:
    """Open a file, a URL that `fsspec` knows, or standard input (``-``).

    Raises
    ------
    LogError
        It cannot be read.
    """
    path = _path(name)
    try:
        if path is not None and path.is_dir():
            return Storage(name, io.BytesIO(), is_folder=True)
        file = _file(name, path)
        unpacked = _unpacked(name, file)
        return Storage(name, file) if unpacked is None else Storage(name, unpacked, is_unpacked=True)
    except (OSError, ValueError) as error:
        why = (error.strerror if isinstance(error, OSError) else None) or str(error)
        raise LogError((words.unreadable(name, why),)) from error


def _path(name: str) -> Path | None:
    """Where a local file or folder is; None of what is none."""
    if name.startswith("file://"):
        return Path(name.removeprefix("file://"))
    return None if name == "-" or "://" in name else Path(name)


def _file(name: str, path: Path | None) -> BinaryIO:
    if path is not None:
        if path.exists() and not path.is_file():
            raise OSError(0, "it is no file that ends")
        return path.open("rb")
    if name == "-":
        return _spooled(sys.stdin.buffer)
    try:
        addresses, archives = cast("list[Any]", [import_module(each) for each in ("fsspec.core", "fsspec.archive")])
    except ImportError:
        raise LogError((words.needs(name, "fsspec", "logs"),)) from None
    try:
        system, inside = addresses.url_to_fs(name)
        file = cast("BinaryIO", system.open(inside, "rb"))
        # what is compressed within an archive cannot be read from its end, and an archive closes its files when it goes
        return _spooled(file) if isinstance(system, archives.AbstractArchiveFileSystem) else file
    except Exception as error:  # noqa: BLE001 - each kind of address has a package of its own, and their errors have no base
        cause = error.__cause__ if isinstance(error, FileNotFoundError) and not error.strerror else error  # else it is the name alone
        raise OSError(0, str(cause or os.strerror(ENOENT)) or type(cause).__name__) from None


def _unpacked(name: str, file: BinaryIO) -> BinaryIO | None:
    """What a file held before it was compressed as a whole, as far as it is whole; None of one that is not compressed so."""
    import gzip  # few logs need it

    file.seek(0)
    begin = file.read(len(ZSTD))
    file.seek(0)
    if begin.startswith(GZIP):
        stream, errors = cast("BinaryIO", gzip.GzipFile(fileobj=file)), (EOFError, gzip.BadGzipFile, zlib.error)
    elif begin == ZSTD:
        stream, errors = _zstd(name, file)
    else:
        return None
    room = shutil.disk_usage(tempfile.gettempdir()).free // 2
    with file, tempfile.TemporaryFile() as out:
        with suppress(*errors):
            while piece := cast("Any", stream).read1(WINDOW):  # what it has when the damage comes, unlike `read`
                if out.tell() + len(piece) > room:
                    raise OSError(0, "it holds more than half of the disk has room for")
                out.write(piece)
        out.flush()
        return os.fdopen(os.dup(out.fileno()), "rb")


def _zstd(name: str, file: BinaryIO) -> tuple[BinaryIO, tuple[type[Exception], ...]]:
    """What decompresses a file of zstd, and what it raises where the file is damaged."""
    try:
        zstandard: Any = import_module("zstandard")
    except ImportError:
        raise LogError((words.needs(name, "zstandard", "logs"),)) from None
    return zstandard.ZstdDecompressor().stream_reader(file, read_across_frames=True), (zstandard.ZstdError,)


def _spooled(stream: BinaryIO) -> BinaryIO:
    """A stream as a file, since logs are read from their end."""
    file = tempfile.TemporaryFile()  # noqa: SIM115 - the storage closes it
    shutil.copyfileobj(stream, file)
    return cast("BinaryIO", file)
