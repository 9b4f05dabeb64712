"""What cannot be generated."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from collections.abc import Sequence


def unknown_language(name: str, known: Sequence[str]) -> Diagnostic:
    """A language that is not installed."""
    return Diagnostic("error", "unknown-language", f"nothing prints `{name}`", help=f"choose one of {', '.join(known)}")


def unusable_name(name: str) -> Diagnostic:
    """A name that files and identifiers cannot begin with."""
    message = f"`{name}` cannot begin the names of functions"
    return Diagnostic("error", "unusable-name", message, help="letters, digits and underscores, of which a letter comes first, up to 40")


def needs_library(name: str, what: str) -> Diagnostic:
    """A function of this library's that source in another language does not have."""
    return Diagnostic(
        "error",
        "not-generated",
        f"{name} {what} images, which generated source cannot",
        help="leave the image as it is, or compress it where there is Python",
    )


def needs_c_library(name: str, what: str) -> Diagnostic:
    """Freestanding source that needs what a C library has."""
    return Diagnostic("error", "not-freestanding", f"{name} needs {what} of the C library", help="generate it without --freestanding")


def nothing_to_borrow(name: str) -> Diagnostic:
    """A decoder that was asked to leave bytes in the message, of a type without any."""
    return Diagnostic("error", "nothing-to-borrow", f"{name} has no bytes field that could stay in the message", help="ask for `decode`")
