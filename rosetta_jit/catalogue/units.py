"""What can be wrong with the units of fields."""

from __future__ import annotations

from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.catalogue.resolve import written_at
from rosetta_jit.diagnostics import Diagnostic, error, warning
from rosetta_jit.source import Span

UNITS = "units are pint's: `degree`, `radian`, `m`, `mm`, `s`, `N*m`, `degC`; correct the schema"
ANGLES = ("degree", "degrees", "deg", "radian", "radians", "rad")


def incompatible(span: Span | None, source: str, target: str) -> Diagnostic:
    message = f"{shorten(source)} cannot become {shorten(target)}: they measure different things"
    return error("unit", message, span, f"this is in {shorten(source)}", help_="assign another field, or compute what is meant")


def wrong_way(span: Span | None, function: str, found: str, wanted: str) -> Diagnostic:
    message = f"`{function}` takes {wanted}s, and this is in {shorten(found)}"
    other = "degrees" if function == "radians" else "radians"
    return error("unit", message, span, help_=f"write `{other}(...)`, or nothing at all" if found in ANGLES else "")


def disagree(span: Span | None, what: str, first: str, second: str, factors: tuple[float, float] | None) -> Diagnostic:
    message = f"{what} has one value in {shorten(first)} and one in {shorten(second)}"
    help_ = "they measure different things"
    if factors is not None:
        factor, offset = factors
        help_ = f"write `x * {factor!r}{f' + {offset!r}' if offset else ''}` to have the second in {shorten(first)}"
    return error("unit", message, span, help_=help_)


def offset(span: Span | None, source: str, target: str) -> Diagnostic:
    message = f"the sum or difference of values in {shorten(source)} has no place on the scale of {shorten(target)}"
    return error("unit", message, span, help_="assign what is meant in its own unit first, or multiply by the factor alone")


def shifted(span: Span | None, source: str, target: str) -> Diagnostic:
    message = f"what is added is in {shorten(target)}, and {shorten(source)} is not converted to that before it is taken away again"
    return error("unit", message, span, help_="say in `pack-rules:` what the field is to be, or give both fields one unit")


def mixed(span: Span | None, source: str, target: str) -> Diagnostic:
    message = f"the units of these elements differ: from {source} to {target}"
    return error("unit", message, span, help_="write a rule for each element, with its number, or assign the whole array")


def too_much_within(span: Span | None, found: str) -> Diagnostic:
    message = f"the units differ, and there is too much within {shorten(found)} to convert it as a whole"
    return error("unit", message, span, help_="assign its fields one by one")


def wrong_factor(span: Span | None, factor: float, source: str, target: str, right: float) -> Diagnostic:
    message = f"times {factor:.6g} converts {shorten(target)} to {shorten(source)}, and this is in {shorten(source)}"
    function = {"degree": "radians", "radian": "degrees"}.get(source, "")
    how = f"write `{function}(...)`" if function and target in {"degree", "radian"} else f"multiply by {right:.6g}"
    return error("unit", message, span, "the wrong way", help_=f"{how}, or leave the factor out where both units are declared")


def integers_within(span: Span | None, integers: str, known: str, wanted: str) -> Diagnostic:
    message = f"within this are values of {integers} in {shorten(known)} where {shorten(wanted)} is meant"
    return error("unit", message, span, help_="write a rule for each such field or element: integers are converted one by one")


EACH = ", and write `[]` behind the array that is set, too"


def wide_integer(span: Span | None, found: str, element: str) -> Diagnostic:
    """An integer of more bits than the float has in which units are converted; ``element`` where it is one of a whole array."""
    message = f"the units differ, and float64, in which they are converted, does not hold every {found}"
    help_ = f"say that it may be rounded: `float64({element or written_at(span)})`{EACH if element else ''}"
    return error("unit", message, span, help_=help_)


def fraction_of_unit(span: Span | None, known: str, wanted: str, target: str, element: str) -> Diagnostic:
    """An integer that may be a fraction in the unit of its place; ``element`` where it is one of a whole array."""
    message = f"a whole number of {shorten(known)} need not be one of {shorten(wanted)}"
    help_ = f"say how it is rounded: `{target}(float64({element or written_at(span)}), round)`, or `truncate`{EACH if element else ''}"
    return error("unit", message, span, help_=help_)


def one_sided(span: Span | None, unit: str, *, is_source: bool) -> Diagnostic:
    known, other = ("the value", "the field that it sets") if is_source else ("the field that it sets", "the value")
    message = f"{known} is in {shorten(unit)}, and nothing says in what {other} is"
    return warning("one-sided-unit", message, span, help_="declare the other unit, or convert: `radians(...)`, `x * 0.001`")


def unknown_unit(span: Span | None, unit: str) -> Diagnostic:
    return warning("unknown-unit", f"`{shorten(unit)}` is no unit that is known: nothing is converted", span, help_=UNITS)
