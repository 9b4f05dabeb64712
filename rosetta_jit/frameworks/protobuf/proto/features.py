"""What a file, a message, a field or an enum can choose in an edition, and what holds where nothing is chosen.

An edition is its defaults. proto2 and proto3 are editions whose defaults nobody can change; what they say by labels, groups
and `packed` is a choice too. A choice holds for everything within the declaration that makes it.
https://protobuf.dev/editions/features/
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Literal

from rosetta_jit.frameworks.protobuf.proto.tree import Aggregate, Field, Option, Value, Version, Word
from rosetta_jit.startup.dataclass import dataclass, replace


@dataclass(frozen=True, slots=True)
class Features:
    """One choice for each feature."""

    field_presence: Literal["EXPLICIT", "IMPLICIT", "LEGACY_REQUIRED"]
    enum_type: Literal["OPEN", "CLOSED"]
    repeated_field_encoding: Literal["PACKED", "EXPANDED"]
    utf8_validation: Literal["VERIFY", "NONE"]
    message_encoding: Literal["LENGTH_PREFIXED", "DELIMITED"]
    json_format: Literal["ALLOW", "LEGACY_BEST_EFFORT"]


@dataclass(frozen=True, slots=True)
class Feature:
    """The choices of a feature with their numbers, and the options messages that can make them."""

    values: Mapping[str, int]
    targets: frozenset[str]


_PROTO2 = Features(
    field_presence="EXPLICIT",
    enum_type="CLOSED",
    repeated_field_encoding="EXPANDED",
    utf8_validation="NONE",
    message_encoding="LENGTH_PREFIXED",
    json_format="LEGACY_BEST_EFFORT",
)
_PROTO3 = replace(
    _PROTO2,
    field_presence="IMPLICIT",
    enum_type="OPEN",
    repeated_field_encoding="PACKED",
    utf8_validation="VERIFY",
    json_format="ALLOW",
)
_2023 = replace(_PROTO3, field_presence="EXPLICIT")

DEFAULTS: Mapping[Version, Features] = {"proto2": _PROTO2, "proto3": _PROTO3, "2023": _2023, "2024": _2023}

_FIELDS = frozenset(("FileOptions", "FieldOptions"))

FEATURES: Mapping[str, Feature] = {
    "field_presence": Feature({"EXPLICIT": 1, "IMPLICIT": 2, "LEGACY_REQUIRED": 3}, _FIELDS),
    "enum_type": Feature({"OPEN": 1, "CLOSED": 2}, frozenset(("FileOptions", "EnumOptions"))),
    "repeated_field_encoding": Feature({"PACKED": 1, "EXPANDED": 2}, _FIELDS),
    "utf8_validation": Feature({"VERIFY": 2, "NONE": 3}, _FIELDS),
    "message_encoding": Feature({"LENGTH_PREFIXED": 1, "DELIMITED": 2}, _FIELDS),
    "json_format": Feature({"ALLOW": 1, "LEGACY_BEST_EFFORT": 2}, frozenset(("FileOptions", "MessageOptions", "EnumOptions"))),
}
"""google.protobuf.FeatureSet, by the names of its fields. Its values of 0 stand for nothing and cannot be chosen."""

FOR_PROTOC = ("enforce_naming_style", "default_symbol_visibility")
"""Features that change no byte: how names are spelt, and which declarations other files may name. protoc holds files to them."""


@dataclass(frozen=True, slots=True)
class Choice:
    """The value that an option gives to a feature, by its path in the FeatureSet: `(.pb.cpp)`, `string_type`."""

    path: tuple[str, ...]
    value: Value
    option: Option
    aggregate: bool


def choices(options: tuple[Option, ...]) -> Iterator[Choice]:
    """What some options say of features, known or not."""
    for option in options:
        if option.parts[0] == "features":
            yield from _choices(Choice(option.parts[1:], option.value, option, aggregate=False))


def choose(inherited: Features, options: tuple[Option, ...]) -> Features:
    """The features of a declaration with some options; what is wrong with these is no choice."""
    chosen = own(options)
    return replace(inherited, **chosen) if chosen else inherited


def own(options: tuple[Option, ...]) -> dict[str, str]:
    """The features that a declaration's own options choose."""
    found: dict[str, str] = {}
    for choice in choices(options):
        name = choice.path[0] if len(choice.path) == 1 else ""
        word = chosen_word(FEATURES[name], choice) if name in FEATURES else None
        if word:
            found[name] = word
    return found


def chosen_word(feature: Feature, choice: Choice) -> str | None:
    """The word for what is chosen; in text format its number does too."""
    match choice.value:
        case Word(text) if text in feature.values:
            return text
        case int(number) if choice.aggregate:
            return next((word for word, known in feature.values.items() if known == number), None)
        case _:
            return None


def choose_for_field(inherited: Features, field: Field) -> Features:
    """The features of a field: those that it chooses, and what older versions say in another way."""
    said: dict[str, str] = {}
    if field.label in ("optional", "required"):
        said["field_presence"] = "LEGACY_REQUIRED" if field.label == "required" else "EXPLICIT"
    if field.group:
        said["message_encoding"] = "DELIMITED"
    for option in field.options:
        if option.parts == ("packed",):
            said["repeated_field_encoding"] = "PACKED" if option.value == Word("true") else "EXPANDED"
    return choose(replace(inherited, **said) if said else inherited, field.options)


def _choices(choice: Choice) -> Iterator[Choice]:
    if not isinstance(choice.value, Aggregate):
        yield choice
        return
    for entry in choice.value.entries:
        yield from _choices(Choice((*choice.path, entry.name), entry.value, choice.option, aggregate=True))
