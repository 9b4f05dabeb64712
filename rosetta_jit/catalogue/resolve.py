"""What can be wrong with the names and types in the rules of a mapping."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.mapping import error, shorten

if TYPE_CHECKING:
    from collections.abc import Collection

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.model.expr import Member
    from rosetta_jit.source import Span

MAX_NAMES = 20
MAX_CANDIDATES = 2000


def nearest(name: str, known: Collection[str]) -> str | None:
    """The known name that somebody who wrote ``name`` may have meant; the work is bounded for hostile schemas."""
    candidates = [other for other in sorted(known)[:MAX_CANDIDATES] if len(other) <= 100]
    found = get_close_matches(name[:100], candidates, n=1)
    return found[0] if found else None


def _did_you_mean(name: str, known: Collection[str]) -> str:
    found = nearest(name, known)
    return f"did you mean `{found}`?" if found else ""


def _there_are(what: str, known: Collection[str]) -> tuple[str, ...]:
    names = [shorten(name) for name in sorted(known)[:MAX_NAMES]]
    more = ", ..." if len(known) > MAX_NAMES else ""
    return (f"{what}: {', '.join(names)}{more}",) if names else (f"{what}: none",)


def unknown_type(span: Span | None, name: str, known: Collection[str]) -> Diagnostic:
    return error(
        "unknown-type",
        f"no import declares a type `{shorten(name)}`",
        span,
        "not declared",
        notes=_there_are("declared", known),
        help_=_did_you_mean(name, known),
    )


def not_a_message(span: Span | None, name: str) -> Diagnostic:
    return error("not-a-message", f"`{shorten(name)}` is an enum, not a message", span, help_="name a message type")


def unknown_field(step: Member, side: str, owner: str, known: Collection[str], elsewhere: str) -> Diagnostic:
    return error(
        "unknown-field",
        f"`{shorten(owner)}` has no field `{shorten(step.name)}`",
        step.span,
        f"read as a field of the {side}",
        notes=_there_are("its fields", known),
        help_=_did_you_mean(step.name, known) or elsewhere,
    )


def other_side(name: str, origin: str) -> str:
    return f"`{shorten(name)}` is a field of the target; what a rule reads, indices included, is on the {origin} side"


def not_a_struct(span: Span | None, name: str, found: str) -> Diagnostic:
    hint = "index it first: `[i]`" if found.startswith("an array") else ""
    return error("no-fields", f"`.{shorten(name)}` of {found}, which has no fields", span, f"this is {found}", help_=hint)


def not_indexable(span: Span | None, found: str) -> Diagnostic:
    return error("not-indexable", f"{found} cannot be indexed", span, help_="only arrays and bytes have elements")


def no_length(span: Span | None, found: str) -> Diagnostic:
    return error("no-length", f"{found} has no length", span, "here", help_="only arrays, bytes and text have one")


def length_not_settable(span: Span | None, found: str) -> Diagnostic:
    return error("length-fixed", f"the length of {found} cannot be set", span, "here", help_="assign it as a whole, or remove the rule")


def unknown_name(span: Span | None, name: str, known: Collection[str]) -> Diagnostic:
    return error(
        "unknown-name",
        f"there is no loop variable or constant `{shorten(name)}`",
        span,
        "not known here",
        notes=_there_are("known", known),
        help_=_did_you_mean(name, known) or "a field begins with a dot: `.name`; an enum constant is written with its full name",
    )


def unknown_function(span: Span | None, name: str, known: Collection[str]) -> Diagnostic:
    return error(
        "unknown-function",
        f"there is no function `{shorten(name)}`",
        span,
        notes=_there_are("functions", known),
        help_=_did_you_mean(name, known),
    )


def arguments(span: Span | None, function: str, expected: str, found: int) -> Diagnostic:
    return error("arguments", f"`{function}` takes {expected}, not {found}", span)


def conversion_rule(span: Span | None, function: str, allowed: Collection[str]) -> Diagnostic:
    names = ", ".join(f"`{name}`" for name in sorted(allowed)) or "none"
    return error("conversion-rule", f"`{function}` has no such rule here", span, "not a rule", notes=(f"rules: {names}",))


def shadowed(span: Span | None, name: str) -> Diagnostic:
    return error("shadowed", f"an outer loop already counts with `{name}`", span, help_="choose another variable")


def needs_word(span: Span | None, source: str, target: str, how: str) -> Diagnostic:
    return error(
        "lossy-conversion",
        f"{source} does not always fit {target}",
        span,
        f"this is {source}",
        help_=f"say how: {how}",
    )


def type_clash(span: Span | None, source: str, target: str, how: str = "") -> Diagnostic:
    return error("type-clash", f"{source} cannot become {target}", span, f"this is {source}", help_=how)


def constant_range(span: Span | None, value: str, target: str) -> Diagnostic:
    return error("constant-range", f"{shorten(value)} does not fit {target}", span, "known to be out of range")


def operand(span: Span | None, operator: str, found: str) -> Diagnostic:
    hint = "convert it first: `int64(...)`" if found == "uint64" else "only numbers can be computed with"
    return error("operand", f"`{operator}` cannot take {found}", span, f"this is {found}", help_=hint)


def integer_needed(span: Span | None, what: str, found: str) -> Diagnostic:
    hint = "convert it: `int64(...)`" if found in {"uint64", "float32", "float64"} else ""
    return error("integer-needed", f"{what} is an integer, not {found}", span, f"this is {found}", help_=hint)


def zero_division(span: Span | None) -> Diagnostic:
    return error("zero-division", "division by zero", span, "this is zero")


def index_range(span: Span | None, index: int, length: int | None) -> Diagnostic:
    has = "indices count from 0" if length is None else f"there are {length} elements, counted from 0"
    return error("index-range", f"index {index} is out of range", span, has)


def loop_range(span: Span | None, start: int, stop: int) -> Diagnostic:
    return error("loop-range", f"the loop ends at {stop}, below its start {start}", span, help_="`to` is exclusive and not below `from`")
