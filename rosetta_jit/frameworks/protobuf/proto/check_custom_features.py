"""Features of one language: fields of messages that extend the FeatureSet.

Where such a feature can be chosen, and since which edition, is told by the options of its field.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.frameworks.protobuf import diagnostics as say
from rosetta_jit.frameworks.protobuf import edition_diagnostics as say_edition
from rosetta_jit.frameworks.protobuf.proto.constants import WrongValueError, spelled
from rosetta_jit.frameworks.protobuf.proto.options import values
from rosetta_jit.frameworks.protobuf.proto.tree import EDITIONS, Aggregate, Name, Word

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.protobuf.proto.declarations import Declarations
    from rosetta_jit.frameworks.protobuf.proto.features import Choice
    from rosetta_jit.frameworks.protobuf.proto.tree import Field, Version

TARGETS = {
    "FileOptions": "TARGET_TYPE_FILE",
    "ExtensionRangeOptions": "TARGET_TYPE_EXTENSION_RANGE",
    "MessageOptions": "TARGET_TYPE_MESSAGE",
    "FieldOptions": "TARGET_TYPE_FIELD",
    "OneofOptions": "TARGET_TYPE_ONEOF",
    "EnumOptions": "TARGET_TYPE_ENUM",
    "EnumValueOptions": "TARGET_TYPE_ENUM_ENTRY",
    "ServiceOptions": "TARGET_TYPE_SERVICE",
    "MethodOptions": "TARGET_TYPE_METHOD",
}
"""google.protobuf.FieldOptions.OptionTargetType, by the options messages."""
BEFORE_EDITIONS = frozenset(("LEGACY", "PROTO2", "PROTO3"))


def check_custom_feature(
    holder: str, choice: Choice, name: str, type_: str, version: Version, declared: Declarations
) -> Iterator[Diagnostic]:
    """A choice that an options message makes, of a feature of some type."""
    span = choice.option.span
    wanted = _wanted(choice, type_, declared)
    if wanted:
        yield say.wrong_option(span, name, wanted, spelled(choice.value))
    field = _field(choice, declared)
    if field is None:
        return
    for since in _introduced(field):
        if since not in BEFORE_EDITIONS and (since not in EDITIONS or version < since):
            yield say_edition.early_feature(span, name, since)
    targets = {option.value.text for option in field.options if option.parts == ("targets",) and isinstance(option.value, Word)}
    if targets and TARGETS[holder] not in targets:
        yield say_edition.feature_elsewhere(span, name, sorted(each for each, target in TARGETS.items() if target in targets))


def _wanted(choice: Choice, type_: str, declared: Declarations) -> str | None:
    """What would be a value of the type, if this is none."""
    if type_[1:] in declared.messages:
        return None if isinstance(choice.value, Aggregate) else "a message in braces"
    try:
        # In text format an enum can be given by its number too, a bool by more words.
        if not choice.aggregate:
            list(values(type_, choice.value, declared))
    except WrongValueError as error:
        return str(error.args[0])
    return None


def _field(choice: Choice, declared: Declarations) -> Field | None:
    """The field that is the feature."""
    extension = declared.extensions.get(choice.path[0][2:-1])
    if extension is None or len(choice.path) != 2 or not isinstance(extension.field.type, Name):
        return None
    message = declared.messages.get(extension.field.type.text[1:])
    return message.fields.get(choice.path[1]) if message else None


def _introduced(field: Field) -> Iterator[str]:
    for option in field.options:
        if option.parts == ("feature_support",) and isinstance(option.value, Aggregate):
            for entry in option.value.entries:
                if entry.name == "edition_introduced" and isinstance(entry.value, Word):
                    yield entry.value.text.removeprefix("EDITION_")
