"""The definitions of a service or an action: those in its file, between lines of ``---``, and those that peers make for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import ros as say
from rosetta_jit.frameworks.ros.sections import Section
from rosetta_jit.source import Source, Span

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.ros.dialect import Dialect, Interface
    from rosetta_jit.frameworks.ros.names import Declared


def parts(source: Source, declared: Declared, dialect: Dialect, problems: list[Diagnostic]) -> list[Section]:
    """The definitions of a file, which may not have another number of parts than its kind has."""
    interface = dialect.interfaces[declared.folder]
    dashes = list(dialect.dashes.finditer(source.text))
    if len(dashes) != len(interface.parts) - 1:
        place = dashes[len(interface.parts) - 1] if len(dashes) >= len(interface.parts) else None
        span = Span(source, place.start(), place.end()) if place else Span(source, 0, 0)
        problems.append(say.wrong_parts(span, declared.folder, len(dashes), len(interface.parts) - 1))
        return []
    starts, ends = [0, *(each.end() for each in dashes)], [*(each.start() for each in dashes), len(source.text)]
    names = [each.format(declared.short) for each in interface.parts]
    written = [
        Section(source, declared.package, name, start, end, Span(source, 0, 0), declared.folder)
        for name, start, end in zip(names, starts, ends, strict=True)
    ]
    return [*written, *_added(source, declared, interface, _local(declared, interface, dialect))]


def _added(source: Source, declared: Declared, interface: Interface, local: Mapping[str, str]) -> Iterator[Section]:
    """What stands in no file: texts of their own, which a report about them shows."""
    for name, text in interface.added.items():
        own = Source(source.name, text.format(declared.short))
        yield Section(own, declared.package, name.format(declared.short), 0, len(own.text), Span(own, 0, 0), declared.folder, local)


def _local(declared: Declared, interface: Interface, dialect: Dialect) -> Mapping[str, str]:
    names = [each.format(declared.short) for each in (*interface.parts, *interface.added)]
    return {name: dialect.message(declared.package, name, declared.folder) for name in names}
