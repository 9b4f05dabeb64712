"""The options that the language itself has, and those of a field that a schema keeps.

Their names and types are those of google/protobuf/descriptor.proto. Custom options are extensions of the same messages.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import diagnostics as say
from rosetta_jit.frameworks.protobuf.proto.constants import WrongValueError, constant, enum_number, spelled
from rosetta_jit.frameworks.protobuf.proto.features import FEATURES, FOR_PROTOC
from rosetta_jit.frameworks.protobuf.proto.scalars import SCALARS
from rosetta_jit.frameworks.protobuf.proto.symbols import enums_of, extends_of, fields_of, messages_of
from rosetta_jit.frameworks.protobuf.proto.tree import Aggregate, Field, File, MapType, Oneof, Option, Value, Word
from rosetta_jit.model.types import Constant

if TYPE_CHECKING:
    from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations

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
        "features": "FeatureSet",
    },
    "MessageOptions": {
        "message_set_wire_format": "bool",
        "no_standard_descriptor_accessor": "bool",
        "deprecated": "bool",
        "map_entry": "bool",
        "deprecated_legacy_json_field_conflicts": "bool",
        "features": "FeatureSet",
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
        "features": "FeatureSet",
        "feature_support": "message",
    },
    "OneofOptions": {"features": "FeatureSet"},
    "ExtensionRangeOptions": {"declaration": "repeated", "features": "FeatureSet", "verification": "DECLARATION|UNVERIFIED"},
    "EnumOptions": {
        "allow_alias": "bool",
        "deprecated": "bool",
        "deprecated_legacy_json_field_conflicts": "bool",
        "features": "FeatureSet",
    },
    "EnumValueOptions": {
        "deprecated": "bool",
        "features": "FeatureSet",
        "debug_redact": "bool",
        "feature_support": "message",
    },
    "ServiceOptions": {"features": "FeatureSet", "deprecated": "bool"},
    "MethodOptions": {
        "deprecated": "bool",
        "idempotency_level": "IDEMPOTENCY_UNKNOWN|NO_SIDE_EFFECTS|IDEMPOTENT",
        "features": "FeatureSet",
    },
}
"""Options by the message that holds them; alternatives are the values of an enum."""

TABLES = {
    **OPTIONS,
    "FeatureSet": {name: "|".join(feature.values) for name, feature in FEATURES.items()} | dict.fromkeys(FOR_PROTOC, "any"),
}
"""The same with the message of features, which options hold."""

RESOLVED = frozenset(("default", "json_name", "packed"))
"""Options that become something else than an option of the model."""


def field_options(field: Field, declared: Declarations) -> tuple[tuple[str, Constant], ...]:
    """The options of a field that have one scalar value, as sorted pairs `("option.name", value)`."""
    pairs = [
        (f"option.{option.name.replace('(.', '(')}", value)
        for option in field.options
        if option.name not in RESOLVED
        if len(option.parts) == 1
        for value in values(type_at("FieldOptions", option.parts, declared) or "message", option.value, declared)
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
        for holder, options in options_of(file):
            yield from _check(holder, options, declared)


def _check(holder: str, options: tuple[Option, ...], declared: Declarations) -> Iterator[Diagnostic]:
    seen: set[tuple[str, ...]] = set()
    for option in options:
        if "()" in option.parts:
            continue
        type_ = type_at(holder, option.parts, declared)
        if option.parts in seen and type_ != "repeated":
            yield say.repeated_option(option.span, option.name)
        seen.update(_set_paths(option.parts, option.value))
        # What is said of features is checked with them.
        if option.parts[0] == "features":
            continue
        if type_ is None:
            yield say.unknown_option(option.span, option.name, holder)
            continue
        try:
            list(values(type_, option.value, declared))
        except WrongValueError as error:
            yield say.wrong_option(option.span, option.name, str(error.args[0]), spelled(option.value))


def _set_paths(parts: tuple[str, ...], value: Value) -> Iterator[tuple[str, ...]]:
    """What is set once an option is: it, what holds it, and what its value says."""
    yield from (parts[:count] for count in range(1, len(parts) + 1))
    if isinstance(value, Aggregate):
        for entry in value.entries:
            yield from _set_paths((*parts, entry.name), entry.value)


def values(type_: str, value: Value, declared: Declarations) -> Iterator[Constant]:
    """The value of an option of some type, where it is one scalar; raises WrongValueError."""
    if type_ in SCALARS:
        yield constant(SCALARS[type_], value)
    elif type_[1:] in declared.enums:
        enum_number(declared.enums[type_[1:]].numbers, value)
        yield spelled(value)
    elif "|" in type_:
        yield _alternative(type_, value)


def _alternative(alternatives: str, value: Value) -> str:
    if not isinstance(value, Word) or value.text not in alternatives.split("|"):
        raise WrongValueError("one of " + ", ".join(f"`{word}`" for word in alternatives.split("|")))
    return value.text


def type_at(holder: str, parts: tuple[str, ...], declared: Declarations) -> str | None:
    """The word of the type that an option's name leads to, from the options message that holds it; None where it leads nowhere.

    It is that of a scalar, an absolute message or enum, a table above, alternatives, or `repeated`, `message`, `any`.
    """
    type_ = holder
    for part in parts:
        if type_ in ("repeated", "message", "any"):
            return "message"
        found = _extension(type_, part, declared) if part.startswith("(") else _own(type_, part, declared)
        if found is None:
            return None
        type_ = found
    return type_


def _extension(type_: str, part: str, declared: Declarations) -> str | None:
    extension = declared.extensions.get(part[2:-1])
    extended = f".google.protobuf.{type_}" if type_ in TABLES else type_
    return None if extension is None or extension.extendee.text != extended else _word(extension.field)


def _own(type_: str, part: str, declared: Declarations) -> str | None:
    if type_ in TABLES:
        return TABLES[type_].get(part)
    message = declared.messages.get(type_[1:])
    return None if message is None or part not in message.fields else _word(message.fields[part])


def _word(field: Field) -> str:
    if isinstance(field.type, MapType) or field.label == "repeated":
        return "repeated"
    return field.type.text or "message"


def options_of(file: File) -> Iterator[tuple[str, tuple[Option, ...]]]:
    """Every list of options of a file, with the message that defines them."""
    yield "FileOptions", file.options
    for _, message in messages_of(file):
        yield "MessageOptions", message.options
        yield "ExtensionRangeOptions", message.extension_options
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
