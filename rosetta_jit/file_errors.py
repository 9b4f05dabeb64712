"""Files that are written: an error names the file, also where the system names none, as it does on a full disk."""

from __future__ import annotations

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
    """Another name for a file that is being written; it gets its own when all went well, and goes otherwise."""
    part = path.with_name(f"{path.name}.part")
    with named(path):
        try:
            yield part
        except BaseException:
            part.unlink(missing_ok=True)
            raise
        part.replace(path)
