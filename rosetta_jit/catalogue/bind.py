"""What can be wrong with the parameters of a mapping, and with what is given for them."""

from __future__ import annotations

import re
from collections.abc import Collection

from rosetta_jit.catalogue.mapping import CALLED, shorten
from rosetta_jit.catalogue.resolve import written_at
from rosetta_jit.catalogue.suggestions import nearest
from rosetta_jit.diagnostics import Diagnostic, Mistake, error, warning
from rosetta_jit.source import Span


def missing(span: Span | None, name: str) -> Diagnostic:
    help_ = f'`parameters={{"{shorten(name)}": ...}}`, or `--parameter {shorten(name)}=...` on the command line'
    return error("missing-parameter", f"the parameter `{shorten(name)}` is not given", span, "declared without a default", help_=help_)


def unknown(span: Span | None, name: str, known: Collection[str]) -> Diagnostic:
    found = nearest(name, known)
    listed = ", ".join(f"`{shorten(each)}`" for each in sorted(known)[:20]) or "none"
    help_ = f"did you mean `{found}`?" if found else ""
    return error("unknown-parameter", f"the mapping has no parameter `{shorten(name)}`", span, notes=(f"declared: {listed}",), help_=help_)


def unfit(span: Span | None, name: str, why: str) -> Diagnostic:
    help_ = "give it a value of the type that it is declared with"
    return error("parameter", f"`{shorten(name)}` cannot be this: {why}", span, "here", help_=help_)


def repeated(span: Span | None, name: str) -> Diagnostic:
    return error(
        "repeated-parameter", f"the parameter `{shorten(name)}` is declared already", span, "again here", help_="remove one of the two"
    )


def unknown_type(span: Span | None, parameter: str, name: str, known: Collection[str]) -> Diagnostic:
    found = CALLED.get(name) or nearest(name, known)
    notes = (f"types: {', '.join(known)}, and `list of` these",)
    help_ = f"did you mean `{found}`?" if found else ""
    return error(
        "parameter-type", f"the parameter `{shorten(parameter)}` cannot be of type `{shorten(name)}`", span, notes=notes, help_=help_
    )


def shadowed(span: Span | None, name: str) -> Diagnostic:
    return error("shadowed", f"a parameter is called `{shorten(name)}` already", span, help_="choose another variable")


def unused(span: Span | None, name: str) -> Diagnostic:
    return warning("parameter-unused", f"no rule uses the parameter `{shorten(name)}`", span, help_="remove it")


def no_such_item(span: Span | None, number: int, count: int) -> Diagnostic:
    help_ = f"{count} item{'' if count == 1 else 's'}, counted from 0"
    return error("index-range", f"there is no item {number}", span, "beyond the list", help_=f"correct the index: the list has {help_}")


def not_a_list(span: Span | None) -> Diagnostic:
    written = written_at(span)
    field = f".{written}" if re.fullmatch(r"[A-Za-z_]\w*\[\w+\]", written) else ".name[i]"
    help_ = f"a field begins with a dot: `{field}`; lists are parameters and `[a, b, c]`"
    return error("not-indexable", "this is no list", span, "has no items", help_=help_)


empty_list = Mistake(
    "index-range",
    "the list has no items",
    "beyond the list",
    help="ask `len(names) > 0` before: what is in a `when` that is known not to hold is not looked at",
)
list_alone = Mistake(
    "list-needed",
    "a list is not a value by itself",
    "this is a list",
    help="take an item, `names[i]`, or assign the list to an array: `.names = names`",
)


def mixed_list(span: Span | None, kinds: Collection[str]) -> Diagnostic:
    listed = ", ".join(kinds)
    return error("mixed-choice", "the items of this list have no type in common", span, help_=f"convert them to one of: {listed}")


def long_list(span: Span | None, most: int) -> Diagnostic:
    return error("many-cases", f"a list has at most {most} items", span)


def many_items(span: Span | None, most: int) -> Diagnostic:
    help_ = "choose once and assign the item, or shorten the lists"
    return error("many-cases", f"items of lists are chosen in too many places: more than {most} items in all", span, help_=help_)


def needless(name: str) -> Diagnostic:
    return error("unknown-parameter", f"there is no mapping that could have a parameter `{shorten(name)}`")
