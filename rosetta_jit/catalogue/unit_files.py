"""What can be wrong with side files of units."""

from __future__ import annotations

from collections.abc import Collection

from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.catalogue.suggestions import nearest
from rosetta_jit.diagnostics import Diagnostic, Mistake, error
from rosetta_jit.source import Span

LINE = "write `package/Type:`, and below it lines like `.field.x: rad/s`, `.joints[2]: mm` or `.joints: rad, rad, m`"


def no_line(span: Span, *, first: bool) -> Diagnostic:
    message = "a side file begins with the name of a type" if first else "this is neither a type nor a field with its unit"
    return error("syntax", message, span, "not expected here", help_=LINE)


no_path = Mistake("syntax", "expected `.field`, `[number]` or `:` and a unit", "not expected here", help=LINE)
no_unit = Mistake("syntax", "a unit is missing", help=LINE)


def too_many(span: Span, limit: int) -> Diagnostic:
    return error("too-many-units", f"a side file has at most {limit} fields", span, "one too many", help_="make two of it")


def unknown_type(span: Span, name: str, known: Collection[str]) -> Diagnostic:
    near = nearest(name, known)
    help_ = f"did you mean `{near}`?" if near else "correct the name, or import the file that declares it before"
    return error("unknown-type", f"no type `{shorten(name)}` is known", span, "named here", help_=help_)


def unknown_field(span: Span, name: str, owner: str, known: Collection[str]) -> Diagnostic:
    near = nearest(name, known)
    help_ = f"did you mean `.{near}`?" if near else "name one of its fields"
    return error("unknown-field", f"`{shorten(owner)}` has no field `.{shorten(name)}`", span, "named here", help_=help_)


def wrong_step(span: Span, found: str, *, into: str) -> Diagnostic:
    help_ = "write `[]` for each element of an array" if found.startswith("an array") else "leave it out"
    return error("unknown-field", f"{shorten(found)} has no {into}", span, help_=help_)


def index_range(span: Span, length: int) -> Diagnostic:
    return error("index", f"the array has {length} elements, counted from 0", span, "no such element", help_="correct the index")


def no_numbers(span: Span, found: str) -> Diagnostic:
    return error("unit", f"{shorten(found)} has no unit", span, help_="units are those of numbers, and of arrays and structs of them")


def not_several(span: Span, found: str) -> Diagnostic:
    return error("unit", f"{shorten(found)} has one unit, not several", span, "this is a second one", help_="leave one of them")


def unknown_unit(span: Span, unit: str, known: Collection[str]) -> Diagnostic:
    near = nearest(unit, known)
    help_ = f"did you mean `{near}`?" if near else "units are those of pint: `degree`, `m/s^2`, `N*cm`"
    return error("unknown-unit", f"`{shorten(unit)}` is no unit that is known", span, "not known", help_=help_)


def contradicts(span: Span, unit: str, other: str, first: Span | None) -> Diagnostic:
    where = f"by {first}" if first is not None else "by the IDL itself"
    message = f"this is in {shorten(other)}, and cannot be in {shorten(unit)}"
    return error("unit-contradiction", message, span, "said again here", notes=(f"{shorten(other)} is said {where}",))


def too_many_parts(span: Span, limit: int) -> Diagnostic:
    return error(
        "too-many-units", f"a field has at most {limit} parts with units of their own", span, "one too many", help_="leave some out"
    )
