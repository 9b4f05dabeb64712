"""Where the cache keeps its files: a folder that only its user can write, or the memory of this process.

What lies in the folder is code, so each operation opens the folder anew, without following a symbolic link, asks the open folder who owns
it and who may write, and reaches the files through it: nobody can exchange the folder between the question and the use.
A file is written under another name and renamed; whoever reads it, or kills the writer, meets a whole file or none.
"""

from __future__ import annotations

import contextlib
import os
import stat
import sys
import time
from collections.abc import Callable, Generator
from io import FileIO
from typing import BinaryIO, Protocol

from rosetta_jit.startup.dataclass import dataclass

STALE_S = 3600.0
"""A temporary file that is older belongs to a writer that was killed."""

_TEMPORARY = ".tmp"
_OPEN_FOLDER = os.O_RDONLY | getattr(os, "O_DIRECTORY", 0) | getattr(os, "O_NOFOLLOW", 0)
# O_NONBLOCK: a planted FIFO must not hang the reader.
_SAFELY = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0)


class UntrustedError(Exception):
    """A folder or file that somebody else could have written; never leaves the cache."""


@dataclass(frozen=True, slots=True)
class Stored:
    """One file of a store: its name, its size, and when it was used last (nanoseconds)."""

    name: str
    size_bytes: int
    used_ns: int


class Store(Protocol):
    """Names and bytes. `FolderStore` raises OSError and `UntrustedError`; `MemoryStore` never fails."""

    def read(self, name: str) -> bytes | None: ...

    def write(self, name: str, data: bytes) -> None: ...

    def append(self, name: str, data: bytes, *, limit: int) -> bytes | None:
        """What the file holds then, if it can be trusted and is not longer than the limit."""
        ...

    def remove(self, name: str) -> None: ...

    def stored(self) -> list[Stored]: ...


class MemoryStore:
    """Files that end with the process. Threads may use it at once: each look at all files is one step of CPython's."""

    def __init__(self) -> None:
        self._files: dict[str, tuple[bytes, int]] = {}

    def read(self, name: str) -> bytes | None:
        data, _ = self._files.get(name, (None, 0))
        if data is None:
            return None
        self._files[name] = data, time.time_ns()
        return data

    def write(self, name: str, data: bytes) -> None:
        self._files[name] = data, time.time_ns()

    def append(self, name: str, data: bytes, *, limit: int) -> bytes | None:
        before, _ = self._files.get(name, (b"", 0))
        if len(before) + len(data) > limit:
            return None
        self.write(name, before + data)
        return before + data

    def remove(self, name: str) -> None:
        self._files.pop(name, None)

    def stored(self) -> list[Stored]:
        return [Stored(name, len(data), used) for name, (data, used) in self._files.copy().items()]


class FolderStore:
    """Files in a folder of the user's."""

    def __init__(self, folder: str) -> None:
        self.folder = folder

    def read(self, name: str) -> bytes | None:
        with contextlib.suppress(FileNotFoundError), self._opened() as folder, _open_file(name, folder) as file:
            _demand_own(os.fstat(file.fileno()), stat.S_ISREG, name)
            with contextlib.suppress(OSError):
                os.utime(file.fileno())  # what was used last is evicted last; a read-only file system just does not remember
            return file.read()
        return None

    def write(self, name: str, data: bytes) -> None:
        os.makedirs(self.folder, mode=0o700, exist_ok=True)
        with self._opened() as folder:
            temporary = f"{name}.{os.getpid()}.{time.monotonic_ns()}{_TEMPORARY}"
            try:
                with _create_file(temporary, folder) as file:
                    file.write(data)
                os.replace(temporary, name, src_dir_fd=folder, dst_dir_fd=folder)
            except OSError:
                _unlink(temporary, folder)
                raise

    def append(self, name: str, data: bytes, *, limit: int) -> bytes | None:
        """Processes may append at once; each piece comes in whole."""
        with contextlib.suppress(UntrustedError, OSError), self._opened() as folder, _append_to_file(name, folder) as file:
            status = os.fstat(file.fileno())
            _demand_own(status, stat.S_ISREG, name)
            if status.st_size + len(data) <= limit:
                file.write(data)
                file.seek(0)
                return file.read(limit)
        return None

    def remove(self, name: str) -> None:
        with contextlib.suppress(FileNotFoundError), self._opened() as folder:
            _unlink(name, folder)

    def stored(self) -> list[Stored]:
        """All whole files; temporary ones of writers that were killed are removed on the way."""
        with contextlib.suppress(FileNotFoundError), self._opened() as folder:
            found = [_stored(name, folder) for name in os.listdir(folder)]
            return [file for file in found if file is not None]
        return []

    @contextlib.contextmanager
    def _opened(self) -> Generator[int]:
        if os.open not in os.supports_dir_fd:
            raise UntrustedError(f"{sys.platform} cannot tell who may write to it")
        if os.path.islink(self.folder):
            raise UntrustedError("it is a symbolic link")
        folder = os.open(self.folder, _OPEN_FOLDER)
        try:
            _demand_own(os.fstat(folder), stat.S_ISDIR, "it")
            yield folder
        finally:
            os.close(folder)


def _open_file(name: str, folder: int) -> BinaryIO:
    return open(name, "rb", opener=lambda name, _: os.open(name, os.O_RDONLY | _SAFELY, dir_fd=folder))


def _append_to_file(name: str, folder: int) -> FileIO:
    return open(name, "a+b", buffering=0, opener=lambda name, flags: os.open(name, flags | _SAFELY, 0o600, dir_fd=folder))


def _create_file(name: str, folder: int) -> BinaryIO:
    return open(name, "xb", opener=lambda name, flags: os.open(name, flags, 0o600, dir_fd=folder))


def _demand_own(status: os.stat_result, is_kind: Callable[[int], bool], subject: str) -> None:
    if not is_kind(status.st_mode):
        raise UntrustedError(f"{subject} is not of the expected kind")
    if status.st_uid != os.geteuid():
        raise UntrustedError(f"{subject} belongs to another user")
    if status.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise UntrustedError(f"{subject} can be written by others")


def _stored(name: str, folder: int) -> Stored | None:
    try:
        status = os.stat(name, dir_fd=folder, follow_symlinks=False)
    except FileNotFoundError:
        return None  # another process evicted it
    if not name.endswith(_TEMPORARY):
        return Stored(name, status.st_size, status.st_mtime_ns)
    if time.time() - status.st_mtime > STALE_S:
        _unlink(name, folder)
    return None


def _unlink(name: str, folder: int) -> None:
    with contextlib.suppress(FileNotFoundError):
        os.unlink(name, dir_fd=folder)
