"""What can be wrong with paths: fields, elements and keys that there are not."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.habits import for_member, path_before
from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.catalogue.suggestions import did_you_mean, there_are
from rosetta_jit.diagnostics import Diagnostic, error
from rosetta_jit.source import Span

if TYPE_CHECKING:
    from rosetta_jit.model.expr import Member

KINDS = {"parameter": "a parameter", "state": "a state variable", "for": "a loop variable"}
"""What a name without a dot is declared by, and what it is then."""


def unknown_field(step: Member, side: str, owner: str, known: Collection[str], elsewhere: str) -> Diagnostic:
    """A field that the message does not have; ``elsewhere`` is a hint at where there is one of that name."""
    return error(
        "unknown-field",
        f"`{shorten(owner)}` has no field `{shorten(step.name)}`",
        step.span,
        f"looked up on the {side} side",
        notes=there_are("its fields", known),
        help_=_undotted(step) or _listed(step, elsewhere) or elsewhere or did_you_mean(step.name, known),
    )


def unknown_wire(step: Member, wires: Collection[str], owners: Sequence[str]) -> Diagnostic:
    """A path that begins with no wire's name; ``owners`` are the wires that have a field of the name."""
    paths = " or ".join(f"`.{shorten(wire)}.{shorten(step.name)}`" for wire in owners[:3])
    return error(
        "unknown-field",
        f"no wire is called `{shorten(step.name)}`",
        step.span,
        "on the wire's side a path begins with the name of a wire",
        notes=there_are("wires", wires),
        help_=_undotted(step) or (f"write {paths}" if paths else did_you_mean(step.name, wires)),
    )


def _undotted(step: Member) -> str:
    """A hint where the name is declared as one that has no dot."""
    if step.span is None:
        return ""
    declared = re.search(rf"(?m)^\s*(parameter|state|for)\s+{re.escape(step.name)}\b", step.span.source.text)
    return f"`{shorten(step.name)}` is {KINDS[declared[1]]}, which has no dot" if declared else ""


def _listed(step: Member, elsewhere: str) -> str:
    """A hint where `ignore` names a field that is set, or `default` one that is read."""
    before = "" if step.span is None else step.span.source.text[: step.span.start].rstrip()
    words = {
        "ignore": "`ignore` is said of what rules read, `default` of what they set",
        "default": "`default` is said of what rules set, `ignore` of what they read",
    }
    word = next((each for each in words if before.endswith(each)), "")
    other = "default" if word == "ignore" else "ignore"
    return f"{words[word]}: `{other} .{shorten(step.name)}`" if word and elsewhere else ""


def other_side(name: str, origin: str) -> str:
    """A hint: the field exists on the side that the rule writes."""
    return f"`{shorten(name)}` is a field of the target; what a rule reads, indices included, is on the {origin} side"


def read_side(name: str, target: str) -> str:
    """A hint: the field exists on the side that the rule reads."""
    return f"`{shorten(name)}` is a field of what is read; a rule here sets a field of the {target}: turn it round"


def in_message(name: str) -> str:
    """A hint: the path begins with the name of a message."""
    return f"a path begins at the message itself: `.{shorten(name)}`"


def in_wires(name: str, wires: Sequence[str]) -> str:
    """A hint: messages of other wires have the field."""
    return f"it is {' and '.join(f'`.{shorten(wire)}.{shorten(name)}`' for wire in wires[:3])}"


def is_elsewhere(problem: Diagnostic) -> bool:
    """Whether a report is about a field that the other side has."""
    return problem.code == "unknown-field" and problem.help.endswith(("side", "turn it round"))


TURNED = "left of `<->` stands a place of the holder, right of it one of the wire: turn the relation round"
"""A hint: a relation has the sides of each other."""


def not_a_struct(span: Span | None, name: str, found: str) -> Diagnostic:
    array = path_before(span)
    hint = f"leave out `.{shorten(name)}`"
    if found.startswith("an array"):
        hint = f"of each element: `{array}[].{shorten(name)}`; of one: `{array}[0].{shorten(name)}`"
    if found.startswith("an array") or found in ("text", "bytes"):
        hint = for_member(name, span) or hint
    return error("no-fields", f"`.{shorten(name)}` of {found}, which has no fields", span, f"this is {found}", help_=hint)


def no_keys(span: Span | None, found: str) -> Diagnostic:
    message = f"{shorten(found)} has no elements that a field tells apart"
    help_ = 'name an array of messages, a map, or an array of keys beside: `.position[.name[] = "elbow"]`'
    return error("no-keys", message, span, "here", help_=help_)


def not_indexable(span: Span | None, found: str, value: str = "") -> Diagnostic:
    hint = f'bytes of a text are `slice({value or "s"}, 0, 3)`, its parts `part({value or "s"}, "/", 0)`' if found == "text" else ""
    return error("not-indexable", f"{found} cannot be indexed", span, help_=hint or "only arrays and bytes have elements")


def index_range(span: Span | None, index: int, length: int | None) -> Diagnostic:
    array = path_before(span)
    has = "indices count from 0" if length is None else f"there are {length} elements, counted from 0"
    hint = "correct the index"
    if index < 0:
        last = f"`{array}[len({array}) - 1]`" if length is None else f"{length - 1}"
        hint = f"the last element is {last}"
    return error("index-range", f"index {index} is out of range", span, has, help_=hint)


def no_length(span: Span | None, found: str) -> Diagnostic:
    return error("no-length", f"{found} has no length", span, "here", help_="only arrays, bytes and text have one")


def always_there(span: Span | None, found: str) -> Diagnostic:
    help_ = "only optional fields and cases of a union can be absent; compare the value instead"
    return error("always-there", f"{found} is always there", span, "here", help_=help_)


def undotted_field(span: Span | None, name: str) -> Diagnostic:
    message = f"there is no loop variable or constant `{shorten(name)}`, but a field"
    return error("unknown-name", message, span, "a dot is missing", help_=f"a field begins with a dot: `.{shorten(name)}`")
