"""The texts that a header needs, before a compiler sees any: found through the search path, or ours where they are the standard library's.

The compiler gets nothing else: what is not among these texts cannot be included.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.orocos import diagnostics as words
from rosetta_jit.frameworks.orocos.limits import MAX_CHARACTERS, MAX_FILES
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.parsing.idl import Load

USER, STANDARD = "/header/", "/standard/"
"""Where the compiler believes that the user's headers and those of the standard library lie; no such folders need exist."""

MAIN = f"{USER}main.hpp"

EMPTY = (
    "algorithm",
    "assert.h",
    "cassert",
    "cmath",
    "cstdio",
    "cstdlib",
    "cstring",
    "functional",
    "iomanip",
    "limits",
    "limits.h",
    "climits",
    "math.h",
    "numeric",
    "sstream",
    "stdexcept",
    "stdio.h",
    "stdlib.h",
    "string.h",
    "utility",
)
"""Standard headers that plain data often includes and never needs: what they declare is not known."""

_INCLUDE = re.compile(r"^[ \t]*#[ \t]*(?:include|import)[ \t]*[<\"]([^>\"\n]+)[>\"]", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Texts:
    """Sources by the path at which the compiler finds them; the standard headers are beside them."""

    sources: Mapping[str, Source]

    @property
    def unsaved(self) -> dict[str, str]:
        """All texts by their paths."""
        return {**standard_headers(), **{path: source.text for path, source in self.sources.items()}}


def gather(source: Source, load: Load) -> Texts:
    """A header and whatever it may include, wherever the preprocessor would come to it or not.

    Raises
    ------
    SchemaError
        If a file cannot be read, or there are too many.
    """
    found = {MAIN: source}
    unread = [(MAIN, source)]
    size = len(source.text)
    while unread:
        path, including = unread.pop()
        for name, span in _includes(including):
            for candidate in _candidates(path, name):
                if USER + candidate in found:
                    break
                text = load(candidate)
                if text is None:
                    continue
                found[USER + candidate] = text
                unread.append((USER + candidate, text))
                size += len(text.text)
                if len(found) > MAX_FILES or size > MAX_CHARACTERS:
                    raise SchemaError((words.too_many_files(span, MAX_FILES, MAX_CHARACTERS),))
                break
    return Texts(found)


def _includes(source: Source) -> Iterator[tuple[str, Span]]:
    for each in _INCLUDE.finditer(source.text):
        yield each[1], Span(source, each.start(1), each.end(1))


def _candidates(path: str, name: str) -> list[str]:
    """The names under which the search path may know an include: seen from the including file's folder, and as it is written."""
    if name in EMPTY or STANDARD + name in standard_headers() or not name.isprintable():
        return []
    folder = posixpath.dirname(path.removeprefix(USER))
    names = [posixpath.normpath(posixpath.join(folder, name)), posixpath.normpath(name)]
    return [each for each in dict.fromkeys(names) if not each.startswith(("/", ".", "~")) and "\\" not in each and ":" not in each]


@cache
def standard_headers() -> Mapping[str, str]:
    """Our own declarations of what plain data takes from the standard library, with the sizes that libstdc++ gives them."""
    folder = Path(__file__).with_name("standard")
    known = {STANDARD + path.name: path.read_text(encoding="utf-8") for path in sorted(folder.iterdir())}
    streams = dict.fromkeys((f"{STANDARD}{name}" for name in ("iostream", "istream", "ostream")), "#include <iosfwd>\n")
    return {**dict.fromkeys((STANDARD + name for name in EMPTY), "#pragma once\n"), **streams, **known}
