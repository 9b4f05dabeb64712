"""Mistakes in files of bridges."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue.spelling import closest
from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rosetta_jit.source import Span


def no_toml(span: Span, why: str) -> Diagnostic:
    """A file that is not TOML."""
    return Diagnostic("error", "no-toml", "this is not TOML", span, why)


def unknown_key(span: Span, key: str, where: str, known: Iterable[str]) -> Diagnostic:
    """A key that means nothing."""
    names = sorted(known)
    near = closest(key, names)
    help_ = f"did you mean `{near}`?" if near else f"there are {', '.join(names)}"
    return Diagnostic("error", "unknown-key", f"{where} has no key `{key}`", span, "this one", help=help_)


def missing_key(span: Span, where: str, keys: str) -> Diagnostic:
    """A key that must be there."""
    return Diagnostic("error", "missing-key", f"{where} lacks {keys}", span, "here")


def bad_value(span: Span, key: str, wanted: str) -> Diagnostic:
    """A value of another kind."""
    return Diagnostic("error", "bad-value", f"`{key}` is {wanted}", span, "this is not")


def two_ways(span: Span, one: str, other: str) -> Diagnostic:
    """Two keys of which one alone is taken."""
    what = f"`{one}` and `{other}` say the same thing in two ways"
    return Diagnostic("error", "two-ways", what, span, "one too many", help="leave one out")


def no_routes(span: Span) -> Diagnostic:
    """A file without routes."""
    return Diagnostic("error", "no-routes", "there is nothing to do", span, help="a [[route]] has a source and a target")


def name_twice(span: Span, name: str) -> Diagnostic:
    """Two routes of one name."""
    return Diagnostic("error", "name-twice", f"there are two routes `{name}`", span, "the second one", help="give them names: name = …")


def bad_address(span: Span, text: str, why: str, help_: str) -> Diagnostic:
    """An address that no transport takes."""
    return Diagnostic("error", "bad-address", f"`{text}` is no address: {why}", span, "this one", help=help_)


def bad_mapping(span: Span, report: str) -> Diagnostic:
    """A route whose mapping cannot be used."""
    first, *more = report.splitlines()
    return Diagnostic("error", "bad-mapping", f"this route cannot be compiled: {first}", span, "because of this", notes=tuple(more[:20]))


def cannot_list(span: Span, transport: str) -> Diagnostic:
    """A pattern where channels cannot be listed."""
    what = f"{transport} does not say which channels it has, so that no pattern finds them"
    return Diagnostic("error", "no-pattern", what, span, "a pattern", help="write a route for each channel")


def no_type(span: Span, transport: str, meaning: str) -> Diagnostic:
    """A target that must be told what it is sent."""
    what = f"{transport} must be told what it is sent"
    return Diagnostic("error", "no-type", what, span, "without a type", help=f"add ?type=…, {meaning}")


def cannot_wait(span: Span, transport: str) -> Diagnostic:
    """A source that nothing can hold back."""
    what = f"{transport} sends on, whether anybody waits or not"
    return Diagnostic(
        "error", "cannot-block", what, span, "this would stop all others", help='only pipes can wait; `full` is "oldest" or "newest"'
    )


def same_address(span: Span, text: str) -> Diagnostic:
    """A route from a channel to itself."""
    return Diagnostic("error", "endless-route", f"a message of `{text}` would come back to it for ever", span, "the same address")
