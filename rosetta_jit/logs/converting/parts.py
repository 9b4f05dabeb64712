"""The files of a folder of tables: one a topic, a stretch of time, and a step of the conversion.

    folder = _conversion.json, [_quarantine.jsonl], topic*
    topic  = (start=20240501T120000/ 000000.parquet*)*

Each has its name once it is whole and on the disk. A file that is open takes a megabyte, so few of a topic are: messages that come for one
that is closed go into another, `000000.1.parquet`.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError
from rosetta_jit.logs.limits import MAX_OPEN, MAX_STRETCHES
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from pathlib import Path

    import pyarrow as pa
    from numpy.typing import NDArray

    from rosetta_jit.runtime.arrow.files import TableFile

WAITING_BYTES = 20 << 20
"""What is in memory of all files together until their groups of rows are full."""

STRETCHES_OPEN = 4
"""Of a topic, so many files are open at once: messages come nearly in order."""

SECOND = 10**9


@dataclass(slots=True)
class _Open:
    path: Path
    part: Path
    file: TableFile


class Parts:
    """The files that are being written.

    Parameters
    ----------
    folder
        What they lie in.
    every_ns
        The length of a stretch of time.
    number
        The number of the step: it is the name of the files.
    """

    def __init__(self, folder: Path, suffix: str, every_ns: int, number: int) -> None:
        self._folder, self._suffix, self._every, self.number = folder, suffix, every_ns, number
        self._open: dict[tuple[str, int], _Open] = {}
        """The one that was used last stands last."""
        self._closed: list[_Open] = []
        self._made: dict[tuple[str, int], int] = {}
        self._stretches: set[tuple[str, int]] = set()

    def remove_unfinished(self) -> None:
        """Remove what a process left that was killed: files of this step and later ones, and those without their names."""
        for path in self._folder.glob(f"*/start=*/*{self._suffix}*"):
            stem = path.name.partition(".")[0]
            if stem.isdigit() and (path.suffix == ".part" or int(stem) >= self.number):
                path.unlink()

    @property
    def is_full(self) -> bool:
        """Whether no more files may be open."""
        return len(self._open) >= MAX_OPEN

    def add(self, name: str, table: pa.Table, log_ns: NDArray[np.int64]) -> None:
        """Add rows of a topic, by the times at which they were logged."""
        from rosetta_jit.runtime.arrow.tables import taken

        stretches = log_ns // self._every
        for stretch in np.unique(stretches).tolist():
            mask = stretches == stretch
            self._file(name, stretch).write(table if mask.all() else taken(table, np.flatnonzero(mask)))
        waiting = {key: each.file.waiting_bytes for key, each in self._open.items()}
        while sum(waiting.values()) > WAITING_BYTES:
            largest = max(waiting, key=waiting.__getitem__)
            self._open[largest].file.flush()
            waiting[largest] = 0

    def _file(self, name: str, stretch: int) -> TableFile:
        key = name, stretch
        if key not in self._open:
            self._make_room(name)
            from rosetta_jit.runtime.arrow.files import TableFile

            self._stretches.add(key)
            if len(self._stretches) > MAX_STRETCHES:
                raise LogError((words.many_stretches(str(self._folder), MAX_STRETCHES),))
            begin = str(np.datetime64(stretch * self._every // SECOND, "s")).replace("-", "").replace(":", "")
            made = self._made[key] = self._made.get(key, -1) + 1
            file = f"{self.number:06d}{f'.{made}' if made else ''}{self._suffix}"
            path = self._folder / name / f"start={begin}" / file
            path.parent.mkdir(parents=True, exist_ok=True)
            part = path.with_name(f"{path.name}.part")
            self._open[key] = _Open(path, part, TableFile(part, self._suffix))
        self._open[key] = self._open.pop(key)
        return self._open[key].file

    def _make_room(self, name: str) -> None:
        """Before another file of a topic is opened: write what waits for its others, and close the one that was not used for longest."""
        of_topic = [key for key in self._open if key[0] == name]
        for key in of_topic:
            self._open[key].file.flush()
        if len(of_topic) >= STRETCHES_OPEN:
            self._open[of_topic[0]].file.close()
            self._closed.append(self._open.pop(of_topic[0]))

    def finish(self) -> None:
        """Give all files their names, when they are on the disk; the next ones are of the next step."""
        for each in self._open.values():
            each.file.close()
        for each in [*self._closed, *self._open.values()]:
            with each.part.open("rb") as file:
                os.fsync(file.fileno())
            each.part.replace(each.path)
        self._forget()
        self.number += 1

    def abandon(self) -> None:
        """Remove those that are not finished."""
        for each in self._open.values():
            each.file.abandon()
        for each in [*self._closed, *self._open.values()]:
            each.part.unlink(missing_ok=True)
        self._forget()

    def _forget(self) -> None:
        self._open.clear()
        self._closed.clear()
        self._made.clear()
