"""The definitions of a text: one, or several as bags and MCAP files carry them, each after a line of `=` and one with its kind and name.

    MSG: std_msgs/Header    SRV: std_srvs/srv/SetBool    ACTION: nav2_msgs/action/Wait    IDL: std_msgs/msg/Header

https://wiki.ros.org/Bags/Format/2.0, https://mcap.dev/spec/registry#ros2msg and rosbag2's docs/message_definition_encoding.md
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.ros import diagnostics as say
from rosetta_jit.frameworks.ros.dialect import Dialect
from rosetta_jit.frameworks.ros.names import Declared, split
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass, field

SEPARATOR = re.compile(r"^={3,}[ \t]*\r?(?:\n|\Z)", re.MULTILINE)
HEADER = re.compile(r"([A-Z]+):[ \t]*(\S*)[ \t]*\r?(?:\n|\Z)")


@dataclass(frozen=True, slots=True)
class Section:
    """The text of one definition: where it lies in its source, and what it defines.

    ``kind`` is the suffix of the file that it would be. ``local`` are the full names of what it may refer to by a last part alone, besides
    messages of its package.
    """

    source: Source
    package: str
    short: str
    start: int
    end: int
    named: Span
    folder: str = "msg"
    kind: str = "msg"
    local: Mapping[str, str] = field(default_factory=dict[str, str])

    @property
    def text(self) -> str:
        return self.source.text[self.start : self.end]


def sections(source: Source, declared: Declared, dialect: Dialect, problems: list[Diagnostic]) -> list[Section]:
    """The definitions of a source; the first is that of the named file, unless nothing stands before the first line of `=`."""
    breaks = list(SEPARATOR.finditer(source.text))
    ends = [max(0, each.start() - 1) for each in breaks] + [len(source.text)]
    several = declared.folder in dialect.interfaces and source.name.endswith(f".{declared.folder}")
    kind = declared.folder if several else "msg"
    first = Section(source, declared.package, declared.short, 0, ends[0], Span(source, 0, 0), declared.folder, kind)
    found = [] if breaks and not first.text.strip() else [first]
    kinds = {each.upper(): each for each in ("msg", *dialect.interfaces, *([dialect.foreign[1:]] if dialect.foreign else []))}
    for line, end in zip(breaks, ends[1:], strict=True):
        header = HEADER.match(source.text, line.end())
        if header is None or header[1] not in kinds:
            problems.append(say.no_section_name(Span(source, line.start(), line.end() - 1), tuple(kinds)))
            continue
        named = Span(source, header.start(2), header.end(2))
        name = _name(header[2], kinds[header[1]], dialect)
        if name is None:
            problems.append(say.wrong_section_name(named, header[2], header[1]))
        else:
            found.append(Section(source, *name[:2], header.end(), max(end, header.end()), named, *name[2:]))
    return found


def _name(written: str, kind: str, dialect: Dialect) -> tuple[str, str, str, str] | None:
    """The package, the last part, the folder and the kind of what a header names."""
    package, short = split(written)
    own = kind if kind in dialect.interfaces else "msg"
    middle = written.split("/")[1:-1]
    folder = "/".join(middle) if middle else own
    folders = (own,) if kind in dialect.interfaces else ("msg", *dialect.interfaces)
    if f".{kind}" == dialect.foreign:
        fits = package.isidentifier() and short.isidentifier()
    else:
        fits = dialect.packages.allows(package) and dialect.messages.allows(short)
    return (package, short, folder, kind) if fits and folder in folders else None
