"""What can be wrong with the rules of a mapping taken together: fields not set, set twice, elements left out."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.mapping import error, shorten

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.source import Span


def never_set(span: Span | None, side: str, path: str, declared: Span | None, *, array: bool) -> Diagnostic:
    """A field that cannot be absent and has no rule."""
    hint = f"set it, or say that it is empty: `len({path}) = 0`" if array else f"add a rule for `{path}`"
    notes = (f"declared at {declared}",) if declared else ()
    return error("never-set", f"`{path}` of the {side} is never set", span, notes=notes, help_=hint)


def set_twice(span: Span | None, path: str, first: Span | None) -> Diagnostic:
    """A second rule for a place."""
    notes = (f"set before at {first}",) if first else ()
    return error("set-twice", f"`{path}` is set twice", span, "again here", notes=notes, help_="remove one of the rules")


def set_in_loop(span: Span | None, path: str, variable: str) -> Diagnostic:
    """A place that each round of a loop sets again."""
    return error(
        "set-in-loop",
        f"`{path}` is set again in each round of the loop over `{variable}`",
        span,
        help_=f"index it with `{variable}`, or move the rule out of the loop",
    )


def cases(span: Span | None, path: str, first: str, second: str) -> Diagnostic:
    """Two cases of one union."""
    return error("set-twice", f"`{path}` can hold `{first}` or `{second}`, not both", span, help_="remove one of the rules")


def constant(span: Span | None, path: str, value: str) -> Diagnostic:
    """Another value for a field that the schema fixes."""
    return error(
        "constant-field",
        f"the schema fixes `{path}`{f' as {value}' if value else ''}",
        span,
        "another value",
        help_="remove the rule; the constant is written without one",
    )


def uneven_rounds(span: Span | None) -> Diagnostic:
    """A loop whose rounds set different places."""
    return error(
        "uneven-rounds",
        "the blocks of a `when` in this loop do not set the same places",
        span,
        help_="set the same fields of the same element in each block, or put the `when` around the loop",
    )


def too_many_ways(span: Span | None, most: int) -> Diagnostic:
    """More combinations of conditions than are looked at."""
    message = f"there are more than {most} ways through these rules"
    return error("too-many-ways", message, span, help_="choose among values: `x if c else y`")


def in_one_way(problem: Diagnostic) -> Diagnostic:
    """A mistake that not every way through the rules makes."""
    return replace(problem, notes=(*problem.notes, "in one way through the `when` blocks, not in all"))


def length_without_elements(span: Span | None, path: str) -> Diagnostic:
    """A length without rules for the elements."""
    return error(
        "elements-never-set",
        f"the length of `{path}` is set, its elements are not",
        span,
        help_=f"add rules for the elements: `{path}[i] = ...`",
    )


def elements_without_length(span: Span | None, path: str) -> Diagnostic:
    """Elements without a rule for the length."""
    return error(
        "length-never-set",
        f"elements of `{path}` are set, its length is not",
        span,
        help_=f"add `len({path}) = ...` before",
    )


def overlap(span: Span | None, path: str, first: Span | None) -> Diagnostic:
    """Rules that set some element twice."""
    notes = (f"set before at {first}",) if first else ()
    return error("overlap", f"elements of `{path}` are set twice", span, "again here", notes=notes, help_="remove one of the rules")


def element_missing(span: Span | None, path: str, first: int, last: int) -> Diagnostic:
    """Known elements that no rule sets."""
    which = f"`{path}[{first}]` is" if first == last else f"`{path}[{first}]` to `{path}[{last}]` are"
    return error("coverage", f"{which} never set", span, "the length says that they exist", help_="set them, or correct the length")


def element_beyond(span: Span | None, path: str, index: int, length: int) -> Diagnostic:
    """A known element beyond the length."""
    return error("index-range", f"`{path}[{index}]` is beyond the length {length}", span, "out of range")


def coverage(span: Span | None, path: str, length: str, shown: tuple[str, ...]) -> Diagnostic:
    """Rules of which it is not evident that they fill an array."""
    return error(
        "coverage",
        f"it cannot be shown that the rules set all elements of `{path}`, each once",
        span,
        f"to show: 0 to {shorten(length)}",
        notes=tuple(f"shown: {shorten(part)}" for part in shown),
        help_="let loops from 0 run over the index without gaps, and use the expressions of the length:"
        " `(y * width + x) * 3 + c` for y to height, x to width, c to 3",
    )


def not_affine(span: Span | None, path: str) -> Diagnostic:
    """An index that the proof cannot follow."""
    return error(
        "coverage",
        f"it cannot be shown which elements of `{path}` this rule sets",
        span,
        "the index",
        help_="use loop variables in sums and products alone: `(y * width + x) * 3 + c`",
    )


def too_complex(span: Span | None) -> Diagnostic:
    """An expression whose normal form is beyond the limit."""
    return error("too-complex", "the expression is too large to be checked", span, help_="simplify it")
