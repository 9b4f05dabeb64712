"""Real YARP, where CMake finds it: what it makes of bytes and of text. `YARP_DIR` names a build that is not installed."""

from __future__ import annotations

import os
import shutil
import struct
import subprocess
from pathlib import Path

SOURCE = Path(__file__).with_name("real")


class RealYarp:
    """A process with YARP in it, and another one when it has died of a question.

    Raises
    ------
    ValueError
        From each question: YARP refuses the data, or dies of them.
    """

    def __init__(self, program: Path) -> None:
        self._program = program
        self._process: subprocess.Popen[bytes] | None = None
        self.version = self._ask("version", b"").decode()

    def text_of(self, data: bytes) -> bytes:
        """How YARP prints a bottle."""
        return self._ask("text", data)

    def bytes_of(self, text: bytes) -> bytes:
        """What YARP writes of a bottle that it has parsed."""
        return self._ask("bytes", text)

    def rewritten(self, type_: str, data: bytes) -> bytes:
        """A message, read by the class of its type and written again."""
        return self._ask(type_, data)

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def _ask(self, work: str, data: bytes) -> bytes:
        if self._process is None:
            self._process = subprocess.Popen([self._program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        questions, answers = self._process.stdin, self._process.stdout
        assert questions is not None
        assert answers is not None
        questions.write(work.encode() + b"\n" + struct.pack("<i", len(data)) + data)
        questions.flush()
        head = answers.read(4)
        if len(head) < 4:
            self.close()
            raise ValueError("YARP dies of it")
        (size,) = struct.unpack("<i", head)
        if size < 0:
            raise ValueError("YARP refuses it")
        return answers.read(size)


def seems_installed() -> bool:
    """Whether it is worth a try: CMake would look for long."""
    return bool(os.environ.get("YARP_DIR")) or shutil.which("yarp-config") is not None


def build(folder: Path) -> RealYarp | None:
    """Build the program in a folder; None where there is no CMake, no compiler or no YARP."""
    try:
        for command in (["cmake", "-S", SOURCE, "-B", folder], ["cmake", "--build", folder]):
            subprocess.run(command, check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return RealYarp(folder / "real_yarp")
