"""Files that are written: an error names the file, also where the system names none, as it does on a full disk."""

from __future__ import annotations

import errno
import os
from collections.abc import Generator
from contextlib import contextmanager
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
        except BaseException:
            part.unlink(missing_ok=True)
            raise


def folder(path: Path) -> Path:
    """A folder, made where there is none.

    Raises
    ------
    NotADirectoryError
        Something else has that name.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(path)) from None
    return path
