"""Features: they exist, have values that can be chosen, where they can be, and mean something there.

https://protobuf.dev/editions/features/
"""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import diagnostics as say
from rosetta_jit.frameworks.protobuf import edition_diagnostics as say_edition
from rosetta_jit.frameworks.protobuf.proto.constants import spelled
from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations, DeclaredField, fields_in, file_features
from rosetta_jit.frameworks.protobuf.proto.features import FEATURES, Choice, choices, chosen_word, own
from rosetta_jit.frameworks.protobuf.proto.options import options_of, type_at
from rosetta_jit.frameworks.protobuf.proto.scalars import SCALARS, is_packable
from rosetta_jit.frameworks.protobuf.proto.tree import EDITIONS, Field, MapType, Option, Version


def check_features(declared: Declarations) -> Iterator[Diagnostic]:
    """Every choice of a feature, and what it means for the field that makes it."""
    for file in declared.files:
        for holder, options in options_of(file):
            for option in options:
                yield from _option(option, file.version)
            if file.version in EDITIONS:
                for choice in choices(options):
                    yield from _choice(holder, choice, declared)
        if file_features(file).field_presence == "LEGACY_REQUIRED":
            yield from (say_edition.required_by_default(option.span) for option in file.options if "field_presence" in own((option,)))
    for message in declared.messages.values():
        for field in fields_in(message):
            yield from _field(field, declared)
    for extension in declared.extensions.values():
        yield from _field(extension.entry, declared)


def _option(option: Option, version: Version) -> Iterator[Diagnostic]:
    if version not in EDITIONS:
        if option.parts[0] == "features":
            yield say_edition.features_before_editions(option.span)
        return
    paths = [choice.path for choice in choices((option,))]
    if len(set(paths)) < len(paths):
        yield say.repeated_option(option.span, option.name)


def _choice(holder: str, choice: Choice, declared: Declarations) -> Iterator[Diagnostic]:
    span = choice.option.span
    name = ".".join(("features", *choice.path)).replace("(.", "(")
    if "()" in choice.path:
        return
    if not choice.path:
        yield say.wrong_option(span, name, "a message in braces", spelled(choice.value))
        return
    type_ = type_at("FeatureSet", choice.path, declared)
    feature = FEATURES.get(choice.path[0])
    if type_ is None:
        yield say_edition.unknown_feature(span, name)
    elif feature is None:
        return  # of another language's generator, or for protoc alone: it changes no byte
    elif chosen_word(feature, choice) is None:
        yield say.wrong_option(span, name, "one of " + ", ".join(f"`{word}`" for word in feature.values), spelled(choice.value))
    elif holder not in feature.targets:
        yield say_edition.feature_elsewhere(span, name, sorted(feature.targets))


def _field(entry: DeclaredField, declared: Declarations) -> Iterator[Diagnostic]:
    """What a field chooses is about a field like it."""
    if entry.version not in EDITIONS:
        return
    for option in entry.field.options:
        for name, word in own((option,)).items():
            reason = _reason(entry, name, word, declared)
            if reason:
                yield say_edition.idle_feature(option.span, name, word, entry.field.name.text, reason)


def _reason(entry: DeclaredField, name: str, word: str, declared: Declarations) -> str | None:
    """Why a feature cannot be chosen for a field; None where it can."""
    field = entry.field
    match name:
        case "field_presence" if entry.repeated:
            return "it is repeated"
        case "field_presence" if entry.place != "message":
            return "it is in a oneof" if entry.place == "oneof" else "it is an extension"
        case "field_presence" if word == "IMPLICIT" and _kind(field, declared) == "message":
            return "it is a message"
        case "repeated_field_encoding" if not entry.repeated:
            return "it is not repeated"
        case "repeated_field_encoding" if word == "PACKED" and _kind(field, declared) != "number":
            return "only repeated numbers, bools and enums can be packed"
        case "utf8_validation" if "string" not in _words(field):
            return "it holds no strings"
        case "message_encoding" if _kind(field, declared) != "message":
            return "it is no message"
        case _:
            return None


def _kind(field: Field, declared: Declarations) -> str:
    """What the wire tells apart: a message, a number, or something else."""
    if isinstance(field.type, MapType):
        return "map"
    word = field.type.text
    if word in SCALARS:
        return "number" if is_packable(word) else "text"
    return "number" if word[1:] in declared.enums else "message"


def _words(field: Field) -> tuple[str, ...]:
    return (field.type.key.text, field.type.value.text) if isinstance(field.type, MapType) else (field.type.text,)
