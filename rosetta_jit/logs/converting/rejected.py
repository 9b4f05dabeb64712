"""Messages that cannot be decoded: they stop the work, are left out, or are written to a file of their own with the reasons."""

from __future__ import annotations

import json
import os
from base64 import b64encode
from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal, TextIO, TypeAlias

from rosetta_jit.errors import DecodeError
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from pathlib import Path

    from rosetta_jit.logs.decoded_parts import OnError, Refused

Damaged: TypeAlias = Literal["stop", "skip", "quarantine"]


@dataclass(slots=True)
class Rejected:
    """What becomes of messages that cannot be decoded.

    Attributes
    ----------
    path
        The file of a quarantine: a line of JSON a message, with its topic, its number among those of the topic, when it was logged, why it
        was left out, and its bytes. It is there once a message is.
    counts
        How many messages were left out, by topic.
    """

    path: Path
    policy: Damaged = "stop"
    counts: dict[str, int] = field(default_factory=dict[str, int])
    _file: TextIO | None = None

    @property
    def on_error(self) -> OnError:
        """What a decoder does with them."""
        return "raise" if self.policy == "stop" else "skip"

    @property
    def total(self) -> int:
        """How many were left out."""
        return sum(self.counts.values())

    def begin(self, size: int = 0) -> None:
        """Keep so many bytes of a quarantine that is there, and nothing behind them."""
        if self.path.exists():
            os.truncate(self.path, size) if size else self.path.unlink()

    def add(self, topic: str, first: int, errors: Mapping[int, DecodeError], refused: Mapping[int, Refused]) -> None:
        """Messages of a topic that were left out, by their numbers behind the ``first``."""
        self.counts[topic] = self.counts.get(topic, 0) + len(errors)
        if self.policy != "quarantine" or not errors:
            return
        self._file = self._file or self.path.open("a", encoding="utf-8")
        for index, error in errors.items():
            message = refused[index]
            octets = b64encode(message.data).decode("ascii")
            line = {"topic": topic, "message": first + index, "log_time": message.log_ns, "error": str(error), "base64": octets}
            self._file.write(json.dumps(line) + "\n")

    def kept(self) -> int:
        """Make sure that all is on the disk; gives the size of the file."""
        if self._file is None:
            return self.path.stat().st_size if self.path.exists() else 0
        self._file.flush()
        os.fsync(self._file.fileno())
        return self._file.tell()

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()
            self._file = None
