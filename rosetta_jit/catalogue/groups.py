"""What can be wrong with functions of several values, and with rules for several places."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue.mapping import error, shorten
from rosetta_jit.catalogue.spelling import closest

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.source import Span


def no_group(span: Span | None, called: str, known: Collection[str]) -> Diagnostic:
    """Several places, and a value that is no group of numbers; it may be the call of a function of several values, misspelt."""
    meant = closest(called, known) if called else None
    how = "functions of several values give one for each place: `.roll, .pitch, .yaw = euler(.q)`; so does a list: `.x, .y = [1.0, 2.0]`"
    if called in ("degrees", "radians"):
        how = "leave it out, and give the places their unit, `degree`: values of several numbers are converted to the units of fields"
    help_ = f"did you mean `{meant}`?" if meant else how
    return error("no-group", "several places take a value of several numbers", span, "one value", help_=help_)


def other_count(span: Span | None, places: int, values: int, names: Sequence[str]) -> Diagnostic:
    """As many places as a value has not."""
    notes = (f"it gives {_listed(names)}",) if names else ()
    return error("group-size", f"{places} places stand for {values} numbers", span, notes=notes, help_="write a place for each number")


def no_component(span: Span | None, name: str, names: Sequence[str]) -> Diagnostic:
    """A number that a group has not, or of what is no group."""
    notes = (f"it gives {_listed(names)}",) if names else ("functions of several values give several numbers: `euler(.q).yaw`",)
    meant = closest(name, names)
    return error(
        "no-component", f"this gives no number `{shorten(name)}`", span, notes=notes, help_=f"did you mean `{meant}`?" if meant else ""
    )


def arguments(span: Span | None, function: str, groups: Sequence[tuple[str, Sequence[str]]], found: int) -> Diagnostic:
    """Too many or too few arguments of a function of several values."""
    wanted = " and ".join(f"{name} ({_listed(names)})" for name, names in groups)
    numbers = iter("abcdefghijklmnopqrstuvwxyz")
    shown = ", ".join(f"[{inner}]" if len(names) > 1 else inner for _, names in groups if (inner := _places(names, numbers)))
    help_ = f"each is a struct, a list or an array: `{function}({shown})`" + (", or all numbers one by one" if len(groups) == 1 else "")
    return error("group-arguments", f"`{function}` takes {wanted}, not {found} values", span, help_=help_)


def list_size(span: Span | None, group: str, names: Sequence[str], found: int) -> Diagnostic:
    """A list or an array with another number of values than a group has."""
    several = len(names) > 1
    message = f"{group} has {len(names)} number{'s' if several else ''}, not {found}"
    return error("group-size", message, span, notes=(f"{'they are' if several else 'it is'} {_listed(names)}",))


def wrong_length(group: str, count: int) -> str:
    """Why a message is refused whose array has another number of elements than a group has."""
    return f"{group} takes {count} elements"


def missing_members(span: Span | None, type_: str, group: str, names: Sequence[str]) -> Diagnostic:
    """A struct without the fields of a group."""
    message = f"`{shorten(type_)}` is not {group}: it has no {_listed(names)}"
    help_ = "where fields have other names, list them in the order of the group: `[.a, .b, .c]`, or on the left `.a, .b, .c = ...`"
    return error("not-a-group", message, span, help_=help_)


def not_a_group(span: Span | None, source: str, group: str) -> Diagnostic:
    """A value that is no group, where one is needed."""
    return error("not-a-group", f"{source} is not {group}", span, help_=f"{group} is a struct, a list, an array, or a call that gives one")


def other_group(span: Span | None, source: str, group: str) -> Diagnostic:
    """A call that gives another group than is needed."""
    return error(
        "not-a-group", f"this gives {source}, and {group} is needed", span, help_="call the function that makes the one of the other"
    )


def alone(span: Span | None, group: str, names: Sequence[str]) -> Diagnostic:
    """A group of numbers where one number is needed."""
    message = f"one number is needed here, and the value is {group}"
    return error("several-values", message, span, notes=(f"it has {_listed(names)}",), help_="name a place for each: `.a, .b, .c = ...`")


def compared(span: Span | None) -> Diagnostic:
    """A relation to a group that packing would have to compare."""
    return error(
        "several-fields",
        "to pack, other relations say what all fields of this are, and groups of numbers are not compared",
        span,
        help_="write this rule in `unpack-rules:`",
    )


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _places(names: Sequence[str], letters: Iterator[str]) -> str:
    """Places for some numbers, which are called as nothing else is."""
    return ", ".join(f".{next(letters, 'x')}" for _ in names)
