"""Names of fields in JSON: no two fields of a message share one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import diagnostics as say
from rosetta_jit.frameworks.protobuf.json_names import camel_case
from rosetta_jit.frameworks.protobuf.proto.options import flag
from rosetta_jit.frameworks.protobuf.proto.symbols import fields_of
from rosetta_jit.frameworks.protobuf.proto.tree import Field

if TYPE_CHECKING:
    from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations, DeclaredMessage


def check_json(declared: Declarations) -> Iterator[Diagnostic]:
    """The names that fields have by default, then those that they have at last; extensions cannot choose."""
    for entry in declared.messages.values():
        if not flag(entry.message.options, "deprecated_legacy_json_field_conflicts"):
            yield from _names(entry, {})
            chosen = {field.name.text: name for field in fields_of(entry.message) for name in chosen_names(field)}
            if chosen:
                yield from _names(entry, chosen)
    for extension in declared.extensions.values():
        for option in extension.field.options:
            if option.parts == ("json_name",):
                yield say.json_name_of_extension(option.span)


def default_name(field: Field) -> str:
    """The name of a field in JSON where it chooses none: `frame_shift` is `frameShift`."""
    return camel_case(field.name.text)


def chosen_names(field: Field) -> Iterator[str]:
    """The name that a field chooses, if it does."""
    for option in field.options:
        if option.parts == ("json_name",) and isinstance(option.value, bytes):
            yield option.value.decode(errors="replace")


def _names(entry: DeclaredMessage, chosen: dict[str, str]) -> Iterator[Diagnostic]:
    """Clashes in which a chosen name is involved, or all where none is; only one of two chosen names is always wrong."""
    seen: dict[str, Field] = {}
    for field in fields_of(entry.message):
        name = chosen.get(field.name.text) or default_name(field)
        first = seen.setdefault(name, field)
        both = (first.name.text in chosen) + (field.name.text in chosen)
        if first is field or first.name.text == field.name.text or (chosen and not both):
            continue
        if both == 2 or entry.features.json_format == "ALLOW":
            yield say.same_json_name(field.name, first.name, name)
