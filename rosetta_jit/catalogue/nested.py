"""Words for mappings that use other mappings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rosetta_jit.source import Span


def no_such_mapping(span: Span | None, name: str, folders: Iterable[str]) -> Diagnostic:
    """A mapping that is on no search path."""
    note = f"looked {', '.join(['beside this file', *folders])}"
    return Diagnostic(
        "error",
        "no-such-mapping",
        f"there is no mapping `{name}`",
        span,
        "here",
        notes=(note,),
        help="correct its name, or add its folder: ROSETTA_JIT_PATH",
    )


def many_mappings(span: Span | None, most: int) -> Diagnostic:
    """More files than one mapping may use."""
    return Diagnostic("error", "many-mappings", f"a mapping may use {most} others, and this is one more", span, help="use fewer")


def many_uses(span: Span | None, most: int) -> Diagnostic:
    """Mappings that use each other so often that their rules could not be compiled."""
    help_ = "make `to depth` smaller"
    return Diagnostic("error", "many-uses", f"mappings are used more than {most} times by each other", span, "here again", help=help_)


def not_a_field(span: Span | None) -> Diagnostic:
    """`via` behind something that was computed."""
    return Diagnostic(
        "error", "via-value", "`via` maps a field, and this is computed", span, "no field", help="name a field of the other side"
    )


def no_messages(span: Span | None, source: str, target: str) -> Diagnostic:
    """`via` between what are not two messages, or two arrays of them."""
    help_ = "`via` needs two messages, or two arrays of messages"
    return Diagnostic("error", "via-types", f"a mapping relates messages, and these are {source} and {target}", span, "here", help=help_)


def other_types(span: Span | None, name: str, has: tuple[str, str], wanted: tuple[str, str]) -> Diagnostic:
    """A mapping that is for other types, or lacks the direction."""
    title = f"`{name}` has no rules from {wanted[0]} to {wanted[1]}"
    note = f"it maps {has[1]} to the holder {has[0]}"
    return Diagnostic(
        "error", "via-other-types", title, span, "this mapping", notes=(note,), help="name another mapping, or add the direction"
    )


def no_depth(span: Span | None, name: str, most: int) -> Diagnostic:
    """A mapping that uses itself, without an end."""
    help_ = f"say how deep: `via ... to depth 4`, at most {most}"
    return Diagnostic("error", "no-depth", f"`{name}` is used within itself, and nothing ends that", span, "here", help=help_)


def too_deep(most: int) -> str:
    """Why a message is refused that is within others of its type more often than the mapping allows."""
    return f"more than {most} messages within each other"


def many_copies(span: Span | None, most: int) -> Diagnostic:
    """Mappings whose rules come to too many: each use is a copy of them."""
    message = f"the mappings that are used have more than {most:,} rules, each counted as often as it is used"
    return Diagnostic("error", "many-uses", message, span, "here again", help="assign messages of one type as a whole, or nest less deeply")
