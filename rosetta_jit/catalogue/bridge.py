"""Mistakes in files of bridges."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.suggestions import closest
from rosetta_jit.diagnostics import Diagnostic, Mistake, error

if TYPE_CHECKING:
    from rosetta_jit.source import Span


def no_toml(span: Span, why: str) -> Diagnostic:
    return error("no-toml", "this is not TOML", span, why)


def unknown_key(span: Span, key: str, where: str, known: Iterable[str]) -> Diagnostic:
    names = sorted(known)
    near = closest(key, names)
    help_ = f"did you mean `{near}`?" if near else f"there are {', '.join(names)}"
    return error("unknown-key", f"{where} has no key `{key}`", span, "this one", help_=help_)


def missing_key(span: Span, where: str, keys: str) -> Diagnostic:
    return error("missing-key", f"{where} lacks {keys}", span, "here")


def bad_value(span: Span, key: str, wanted: str) -> Diagnostic:
    return error("bad-value", f"`{key}` is {wanted}", span, "this is not")


def two_ways(span: Span, one: str, other: str) -> Diagnostic:
    what = f"`{one}` and `{other}` say the same thing in two ways"
    return error("two-ways", what, span, "one too many", help_="leave one out")


no_routes = Mistake("no-routes", "there is nothing to do", help="a [[route]] has a source and a target")


def name_twice(span: Span, name: str) -> Diagnostic:
    return error("name-twice", f"there are two routes `{name}`", span, "the second one", help_="give them names: name = …")


def bad_address(span: Span, text: str, why: str, help_: str) -> Diagnostic:
    return error("bad-address", f"`{text}` is no address: {why}", span, "this one", help_=help_)


def bad_mapping(span: Span, report: str) -> Diagnostic:
    first, *more = report.splitlines()
    return error("bad-mapping", f"this route cannot be compiled: {first}", span, "because of this", notes=tuple(more[:20]))


def cannot_list(span: Span, transport: str) -> Diagnostic:
    what = f"{transport} does not say which channels it has, so that no pattern finds them"
    return error("no-pattern", what, span, "a pattern", help_="write a route for each channel")


def no_type(span: Span, transport: str, meaning: str) -> Diagnostic:
    what = f"{transport} must be told what it is sent"
    return error("no-type", what, span, "without a type", help_=f"add ?type=…, {meaning}")


def cannot_wait(span: Span, transport: str) -> Diagnostic:
    what = f"{transport} sends on, whether anybody waits or not"
    return error("cannot-block", what, span, "this would stop all others", help_='only pipes can wait; `full` is "oldest" or "newest"')


def same_address(span: Span, text: str) -> Diagnostic:
    return error("endless-route", f"a message of `{text}` would come back to it for ever", span, "the same address")
