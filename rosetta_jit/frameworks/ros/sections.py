"""The definitions of a text: one, or several as bags and MCAP files carry them, each after a line of `=` and one with its name.

https://wiki.ros.org/Bags/Format/2.0 and https://mcap.dev/spec/registry#ros2msg
"""

from __future__ import annotations

import re
from dataclasses import field
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import ros as say
from rosetta_jit.dataclass import dataclass
from rosetta_jit.frameworks.ros.names import split
from rosetta_jit.source import Span

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.ros.dialect import Dialect
    from rosetta_jit.frameworks.ros.names import Declared
    from rosetta_jit.source import Source

SEPARATOR = re.compile(r"^={3,}[ \t]*\r?(?:\n|\Z)", re.MULTILINE)
HEADER = re.compile(r"MSG:[ \t]*(\S*)[ \t]*\r?(?:\n|\Z)")


@dataclass(frozen=True, slots=True)
class Section:
    """The text of one definition: where it lies in its source, and the message that it defines.

    ``local`` are the full names of what it may refer to by a last part alone, besides messages of its package.
    """

    source: Source
    package: str
    short: str
    start: int
    end: int
    named: Span
    folder: str = "msg"
    local: Mapping[str, str] = field(default_factory=dict[str, str])

    @property
    def text(self) -> str:
        return self.source.text[self.start : self.end]


def sections(source: Source, declared: Declared, dialect: Dialect, problems: list[Diagnostic]) -> list[Section]:
    """The definitions of a source; the first is that of the named message, unless nothing stands before the first line of `=`."""
    breaks = list(SEPARATOR.finditer(source.text))
    ends = [max(0, each.start() - 1) for each in breaks] + [len(source.text)]
    first = Section(source, declared.package, declared.short, 0, ends[0], Span(source, 0, 0), declared.folder)
    found = [] if breaks and not first.text.strip() else [first]
    for line, end in zip(breaks, ends[1:], strict=True):
        header = HEADER.match(source.text, line.end())
        if header is None:
            problems.append(say.no_section_name(Span(source, line.start(), line.end() - 1)))
            continue
        named = Span(source, header.start(1), header.end(1))
        name = _name(header[1], dialect)
        if name is None:
            problems.append(say.wrong_section_name(named, header[1]))
        else:
            found.append(Section(source, *name, header.end(), max(end, header.end()), named))
    return found


def _name(written: str, dialect: Dialect) -> tuple[str, str] | None:
    package, short = split(written)
    middle = written.split("/")[1:-1]
    fits = middle in ([], ["msg"]) and dialect.packages.allows(package) and dialect.messages.allows(short)
    return (package, short) if fits else None
