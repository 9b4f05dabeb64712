"""The definitions of a service or an action: those in its text, between lines of ``---``, and those that peers make for them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.ros import diagnostics as say
from rosetta_jit.source import Source, Span

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.ros.dialect import Dialect, Interface
    from rosetta_jit.frameworks.ros.sections import Section


def parts(whole: Section, dialect: Dialect, problems: list[Diagnostic]) -> list[Section]:
    """The definitions of a service or an action, which may not have another number of parts than its kind has."""
    interface, source = dialect.interfaces[whole.kind], whole.source
    dashes = list(dialect.dashes.finditer(source.text, whole.start, whole.end))
    if len(dashes) != len(interface.parts) - 1:
        place = dashes[len(interface.parts) - 1] if len(dashes) >= len(interface.parts) else None
        span = Span(source, place.start(), place.end()) if place else Span(source, whole.start, whole.start)
        problems.append(say.wrong_parts(span, whole.kind, len(dashes), len(interface.parts) - 1))
        return []
    starts, ends = [whole.start, *(each.end() for each in dashes)], [*(each.start() for each in dashes), whole.end]
    names = [each.format(whole.short) for each in interface.parts]
    written = [replace(whole, short=name, start=start, end=end, kind="msg") for name, start, end in zip(names, starts, ends, strict=True)]
    return [*written, *_added(whole, interface, _local(whole, interface, dialect))]


def _added(whole: Section, interface: Interface, local: Mapping[str, str]) -> Iterator[Section]:
    """What stands in no file: texts of their own, which a report about them shows."""
    for name, text in interface.added.items():
        own = Source(whole.source.name, text.format(whole.short))
        short, span = name.format(whole.short), Span(own, 0, 0)
        yield replace(whole, source=own, short=short, start=0, end=len(own.text), named=span, kind="msg", local=local)


def _local(whole: Section, interface: Interface, dialect: Dialect) -> Mapping[str, str]:
    names = [each.format(whole.short) for each in (*interface.parts, *interface.added)]
    return {name: dialect.message(whole.package, name, whole.folder) for name in names}
