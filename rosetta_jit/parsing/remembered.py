"""What front ends made of the last files: a file that many mappings import is parsed once a process."""

from __future__ import annotations

from collections import OrderedDict
from contextlib import suppress

from rosetta_jit.model.types import Schema
from rosetta_jit.parsing.idl import FrontEnd, Load
from rosetta_jit.parsing.limits import MAX_REMEMBERED, MAX_REMEMBERED_CHARACTERS
from rosetta_jit.source import Source
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class _Parsed:
    """What a source declares, and all that was asked for and found meanwhile."""

    schema: Schema
    loaded: tuple[tuple[str, Source | None], ...]


_parsed: OrderedDict[tuple[FrontEnd, Source], _Parsed] = OrderedDict()
"""The last one is the youngest. Threads share it: each step is one that Python does not interrupt."""


def parsed(front_end: FrontEnd, source: Source, load: Load) -> Schema:
    """What a front end makes of a source, or has made of the same one where all that it loads is as it was."""
    known = _parsed.get((front_end, source))
    if known is not None and all(load(name) == found for name, found in known.loaded):
        with suppress(KeyError):  # another thread has removed it
            _parsed.move_to_end((front_end, source))
        return known.schema
    loaded: list[tuple[str, Source | None]] = []

    def noted(name: str) -> Source | None:
        found = load(name)
        loaded.append((name, found))
        return found

    schema = front_end(source, noted)
    if sum(len(each.text) for each in (source, *(found for _, found in loaded)) if each is not None) <= MAX_REMEMBERED_CHARACTERS:
        _parsed[front_end, source] = _Parsed(schema, tuple(loaded))
        while len(_parsed) > MAX_REMEMBERED:
            _parsed.popitem(last=False)
    return schema
