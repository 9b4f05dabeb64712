"""Checking a mapping, and what is known of one that has no errors: its warnings, and what it guarantees."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import pipeline as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.check.mapping import Checked
from rosetta_jit.parsing.search import Reading, SearchPath
from rosetta_jit.pipeline import mapped
from rosetta_jit.pipeline.declared import readers_of, report
from rosetta_jit.pipeline.depth import within_stack
from rosetta_jit.pipeline.request import Request
from rosetta_jit.startup.cached import cached_property

if TYPE_CHECKING:
    from rosetta_jit.language.laws.guarantees import Laws


class CheckedMapping:
    """A mapping without errors. Iterating over it gives its warnings."""

    def __init__(self, checked: Checked) -> None:
        self.checked = checked

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """The diagnostics of what is suspect, and yet not wrong."""
        return self.checked.warnings

    @property
    def notes(self) -> tuple[Diagnostic, ...]:
        """The decisions that the mapping leaves to the compiler: the fields that `ignore rest` and `default rest` stand for."""
        return self.checked.notes

    @cached_property
    def laws(self) -> Laws | None:
        """What comes back when a message is unpacked and packed, and a holder packed and unpacked; None of a one-way mapping."""
        from rosetta_jit.language.laws.guarantees import laws_of  # who makes a program asks for none

        unpack, pack = self.checked.unpack, self.checked.pack
        return laws_of(unpack, pack, self.checked.holder, self.checked.wire) if unpack and pack else None

    def __repr__(self) -> str:
        count = len(self.warnings)
        warnings = "no warnings" if not count else "1 warning" if count == 1 else f"{count} warnings"
        return f"<mapping between {self.checked.holder.root.name} and {self.checked.wire.root.name}, {warnings}>"

    def __iter__(self) -> Iterator[Diagnostic]:
        return iter(self.warnings)

    def __len__(self) -> int:
        return len(self.warnings)


@within_stack()
def check_mapping(
    path: str,
    folders: Iterable[str] = (),
    parameters: Mapping[str, object] | None = None,
    *,
    schema: Mapping[str, str] | None = None,
    encoding: str | None = None,
    framework: str | None = None,
) -> CheckedMapping:
    """What is known of a mapping; raises MappingError with all that is wrong."""
    search, reading = SearchPath.of(folders, files=schema), Reading()
    request = Request("decode", mapping=path, encoding=encoding, framework=framework)
    readers = readers_of(request)
    known = [name for each in readers.frameworks.values() for name in each.encodings]
    if encoding is not None and encoding not in known:
        raise report(request, words.no_encoding(encoding, known))
    return CheckedMapping(mapped.checked_source(search.open(path), readers, search, reading, parameters))
