"""Files that are written: an error names the file, also where the system names none, as it does on a full disk."""

from __future__ import annotations

import errno
import os
from collections.abc import Generator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


@contextmanager
def named(path: Path) -> Generator[Path]:
    """Name the file in what goes wrong while it is written.

    Raises
    ------
    OSError
        As it came, with ``filename`` set.
    """
    try:
        yield path
    except OSError as error:
        if error.filename is None:
            error.filename = str(path)
        raise


@contextmanager
def whole(path: Path) -> Generator[Path]:
    """Another name for a file that is being written; it gets its own when all went well, and goes otherwise.

    Raises
    ------
    OSError
        A folder has that name, before anything is written; what else goes wrong, with the file's own name.
    """
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    part = path.with_name(f"{path.name}.part")
    with named(path):
        try:
            yield part
            part.replace(path)
        except BaseException as error:
            with suppress(OSError):  # where nothing can be written, there is none
                part.unlink()
            if isinstance(error, OSError) and error.filename == str(part):
                error.filename = str(path)
            raise


@contextmanager
def folder(path: Path) -> Generator[Path]:
    """A folder, made where there is none; one that was made goes again where something goes wrong.

    Raises
    ------
    NotADirectoryError
        Something else has that name.
    """
    lacking = [each for each in (path, *path.parents) if not each.exists()]
    try:
        try:
            path.mkdir(parents=True, exist_ok=True)
        except FileExistsError:
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(path)) from None
        yield path
    except BaseException:
        for each in lacking:
            with suppress(OSError):  # somebody else has put something there
                each.rmdir()
        raise
