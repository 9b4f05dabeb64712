"""Characters to tokens: words, numbers, strings, symbols, and the ends of lines, which the preprocessor needs.

OMG IDL 4.2, 7.2 (lexical conventions). What is no token at all becomes a `wrong` one: it is a mistake only where it is read.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Literal, cast

from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.source import Source

Kind = Literal["word", "number", "string", "wstring", "char", "wchar", "symbol", "newline", "wrong", "end"]

BLANK = re.compile(
    r"""(?: [ \t\f\v\r] | \\\r?\n | //(?: \\\r?\n | [^\n] )* | /\* [\s\S]*? \*/ )+""",
    re.VERBOSE,
)
TOKEN = re.compile(
    r"""
      (?P<newline> \n )
    | (?P<wstring> L"(?: [^"\\\n] | \\[^\n] )*" )
    | (?P<wchar>   L'(?: [^'\\\n] | \\[^\n] )*' )
    | (?P<word>    [A-Za-z_][A-Za-z0-9_]* )
    | (?P<number>  0[xX][A-Za-z0-9_]* | \.?[0-9](?: [eE][+-] | [A-Za-z0-9_.] )* )
    | (?P<string>  "(?: [^"\\\n] | \\[^\n] )*" )
    | (?P<char>    '(?: [^'\\\n] | \\[^\n] )*' )
    | (?P<wrong>   ["'][^\n]* | /\*[\s\S]* )
    | (?P<symbol>  :: | << | && | \|\| | [=!<>]= | [-+*/%&|^~!?:;,.<>(){}\[\]=@\#] )
    """,
    re.VERBOSE,
)
"""`>>` is two symbols: it also closes two sequences."""


@dataclass(frozen=True, slots=True)
class Token:
    """A piece of text, and where it stands: a token that a macro made stands where the macro was used."""

    kind: Kind
    text: str
    span: Span


def tokens(source: Source) -> Iterator[Token]:
    """The tokens of a text; the last is a newline, so that every line has an end."""
    text = source.text
    at = 1 if text.startswith("\ufeff") else 0
    while at < len(text):
        blank = BLANK.match(text, at)
        if blank:
            at = blank.end()
            continue
        match = TOKEN.match(text, at)
        end = match.end() if match else at + 1
        kind = cast("Kind", match.lastgroup) if match else "wrong"
        yield Token(kind, text[at:end], Span(source, at, end))
        at = end
    yield Token("newline", "\n", Span(source, len(text), len(text)))
