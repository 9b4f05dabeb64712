"""Where the keys of a TOML file stand: `tomllib` gives values without places, and mistakes are shown with a caret."""

from __future__ import annotations

import re
from collections.abc import Iterator

from rosetta_jit.source import Source, Span

HEADER = re.compile(r"\s*(\[\[?)\s*([A-Za-z0-9_.\"'-]+)\s*\]\]?")
KEY = re.compile(r"\s*([A-Za-z0-9_-]+|\"[^\"]*\"|'[^']*')\s*=\s*(?P<value>[^#\n]*)")

Path = tuple[str | int, ...]


class TomlSpans:
    """The places of a file's keys, by their paths: ``("route", 0, "source")`` is `source` in the first `[[route]]`."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self._found = dict(_places(source))

    def of(self, *path: str | int) -> Span:
        """Where the value of a key stands, or that of the closest one around it; the begin of the file where there is none."""
        for size in range(len(path), 0, -1):
            if path[:size] in self._found:
                return self._found[path[:size]]
        return Span(self.source, 0, min(1, len(self.source.text)))


def _places(source: Source) -> Iterator[tuple[Path, Span]]:
    table: Path = ()
    counts: dict[str, int] = {}
    start = 0
    for line in source.text.splitlines(keepends=True):
        header, key = HEADER.match(line), KEY.match(line)
        if header is not None:
            name = header[2].strip("\"'")
            table = (name,)
            if header[1] == "[[":
                table = (name, counts.get(name, 0))
                counts[name] = counts.get(name, 0) + 1
            yield table, Span(source, start + header.start(1), start + header.end())
        elif key is not None:
            end = start + key.start("value") + max(len(key["value"].rstrip()), 1)
            yield (*table, key[1].strip("\"'")), Span(source, start + key.start("value"), end)
        start += len(line)


def place_of_syntax(source: Source, message: str) -> Span:
    """Where `tomllib` says that a mistake is."""
    found = re.search(r"line (\d+), column (\d+)", message)
    if found is None:
        return Span(source, max(len(source.text) - 1, 0), len(source.text))
    lines = source.text.splitlines(keepends=True)
    start = sum(map(len, lines[: int(found[1]) - 1])) + int(found[2]) - 1
    return Span(source, start, start + 1)
