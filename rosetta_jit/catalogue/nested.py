"""Words for mappings that use other mappings."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic, Mistake, error

if TYPE_CHECKING:
    from rosetta_jit.source import Span


def no_such_mapping(span: Span | None, name: str, folders: Iterable[str]) -> Diagnostic:
    note = f"looked {', '.join(['beside this file', *folders])}"
    return error(
        "no-such-mapping",
        f"there is no mapping `{name}`",
        span,
        "here",
        help_="correct its name, or add its folder: ROSETTA_JIT_PATH",
        notes=(note,),
    )


def many_mappings(span: Span | None, most: int) -> Diagnostic:
    return error("many-mappings", f"a mapping may use {most} others, and this is one more", span, help_="use fewer")


def many_uses(span: Span | None, most: int) -> Diagnostic:
    help_ = "make `to depth` smaller"
    return error("many-uses", f"mappings are used more than {most} times by each other", span, "here again", help_=help_)


not_a_field = Mistake("via-value", "`via` maps a field, and this is computed", "no field", help="name a field of the other side")


def no_messages(span: Span | None, source: str, target: str) -> Diagnostic:
    help_ = "`via` needs two messages, or two arrays of messages"
    return error("via-types", f"a mapping relates messages, and these are {source} and {target}", span, "here", help_=help_)


def other_types(span: Span | None, name: str, has: tuple[str, str], wanted: tuple[str, str]) -> Diagnostic:
    title = f"`{name}` has no rules from {wanted[0]} to {wanted[1]}"
    note = f"it maps {has[1]} to the holder {has[0]}"
    return error("via-other-types", title, span, "this mapping", help_="name another mapping, or add the direction", notes=(note,))


def no_depth(span: Span | None, name: str, most: int) -> Diagnostic:
    help_ = f"say how deep: `via ... to depth 4`, at most {most}"
    return error("no-depth", f"`{name}` is used within itself, and nothing ends that", span, "here", help_=help_)


def too_deep(most: int) -> str:
    """Why a message is refused that is within others of its type more often than the mapping allows."""
    return f"more than {most} messages within each other"


def many_copies(span: Span | None, most: int) -> Diagnostic:
    message = f"the mappings that are used have more than {most:,} rules, each counted as often as it is used"
    return error("many-uses", message, span, "here again", help_="assign messages of one type as a whole, or nest less deeply")
