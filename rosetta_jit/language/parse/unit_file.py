"""Side files of units: which fields of which types are measured in what, for IDLs that cannot say so.

    File  = Line*                   `#` starts a comment
    Line  = type ":"                the fields that follow are of this type, named as its framework names it
          | path ":" unit ("," unit)*
    path  = (.name | [number] | [])+      `[]` is each element; of several units each is for one of the first elements

The text is read line by line; what is wrong with one line does not keep the others.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from rosetta_jit.catalogue import unit_files as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.limits import MAX_UNIT_FIELDS, MAX_UNIT_PROBLEMS, MAX_UNIT_STEPS
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass

TYPE = re.compile(r'("[^"\n]+"|[A-Za-z_](?:[\w.:/]*\w)?)[ \t]*:')
STEP = re.compile(r'\.(?:([A-Za-z_]\w*)|"([^"\n]+)")|\[([0-9]{0,9})\]')
UNIT = re.compile(r"[^,]*")
BLANKS = re.compile(r"[ \t\r]*")


@dataclass(frozen=True, slots=True)
class Named:
    """Characters that name something, and where they are."""

    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class Step:
    """A step of a path: the name of a member, the number of an element, None for each element."""

    to: str | int | None
    span: Span


@dataclass(frozen=True, slots=True)
class UnitsOf:
    """The units of a field, or of the elements of one."""

    type: Named
    path: tuple[Step, ...]
    units: tuple[Named, ...]


@dataclass(frozen=True, slots=True)
class UnitFile:
    """What a side file says."""

    source: Source
    types: tuple[Named, ...]
    fields: tuple[UnitsOf, ...]


def parse(source: Source, problems: list[Diagnostic]) -> UnitFile:
    """Read a side file; the problems are added to those given."""
    reader = _Reader(source, [], [], [])
    at = 0
    for line in source.text.split("\n"):
        if len(reader.problems) >= MAX_UNIT_PROBLEMS:
            break
        reader.line(at, at + len(line.partition("#")[0].rstrip()))
        at += len(line) + 1
    problems += reader.problems
    return UnitFile(source, tuple(reader.types), tuple(reader.fields))


@dataclass(frozen=True, slots=True)
class _Reader:
    source: Source
    types: list[Named]
    fields: list[UnitsOf]
    problems: list[Diagnostic]

    def line(self, start: int, end: int) -> None:
        start = self.behind_blanks(start, end)
        if start == end:
            return
        head = TYPE.fullmatch(self.source.text, start, end)
        if max(len(self.types), len(self.fields)) == MAX_UNIT_FIELDS:
            self.problems[:] = [words.too_many(self.span(start, end), MAX_UNIT_FIELDS)]
        elif head is not None:
            self.types.append(Named(head[1].strip('"'), self.span(head.start(1), head.end(1))))
        elif self.source.text[start] not in ".[" or not self.types:
            self.problems.append(words.no_line(self.span(start, end), first=not self.types))
        else:
            self.field(start, end)

    def field(self, start: int, end: int) -> None:
        path: list[Step] = []
        at = start
        while (step := STEP.match(self.source.text, at, end)) is not None and len(path) <= MAX_UNIT_STEPS:
            path.append(Step(_to(step), self.span(at, step.end())))
            at = step.end()
        colon = self.behind_blanks(at, end)
        if not path or len(path) > MAX_UNIT_STEPS or self.source.text[colon:end][:1] != ":":
            self.problems.append(words.no_path(self.span(at, max(at + 1, end))))
            return
        units = tuple(self.units(colon + 1, end))
        empty = next((unit for unit in units if not unit.text), None)
        if empty is not None:
            self.problems.append(words.no_unit(empty.span))
        else:
            self.fields.append(UnitsOf(self.types[-1], tuple(path), units))

    def units(self, start: int, end: int) -> Iterator[Named]:
        at = start
        while at <= end:
            found = UNIT.match(self.source.text, at, end)
            assert found is not None
            begin = self.behind_blanks(at, found.end())
            text = self.source.text[begin : found.end()].rstrip()
            yield Named(text, self.span(begin, begin + max(1, len(text))))
            at = found.end() + 1

    def behind_blanks(self, start: int, end: int) -> int:
        blanks = BLANKS.match(self.source.text, start, end)
        assert blanks is not None
        return blanks.end()

    def span(self, start: int, end: int) -> Span:
        return Span(self.source, start, end)


def _to(step: re.Match[str]) -> str | int | None:
    if step[3] is not None:
        return int(step[3]) if step[3] else None
    return step[1] or step[2]
