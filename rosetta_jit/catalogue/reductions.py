"""What can be wrong with reductions: `sum(.a[])`, `any(.a[] > 3)`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue.mapping import error

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.source import Span

EXAMPLES = {"any": "any(.a[] > 3)", "all": "all(.a[] > 3)", "count": "count(.a[] > 3)"}


def not_of_each(span: Span | None, function: str) -> Diagnostic:
    """A reduction of what has no elements, or of several values."""
    help_ = f"write `[]` behind the array: `{EXAMPLES.get(function, f'{function}(.a[])')}`"
    return error("reduction", f"`{function}` takes one value of each element", span, help_=help_)


def in_order(span: Span | None, function: str) -> Diagnostic:
    """A reduction of elements in rows or planes, or of those that a list names."""
    help_ = "write `.a[]`, or a slice of it"
    return error("layout-order", f"`{function}` takes the elements of an array as they lie", span, help_=help_)


def within_each(span: Span | None, function: str) -> Diagnostic:
    """Two `[]` in one path."""
    help_ = f"write a loop over the outer ones: `for i from 0 to len(.rows) ... {function}(.rows[i].cells[]) ... end`"
    return error("many-elements", f"`{function}` takes the elements of one array, not those of each of several", span, help_=help_)
