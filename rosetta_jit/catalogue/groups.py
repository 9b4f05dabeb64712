"""What can be wrong with functions of several values, and with rules for several places."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.catalogue.suggestions import closest
from rosetta_jit.diagnostics import Diagnostic, Mistake, error
from rosetta_jit.source import Span


def no_group(span: Span | None, called: str, known: Collection[str]) -> Diagnostic:
    meant = closest(called, known) if called else None
    how = "functions of several values give one for each place: `.roll, .pitch, .yaw = euler(.q)`; so does a list: `.x, .y = [1.0, 2.0]`"
    if called in ("degrees", "radians"):
        how = "leave it out, and give the places their unit, `degree`: values of several numbers are converted to the units of fields"
    help_ = f"did you mean `{meant}`?" if meant else how
    return error("no-group", "several places take a value of several numbers", span, "one value", help_=help_)


def other_count(span: Span | None, places: int, values: int, names: Sequence[str]) -> Diagnostic:
    notes = (f"it gives {_listed(names)}",) if names else ()
    return error("group-size", f"{places} places stand for {values} numbers", span, notes=notes, help_="write a place for each number")


def no_component(span: Span | None, name: str, names: Sequence[str]) -> Diagnostic:
    notes = (f"it gives {_listed(names)}",) if names else ("functions of several values give several numbers: `euler(.q).yaw`",)
    meant = closest(name, names)
    return error(
        "no-component", f"this gives no number `{shorten(name)}`", span, notes=notes, help_=f"did you mean `{meant}`?" if meant else ""
    )


def arguments(span: Span | None, function: str, groups: Sequence[tuple[str, Sequence[str]]], found: int) -> Diagnostic:
    wanted = " and ".join(f"{name} ({_listed(names)})" for name, names in groups)
    numbers = iter("abcdefghijklmnopqrstuvwxyz")
    shown = ", ".join(f"[{inner}]" if len(names) > 1 else inner for _, names in groups if (inner := _places(names, numbers)))
    help_ = f"each is a struct, a list or an array: `{function}({shown})`" + (", or all numbers one by one" if len(groups) == 1 else "")
    return error("group-arguments", f"`{function}` takes {wanted}, not {found} values", span, help_=help_)


def list_size(span: Span | None, group: str, names: Sequence[str], found: int) -> Diagnostic:
    several = len(names) > 1
    message = f"{group} has {len(names)} number{'s' if several else ''}, not {found}"
    return error("group-size", message, span, notes=(f"{'they are' if several else 'it is'} {_listed(names)}",))


def wrong_length(group: str, count: int) -> str:
    """Why a message is refused whose array has another number of elements than a group has."""
    return f"{group} takes {count} elements"


def missing_members(span: Span | None, type_: str, group: str, names: Sequence[str]) -> Diagnostic:
    message = f"`{shorten(type_)}` is not {group}: it has no {_listed(names)}"
    help_ = "where fields have other names, list them in the order of the group: `[.a, .b, .c]`, or on the left `.a, .b, .c = ...`"
    return error("not-a-group", message, span, help_=help_)


def not_a_group(span: Span | None, source: str, group: str) -> Diagnostic:
    return error("not-a-group", f"{source} is not {group}", span, help_=f"{group} is a struct, a list, an array, or a call that gives one")


def other_group(span: Span | None, source: str, group: str) -> Diagnostic:
    return error(
        "not-a-group", f"this gives {source}, and {group} is needed", span, help_="call the function that makes the one of the other"
    )


def alone(span: Span | None, group: str, names: Sequence[str]) -> Diagnostic:
    message = f"one number is needed here, and the value is {group}"
    return error("several-values", message, span, notes=(f"it has {_listed(names)}",), help_="name a place for each: `.a, .b, .c = ...`")


compared = Mistake(
    "several-fields",
    "to pack, other relations say what all fields of this are, and groups of numbers are not compared",
    help="write this rule in `unpack-rules:`",
)


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _places(names: Sequence[str], letters: Iterator[str]) -> str:
    """Places for some numbers, which are called as nothing else is."""
    return ", ".join(f".{next(letters, 'x')}" for _ in names)
