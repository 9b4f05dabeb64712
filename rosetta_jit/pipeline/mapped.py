"""What a program with a mapping has besides: the mapping, checked, its two types, and the rules between them for a direction.

Programs of a type into its own holder, as most of logs are, import nothing of the language.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import pipeline as words
from rosetta_jit.catalogue import wires
from rosetta_jit.errors import MappingError
from rosetta_jit.frameworks.installed import Readers
from rosetta_jit.language.check.mapping import Checked, check
from rosetta_jit.language.installed import GROUP
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.lowering.mapped import Mapped
from rosetta_jit.model.layout import Layout
from rosetta_jit.model.types import Ref, Schema
from rosetta_jit.parsing.search import Reading, SearchPath
from rosetta_jit.pipeline.declared import Files, readers_of
from rosetta_jit.pipeline.request import Request
from rosetta_jit.pipeline.types import Types
from rosetta_jit.source import Source
from rosetta_jit.startup.entry_points import files_of_offered
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.pipeline import wires as several_wires
else:
    several_wires = Late("rosetta_jit.pipeline.wires")


def checked(request: Request, sources: Files) -> Checked:
    """The mapping of a request, with its parameters."""
    source = sources.search.open(request.mapping or "")
    sources.reading.record(source.name, None, source)
    return checked_source(source, readers_of(request), sources.search, sources.reading, request.values)


def checked_source(
    source: Source, readers: Readers, search: SearchPath, reading: Reading, parameters: Mapping[str, object] | None
) -> Checked:
    """A mapping, with all that it imports."""
    return check(parse(source), readers, search, reading, parameters)


def types_of(request: Request, checked: Checked) -> Types:
    """The types of a mapping, and its rules for the direction of a request."""
    rules = checked.unpack if request.direction == "decode" else checked.pack
    if rules is None or not rules:
        raise MappingError((words.no_rules(checked.mapping.wire_span, request.direction),))
    if checked.mapping.wires:
        return several_wires.types_of_wire(checked, request, _both(checked), rules)
    if request.wire is not None:
        span = checked.mapping.wire_span
        raise MappingError((wires.unknown(span, request.wire, ()) if request.wire else wires.single(span),))
    return Types(checked.holder.root, checked.wire.root, _both(checked), rules, checked.functions, checked.state)


def _both(checked: Checked) -> Schema:
    holder, wire = checked.holder.schema, checked.wire.schema
    return Schema({**holder.types, **wire.types}, constants={**holder.constants, **wire.constants})


def between(types: Types, wire: Layout) -> Mapped | None:
    """What the types of a program say of the rules between them; None where it has none."""
    if types.rules is None:
        return None
    ends = Ref(types.holder.name), Ref(types.wire.name)
    return Mapped(types.rules, types.schema, *ends, wire, registers=types.registers, share=types.share)


def files_of_functions() -> tuple[str, ...]:
    """The files of installed packages whose functions a mapping may call."""
    return files_of_offered(GROUP)
