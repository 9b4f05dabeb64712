"""The options that the language itself has, and those of a field that a schema keeps.

Their names and types are those of google/protobuf/descriptor.proto. Custom options are extensions of the same messages.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import proto as say
from rosetta_jit.frameworks.protobuf.proto.constants import WrongValueError, constant, enum_number, spelled
from rosetta_jit.frameworks.protobuf.proto.scalars import SCALARS
from rosetta_jit.frameworks.protobuf.proto.symbols import enums_of, extends_of, fields_of, messages_of
from rosetta_jit.frameworks.protobuf.proto.tree import MapType, Oneof, Option, Word

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations
    from rosetta_jit.frameworks.protobuf.proto.tree import Field, File
    from rosetta_jit.model.types import Constant

OPTIONS: Mapping[str, Mapping[str, str]] = {
    "FileOptions": {
        "java_package": "string",
        "java_outer_classname": "string",
        "java_multiple_files": "bool",
        "java_generate_equals_and_hash": "bool",
        "java_string_check_utf8": "bool",
        "optimize_for": "SPEED|CODE_SIZE|LITE_RUNTIME",
        "go_package": "string",
        "cc_generic_services": "bool",
        "java_generic_services": "bool",
        "py_generic_services": "bool",
        "deprecated": "bool",
        "cc_enable_arenas": "bool",
        "objc_class_prefix": "string",
        "csharp_namespace": "string",
        "swift_prefix": "string",
        "php_class_prefix": "string",
        "php_namespace": "string",
        "php_metadata_namespace": "string",
        "ruby_package": "string",
        "features": "message",
    },
    "MessageOptions": {
        "message_set_wire_format": "bool",
        "no_standard_descriptor_accessor": "bool",
        "deprecated": "bool",
        "map_entry": "bool",
        "deprecated_legacy_json_field_conflicts": "bool",
        "features": "message",
    },
    "FieldOptions": {
        "default": "any",
        "json_name": "string",
        "ctype": "STRING|CORD|STRING_PIECE",
        "packed": "bool",
        "jstype": "JS_NORMAL|JS_STRING|JS_NUMBER",
        "lazy": "bool",
        "unverified_lazy": "bool",
        "deprecated": "bool",
        "weak": "bool",
        "debug_redact": "bool",
        "retention": "RETENTION_UNKNOWN|RETENTION_RUNTIME|RETENTION_SOURCE",
        "targets": "repeated",
        "edition_defaults": "repeated",
        "features": "message",
        "feature_support": "message",
    },
    "OneofOptions": {"features": "message"},
    "EnumOptions": {
        "allow_alias": "bool",
        "deprecated": "bool",
        "deprecated_legacy_json_field_conflicts": "bool",
        "features": "message",
    },
    "EnumValueOptions": {
        "deprecated": "bool",
        "features": "message",
        "debug_redact": "bool",
        "feature_support": "message",
    },
    "ServiceOptions": {"features": "message", "deprecated": "bool"},
    "MethodOptions": {
        "deprecated": "bool",
        "idempotency_level": "IDEMPOTENCY_UNKNOWN|NO_SIDE_EFFECTS|IDEMPOTENT",
        "features": "message",
    },
}
"""Options by the message that holds them; alternatives are the values of an enum."""

RESOLVED = frozenset(("default", "json_name", "packed"))
"""Options that become something else than an option of the model."""


def field_options(field: Field, declared: Declarations) -> tuple[tuple[str, Constant], ...]:
    """The options of a field that have one scalar value, as sorted pairs `("option.name", value)`."""
    pairs = [
        (f"option.{option.name.replace('(.', '(')}", value)
        for option in field.options
        if option.name not in RESOLVED
        for value in _values("FieldOptions", option, declared)
    ]
    return tuple(sorted(dict(pairs).items()))


def flag(options: tuple[Option, ...], name: str) -> bool | None:
    """A boolean option; None where it is not set."""
    for option in options:
        if option.parts == (name,):
            return option.value == Word("true")
    return None


def check_options(declared: Declarations) -> Iterator[Diagnostic]:
    """Every option exists, has a value of its type, and is set once."""
    for file in declared.files:
        for holder, options in _options_of(file):
            yield from _check(holder, options, declared)


def _check(holder: str, options: tuple[Option, ...], declared: Declarations) -> Iterator[Diagnostic]:
    seen: set[str] = set()
    for option in options:
        type_ = _type(holder, option, declared)
        if option.parts[0] == "()":
            continue
        if type_ is None:
            yield say.unknown_option(option.span, option.name, holder)
            continue
        if option.name in seen and type_ != "repeated":
            yield say.repeated_option(option.span, option.name)
        seen.add(option.name)
        try:
            list(_values(holder, option, declared))
        except WrongValueError as error:
            yield say.wrong_option(option.span, option.name, str(error.args[0]), spelled(option.value))


def _values(holder: str, option: Option, declared: Declarations) -> Iterator[Constant]:
    """The value of an option, where it is one scalar."""
    type_ = _type(holder, option, declared)
    if len(option.parts) > 1 or type_ in (None, "repeated", "message", "any"):
        return
    if type_ in SCALARS:
        yield constant(SCALARS[type_], option.value)
    elif type_.startswith("."):
        entry = declared.enums[type_[1:]]
        enum_number(entry.numbers, option.value)
        yield spelled(option.value)
    else:
        yield _choice(type_, option)


def _choice(alternatives: str, option: Option) -> str:
    if not isinstance(option.value, Word) or option.value.text not in alternatives.split("|"):
        raise WrongValueError("one of " + ", ".join(f"`{word}`" for word in alternatives.split("|")))
    return option.value.text


def _type(holder: str, option: Option, declared: Declarations) -> str | None:
    """The word of an option's type: of a scalar, an absolute enum, `message`, `repeated`, or alternatives."""
    first = option.parts[0]
    if not first.startswith("("):
        return OPTIONS[holder].get(first)
    extension = declared.extensions.get(first[2:-1])
    if extension is None or extension.extendee.text != f".google.protobuf.{holder}":
        return None
    type_ = extension.field.type
    if extension.field.label == "repeated":
        return "repeated"
    if isinstance(type_, MapType) or not (type_.text in SCALARS or type_.text[1:] in declared.enums):
        return "message"
    return type_.text


def _options_of(file: File) -> Iterator[tuple[str, tuple[Option, ...]]]:
    """Every list of options of a file, with the message that defines them."""
    yield "FileOptions", file.options
    for _, message in messages_of(file):
        yield "MessageOptions", message.options
        for field in fields_of(message):
            yield "FieldOptions", field.options
        for member in message.members:
            if isinstance(member, Oneof):
                yield "OneofOptions", member.options
    for _, enum in enums_of(file):
        yield "EnumOptions", enum.options
        for value in enum.values:
            yield "EnumValueOptions", value.options
    for _, extend in extends_of(file):
        for field in extend.fields:
            yield "FieldOptions", field.options
    for service in file.services:
        yield "ServiceOptions", service.options
        for method in service.methods:
            yield "MethodOptions", method.options
