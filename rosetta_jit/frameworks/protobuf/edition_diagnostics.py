"""What can be wrong with editions in a `.proto` file: features, visibility, and what editions no longer have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic, Mistake, error

if TYPE_CHECKING:
    from rosetta_jit.frameworks.protobuf.diagnostics import Name
    from rosetta_jit.source import Span


def unknown_edition(span: Span, value: str) -> Diagnostic:
    return error("edition", f"the edition {value[:40]!r} is not known", span, "unknown", 'Use "2023" or "2024".')


def label_in_edition(span: Span | None, label: str) -> Diagnostic:
    help_ = "Leave it out: fields are optional unless they choose another presence."
    if label == "required":
        help_ = "Write `[features.field_presence = LEGACY_REQUIRED]` behind the number."
    return error("label", f"editions have no {label} fields", span, "not in an edition", help_)


def group_in_edition(name: Name) -> Diagnostic:
    help_ = "Declare a message and a field of its type with `[features.message_encoding = DELIMITED]`."
    return error("group", "editions have no groups", name.span, "not in an edition", help_)


def closed_implicit(name: Name, enum: str) -> Diagnostic:
    help_ = "Choose another `features.field_presence` for the field, or OPEN for the enum."
    return error("closed-enum", f"implicit presence needs an open enum, and `{enum}` is closed", name.span, "has implicit presence", help_)


default_of_implicit = Mistake(
    "default",
    "a field of implicit presence has no default",
    "it is 0 or empty where it is not set",
    help="Choose EXPLICIT as its `features.field_presence`.",
)
features_before_editions = Mistake(
    "feature", "features need an edition", "not here", help='Write `edition = "2023";` instead of the syntax.'
)


def unknown_feature(span: Span | None, name: str) -> Diagnostic:
    return error("feature", f"there is no feature `{name[:100]}`", span, "unknown")


def feature_elsewhere(span: Span | None, name: str, targets: Sequence[str]) -> Diagnostic:
    places = ", ".join(target.removesuffix("Options").lower() for target in targets)
    return error("feature", f"`{name}` cannot be chosen here", span, f"expected in the options of: {places}")


def idle_feature(span: Span | None, name: str, word: str, field: str, reason: str) -> Diagnostic:
    return error("feature", f"`{field}` cannot choose {word} as its `features.{name}`", span, reason)


required_by_default = Mistake(
    "feature", "fields are not required by default", "for a whole file", help="Choose LEGACY_REQUIRED for single fields."
)
