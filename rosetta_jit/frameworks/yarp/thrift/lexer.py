"""Words of a Thrift file: names, numbers, texts, and single characters."""

from __future__ import annotations

import re
from typing import Literal

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.yarp.thrift import diagnostics as say
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass

Kind = Literal["name", "number", "text", "sign", "end"]

_WORD = re.compile(
    r"""(?P<space>\s+|\#[^\n]*|//[^\n]*|/\*.*?\*/)
    |(?P<name>[A-Za-z_][A-Za-z0-9_.]*)
    |(?P<number>[+-]?(?:0x[0-9A-Fa-f]+|(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?))
    |(?P<text>"[^"\n]*"|'[^'\n]*')
    |(?P<sign>[{}()<>\[\]:;,=*])""",
    re.VERBOSE | re.DOTALL,
)


@dataclass(frozen=True, slots=True)
class Word:
    """One word and its place."""

    kind: Kind
    text: str
    span: Span


def words_of(source: Source) -> list[Word]:
    """All words of a text, and one for its end; raises SchemaError at the first character that begins no word."""
    words: list[Word] = []
    at = 0
    while at < len(source.text):
        match = _WORD.match(source.text, at)
        if match is None:
            raise SchemaError((_stray(source, at),))
        kind = match.lastgroup
        if kind in ("name", "number", "text", "sign"):
            words.append(Word(kind, match[0], Span(source, at, match.end())))
        at = match.end()
    words.append(Word("end", "the end of the file", Span(source, at, at)))
    return words


def _stray(source: Source, at: int) -> Diagnostic:
    rest, span = source.text[at : at + 2], Span(source, at, at + 1)
    if rest == "/*":
        return say.unclosed(span, "comment")
    return say.unclosed(span, "text") if rest[:1] in "\"'" else say.strange_character(span, rest[:1])
