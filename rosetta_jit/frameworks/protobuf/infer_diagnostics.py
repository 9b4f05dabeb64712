"""What can be wrong with messages of which a `.proto` file is drafted."""

from __future__ import annotations

from typing import Literal

from rosetta_jit.diagnostics import Diagnostic

Kind = Literal["tag", "varint", "truncated"]


def invalid_name(name: str) -> Diagnostic:
    """A name that no message can have."""
    return Diagnostic(
        "error", "invalid-name", f"`{name[:100]}` is no name of a message", help="write words with dots between them: lab.Pose"
    )


def no_messages() -> Diagnostic:
    """Nothing to infer from."""
    return Diagnostic("error", "no-messages", "there is no message to draft a schema from")


def unlike(number: int, field: int, first: str, second: str) -> Diagnostic:
    """A field that messages have with several wire types."""
    message = f"message {number} has field {field} as {second}, where it was {first} before"
    return Diagnostic("error", "unlike-messages", message, help="draft a schema of messages of one type alone")


def too_many_fields(most: int) -> Diagnostic:
    """More fields than any message type has."""
    return Diagnostic("error", "too-many", f"the messages have more than {most} fields", help="are they messages of protobuf?")
