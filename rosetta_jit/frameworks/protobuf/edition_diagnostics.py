"""What can be wrong with editions in a `.proto` file: features, visibility, and what editions no longer have."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rosetta_jit.frameworks.protobuf.diagnostics import Name
    from rosetta_jit.source import Span


def _error(code: str, message: str, span: Span | None, label: str, help_: str = "") -> Diagnostic:
    return Diagnostic("error", code, message, span, label=label, help=help_)


def unknown_edition(span: Span, value: str) -> Diagnostic:
    """An edition that does not exist, or is newer than what we know."""
    return _error("edition", f"the edition {value[:40]!r} is not known", span, "unknown", 'Use "2023" or "2024".')


def label_in_edition(span: Span | None, label: str) -> Diagnostic:
    """`optional` or `required` in an edition."""
    help_ = "Leave it out: fields are optional unless they choose another presence."
    if label == "required":
        help_ = "Write `[features.field_presence = LEGACY_REQUIRED]` behind the number."
    return _error("label", f"editions have no {label} fields", span, "not in an edition", help_)


def group_in_edition(name: Name) -> Diagnostic:
    """A group in an edition."""
    help_ = "Declare a message and a field of its type with `[features.message_encoding = DELIMITED]`."
    return _error("group", "editions have no groups", name.span, "not in an edition", help_)


def closed_implicit(name: Name, enum: str) -> Diagnostic:
    """A closed enum in a field of implicit presence."""
    help_ = "Choose another `features.field_presence` for the field, or OPEN for the enum."
    return _error("closed-enum", f"implicit presence needs an open enum, and `{enum}` is closed", name.span, "has implicit presence", help_)


def default_of_implicit(span: Span | None) -> Diagnostic:
    """A default where zero means absent."""
    help_ = "Choose EXPLICIT as its `features.field_presence`."
    return _error("default", "a field of implicit presence has no default", span, "it is 0 or empty where it is not set", help_)


def features_before_editions(span: Span | None) -> Diagnostic:
    """A feature in proto2 or proto3."""
    return _error("feature", "features need an edition", span, "not here", 'Write `edition = "2023";` instead of the syntax.')


def unknown_feature(span: Span | None, name: str) -> Diagnostic:
    """A feature that does not exist."""
    return _error("feature", f"there is no feature `{name[:100]}`", span, "unknown")


def feature_elsewhere(span: Span | None, name: str, targets: Sequence[str]) -> Diagnostic:
    """A feature that is chosen for something that does not have it."""
    places = ", ".join(target.removesuffix("Options").lower() for target in targets)
    return _error("feature", f"`{name}` cannot be chosen here", span, f"expected in the options of: {places}")


def idle_feature(span: Span | None, name: str, word: str, field: str, reason: str) -> Diagnostic:
    """A feature that is chosen for a field of another kind."""
    return _error("feature", f"`{field}` cannot choose {word} as its `features.{name}`", span, reason)


def required_by_default(span: Span | None) -> Diagnostic:
    """A file all of whose fields would be required."""
    return _error("feature", "fields are not required by default", span, "for a whole file", "Choose LEGACY_REQUIRED for single fields.")
