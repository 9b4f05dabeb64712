"""What can be wrong with side files of units."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue.mapping import error, shorten
from rosetta_jit.catalogue.resolve import nearest

if TYPE_CHECKING:
    from collections.abc import Collection

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.source import Span

LINE = "write `package/Type:`, and below it lines like `.field.x: rad/s`, `.joints[2]: mm` or `.joints: rad, rad, m`"


def no_line(span: Span, *, first: bool) -> Diagnostic:
    """A line that is neither a type nor a field."""
    message = "a side file begins with the name of a type" if first else "this is neither a type nor a field with its unit"
    return error("syntax", message, span, "not expected here", help_=LINE)


def no_path(span: Span) -> Diagnostic:
    """A path that does not end in a colon."""
    return error("syntax", "expected `.field`, `[number]` or `:` and a unit", span, "not expected here", help_=LINE)


def no_unit(span: Span) -> Diagnostic:
    """Nothing where a unit should stand."""
    return error("syntax", "a unit is missing", span, help_=LINE)


def too_many(span: Span, limit: int) -> Diagnostic:
    """More lines than are read."""
    return error("too-many-units", f"a side file has at most {limit} fields", span, "one too many", help_="make two of it")


def unknown_type(span: Span, name: str, known: Collection[str]) -> Diagnostic:
    """A type that no import declares, and that no file is called after."""
    near = nearest(name, known)
    help_ = f"did you mean `{near}`?" if near else "correct the name, or import the file that declares it before"
    return error("unknown-type", f"no type `{shorten(name)}` is known", span, "named here", help_=help_)


def unknown_field(span: Span, name: str, owner: str, known: Collection[str]) -> Diagnostic:
    """A field that its type does not have."""
    near = nearest(name, known)
    help_ = f"did you mean `.{near}`?" if near else "name one of its fields"
    return error("unknown-field", f"`{shorten(owner)}` has no field `.{shorten(name)}`", span, "named here", help_=help_)


def wrong_step(span: Span, found: str, *, into: str) -> Diagnostic:
    """A member of what is no struct, or an element of what is no array."""
    help_ = "write `[]` for each element of an array" if found.startswith("an array") else "leave it out"
    return error("unknown-field", f"{shorten(found)} has no {into}", span, help_=help_)


def index_range(span: Span, length: int) -> Diagnostic:
    """An element behind the end of an array."""
    return error("index", f"the array has {length} elements, counted from 0", span, "no such element", help_="correct the index")


def no_numbers(span: Span, found: str) -> Diagnostic:
    """A unit of a text, or of several elements where there is one value."""
    return error("unit", f"{shorten(found)} has no unit", span, help_="units are those of numbers, and of arrays and structs of them")


def not_several(span: Span, found: str) -> Diagnostic:
    """Several units of one value."""
    return error("unit", f"{shorten(found)} has one unit, not several", span, "this is a second one", help_="leave one of them")


def unknown_unit(span: Span, unit: str, known: Collection[str]) -> Diagnostic:
    """A unit that the library of units does not know."""
    near = nearest(unit, known)
    help_ = f"did you mean `{near}`?" if near else "units are those of pint: `degree`, `m/s^2`, `N*cm`"
    return error("unknown-unit", f"`{shorten(unit)}` is no unit that is known", span, "not known", help_=help_)


def contradicts(span: Span, unit: str, other: str, first: Span | None) -> Diagnostic:
    """A unit of a field that has another one already."""
    where = f"by {first}" if first is not None else "by the IDL itself"
    message = f"this is in {shorten(other)}, and cannot be in {shorten(unit)}"
    return error("unit-contradiction", message, span, "said again here", notes=(f"{shorten(other)} is said {where}",))


def too_many_parts(span: Span, limit: int) -> Diagnostic:
    """A field with too many parts of different units."""
    return error(
        "too-many-units", f"a field has at most {limit} parts with units of their own", span, "one too many", help_="leave some out"
    )
