"""Ask libclang what a header declares: in a process of its own, which a hostile header may bring down."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from bisect import bisect_right
from itertools import accumulate
from pathlib import Path
from typing import Any

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.orocos import diagnostics as words
from rosetta_jit.frameworks.orocos.includes import MAIN, STANDARD, USER, Texts
from rosetta_jit.frameworks.orocos.limits import MAX_COMPILER_BYTES, MAX_DECLARATION_DEPTH, MAX_ERRORS, MAX_MEMBERS, MAX_PROCESSOR_SECONDS
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass, field

SECONDS = 30
"""How long the answer to a header is waited for, on a machine that has other work."""

MOST = {
    "seconds": MAX_PROCESSOR_SECONDS,
    "bytes": MAX_COMPILER_BYTES,
    "depth": MAX_DECLARATION_DEPTH,
    "members": MAX_MEMBERS,
    "errors": MAX_ERRORS,
}
"""What the compiler may take and tell."""

_MISSING = re.compile(r"'(.*)' file not found", re.DOTALL)
PROGRAM = Path(__file__).with_name("clang_reading.py")


@dataclass(slots=True)
class Places:
    """Spans of the places that the compiler names."""

    texts: Texts
    offsets: dict[str, list[int]] = field(default_factory=dict[str, list[int]])

    def span(self, place: list[Any]) -> Span:
        """The characters of a place in bytes; one in a text that is not the user's becomes the begin of the header."""
        path, begin, end = place
        source = self.texts.sources.get(path)
        if source is None:
            return Span(self.texts.sources[MAIN], 0, 1)
        if source.text.isascii():
            return Span(source, begin, end)
        return Span(source, self._character(path, source, begin), self._character(path, source, end))

    def _character(self, path: str, source: Source, byte: int) -> int:
        if path not in self.offsets:
            self.offsets[path] = list(accumulate((len(char.encode()) for char in source.text), initial=0))
        return bisect_right(self.offsets[path], byte) - 1


def declarations(texts: Texts) -> dict[str, Any]:
    """The answer of `clang_reading`, free of errors.

    Raises
    ------
    SchemaError
        If libclang is not installed, the header is no C++, or it takes more than it may.
    """
    start = Span(texts.sources[MAIN], 0, 1)
    request = json.dumps({"main": MAIN, "files": texts.unsaved, "user": USER, "standard": STANDARD, "most": MOST})
    command = [sys.executable, "-P", str(PROGRAM)]
    try:
        done = subprocess.run(command, input=request, capture_output=True, text=True, timeout=SECONDS, check=False)  # noqa: S603 - our own program
    except subprocess.TimeoutExpired as error:
        raise SchemaError((words.too_much_work(start),)) from error
    answer: dict[str, Any] = json.loads(done.stdout) if done.returncode == 0 and done.stdout else {"failed": True}
    if "failed" in answer:
        raise SchemaError((words.too_much_work(start),))
    if "missing" in answer:
        raise SchemaError((words.no_libclang(start),))
    if "errors" in answer:
        places = Places(texts)
        raise SchemaError(tuple(_error(text, places.span(place)) for text, place in answer["errors"]))
    return answer


def _error(text: str, span: Span) -> Diagnostic:
    """The diagnostic for an error of the compiler. A file that it cannot open is reported as missing."""
    missing = _MISSING.fullmatch(text)
    if missing is None:
        return words.compile_error(span, text)
    return words.missing_file(Span(span.source, span.start, span.start + len(missing[1]) + 2), missing[1])
