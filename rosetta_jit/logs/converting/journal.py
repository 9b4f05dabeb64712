"""How far the conversion of a log into a folder is: a file in that folder, replaced as a whole whenever files were finished.

All that it says is on the disk. What is there besides, of a process that was killed, is removed when the conversion goes on.
"""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from pathlib import Path

NAME = "_conversion.json"
"""Readers of folders of tables leave out what begins with `_`."""

PART = "_conversion.json.part"
"""While it is written."""


@dataclass(slots=True)
class Progress:
    """What is done.

    Attributes
    ----------
    piece, within
        The piece of the log that comes next, and how many of its wanted messages are done.
    number
        The number of the files that are written next.
    seen
        How many messages of each topic were read.
    rejected
        How many of them were left out, and ``rejected_bytes`` the size of the quarantine's file.
    """

    piece: int = 0
    within: int = 0
    number: int = 0
    seen: dict[str, int] = field(default_factory=dict[str, int])
    rejected: dict[str, int] = field(default_factory=dict[str, int])
    rejected_bytes: int = 0
    is_complete: bool = False


@dataclass(frozen=True, slots=True)
class Journal:
    """The journal of a folder, and what is converted into it: the log, the topics, the options, as JSON has them."""

    folder: Path
    request: dict[str, Any]

    @property
    def path(self) -> Path:
        return self.folder / NAME

    def read(self) -> Progress:
        """What is done; nothing, where no conversion has finished any file.

        Raises
        ------
        LogError
            The folder is of another conversion, or the journal is damaged.
        """
        try:
            with self.path.open(encoding="utf-8") as file:
                found: Any = json.load(file)
            progress, request = Progress(**found["progress"]), dict[str, Any](found["request"])
        except FileNotFoundError:
            return Progress()
        except (ValueError, TypeError, KeyError, OSError) as error:
            raise LogError((words.bad_journal(str(self.path), str(error)),)) from error
        for name in {**request, **self.request}:
            if request.get(name) != self.request.get(name):
                raise LogError((words.other_conversion(str(self.folder), name),))
        return progress

    def write(self, progress: Progress) -> None:
        """Keep what is done, so that it is there whatever happens next."""
        plain = {name: getattr(progress, name) for name in Progress.__match_args__}
        part = self.folder / PART
        with part.open("w", encoding="utf-8") as file:
            json.dump({"request": self.request, "progress": plain}, file, indent=1)
            file.flush()
            os.fsync(file.fileno())
        part.replace(self.path)
