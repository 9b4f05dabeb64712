"""What can be wrong with the texts that a mapping computes."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.catalogue.resolve import written_at
from rosetta_jit.catalogue.suggestions import did_you_mean, nearest, there_are
from rosetta_jit.diagnostics import Diagnostic, Mistake, error
from rosetta_jit.source import Span

KINDS = {
    "text": "a text",
    "texts": "an array of texts",
    "characters": "characters in quotes",
    "pattern": "a text in quotes",
    "quoted": "a text in quotes",
    "integer": "an integer",
    "moment": "a date as a text, or seconds as a float",
    "size": "a number of bytes",
    "encoding": "an encoding in quotes",
}


def listed(kinds: Sequence[str], optional: int) -> str:
    """What a function takes, in words."""
    count = f"{len(kinds) - optional} or {len(kinds)}" if optional else str(len(kinds))
    return f"{count} value{'' if count == '1' else 's'} ({', '.join(KINDS[kind] for kind in kinds)})"


def text_needed(span: Span | None, function: str, found: str) -> Diagnostic:
    is_number = found.startswith(("int", "uint", "float", "bool"))
    hint = f"`text({written_at(span)})` is the number as a text" if is_number else "name a text, bytes, or an array of 8-bit integers"
    return error("text-needed", f"`{function}` takes a text, not {shorten(found)}", span, f"this is {shorten(found)}", help_=hint)


joined_elements = Mistake(
    "text-needed",
    "`join` takes an array of texts as a whole",
    "a text of each element",
    help='name a field that is an array of texts, without `[]`: `join(.names, ", ")`; texts within structs are not joined',
)


def no_constant(span: Span | None, name: str, enum: str, known: Collection[str]) -> Diagnostic:
    message = f"enum {shorten(enum)} has no constant `{shorten(name)}`"
    notes = there_are("its constants", known)
    return error("unknown-name", message, span, "names none", notes=notes, help_=did_you_mean(name, known))


def texts_needed(span: Span | None, function: str, found: str) -> Diagnostic:
    help_ = "name an array of strings or bytes"
    return error(
        "text-needed", f"`{function}` takes an array of texts, not {shorten(found)}", span, f"this is {shorten(found)}", help_=help_
    )


wide_text = Mistake("wide-text", "text of 16-bit units cannot be computed with", "here", help="assign it as a whole")
text_and_bytes = Mistake(
    "text-and-bytes",
    "text and bytes cannot be joined",
    "one is text, the other bytes",
    help='say which: `text(..., "utf-8")` or `bytes(..., "utf-8")`',
)


def quoted_needed(span: Span | None, function: str) -> Diagnostic:
    help_ = "write it in quotes: what is looked for must be known when the mapping is compiled"
    return error("quoted-text", f"`{function}` takes a text in quotes here", span, "not known before messages come", help_=help_)


def empty_pattern(span: Span | None, function: str) -> Diagnostic:
    return error("empty-text", f"`{function}` cannot look for an empty text", span, "empty", help_="write at least one character")


def long_quoted(span: Span | None, most: int) -> Diagnostic:
    return error("long-text", f"a text in quotes has at most {most} bytes here", span, help_="shorten it")


def not_ascii(span: Span | None, function: str) -> Diagnostic:
    help_ = f'leave out the others; `replace(..., {_first_wide(span)}, "")` removes them everywhere'
    return error("not-ascii", f"`{function}` takes off ASCII characters only", span, help_=help_)


def _first_wide(span: Span | None) -> str:
    """The first character that is no ASCII, in quotes."""
    text = "" if span is None else span.source.text[span.start : span.end]
    found = next((char for char in text if not char.isascii() and char.isprintable()), "")
    return f'"{found}"' if found else "..."


def written_size(span: Span | None, function: str, most: int) -> Diagnostic:
    help_ = f"write the size as a number: `{function}(..., 16)`"
    return error("written-size", f"`{function}` takes a size that is written down, at most {most}", span, help_=help_)


def unknown_encoding(span: Span | None, found: str | None, known: Sequence[str]) -> Diagnostic:
    message = "an encoding is written in quotes" if found is None else f"there is no encoding `{shorten(found)}`"
    near = None if found is None else nearest(found, known)
    help_ = f'did you mean `"{near}"`?' if near else ""
    return error("unknown-encoding", message, span, notes=(f"encodings: {', '.join(known)}",), help_=help_)


def not_written(span: Span | None, found: Sequence[str], most: int) -> Diagnostic:
    hint = f"`text(number)`, `text(float, decimals)` with at most {most}, or `text(bytes, encoding)`"
    return error("not-writable", f"`text` does not take {', '.join(map(shorten, found))}", span, help_=hint)


text_length = Mistake("wide-text", "a computed text cannot be assigned to text of 16-bit units", "here", help="assign a field as a whole")
