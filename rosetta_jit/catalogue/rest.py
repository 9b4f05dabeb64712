"""The words about rules that stand for the fields which no other rule names: `same names`, `default`, `ignore rest`."""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.catalogue.limits import MAX_REST
from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.diagnostics import Diagnostic, Mistake, error, note
from rosetta_jit.source import Span


def no_same_names(span: Span | None, target: str, origin: str) -> Diagnostic:
    return error("no-same-names", f"`{shorten(target)}` and `{shorten(origin)}` have no other names in common", span, help_="remove it")


repeated_same_names = Mistake("set-twice", "`same names` stands in this block already", "again here", help="name all exceptions in one")


def rest(span: Span | None, word: str, direction: str, fields: Sequence[str]) -> Diagnostic:
    what = "read" if word == "ignore" else "set"
    message = f"{direction} {what}s every field: nothing is left for `{word} rest`"
    if not fields:
        return note("rest", message, span, help_="leave it in for fields that the schema may get")
    shown = ", ".join(f"`{shorten(each)}`" for each in fields[:MAX_REST])
    more = f" and {len(fields) - MAX_REST} more" if len(fields) > MAX_REST else ""
    count = "1 field" if len(fields) == 1 else f"{len(fields)} fields"
    return note("rest", f"{direction} does not {what} {count}", span, f"`{word}` of each", notes=(f"they are: {shown}{more}",))


def rest_in_block(span: Span | None, word: str) -> Diagnostic:
    help_ = "write it beside the `when` or the loop: it is about all rules of the mapping"
    return error("rest", f"`{word} rest` stands within no other block", span, "in a block", help_=help_)


def no_default(span: Span | None, found: str) -> Diagnostic:
    why = "other fields tell how many elements it has"
    return error("no-default", f"there is no default for {found}", span, why, help_="set each of them")


elements_in_block = Mistake(
    "rest",
    "`default .a[].b` stands within no other block",
    "in a block",
    help="write it beside the blocks, or of one element: `default .a[i].b`",
)


def no_elements(span: Span | None, place: str) -> Diagnostic:
    array = place[: place.rindex("[]")]
    message = f"no rule sets how many elements `{shorten(array)}` has, so that `{shorten(place)}` cannot be given a default in each of them"
    return error(
        "no-count",
        message,
        span,
        "of each element",
        help_=f"set it: `len({shorten(array)}) = ...`, or the elements: `{shorten(array)}[].x = ...`",
    )


def default_count(span: Span | None, count: str, array: str) -> Diagnostic:
    message = f"`{shorten(count)}` tells how many elements `{shorten(array)}` has, and its default is 0"
    help_ = f"set it to the number of elements: `{shorten(count)} = len(...)`, and in `rules:` `len(...) <-> {shorten(count)}`"
    return error("no-default", message, span, "here", help_=help_)
