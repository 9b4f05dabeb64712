"""Characters to tokens: words, numbers, strings, symbols, and the ends of lines, which the preprocessor needs; and what tokens mean.

OMG IDL 4.2, 7.2 (lexical conventions): keywords are in 7.2.4, literals in 7.2.6.
What is no token at all becomes a `wrong` one: it is a mistake only where it is read.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from math import isfinite
from typing import Literal, cast

from rosetta_jit.frameworks.omg.limits import MAX_DIGITS
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass

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


FLOATING = re.compile(r"(?:[0-9]+\.[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|[0-9]+[eE][+-]?[0-9]+")
FIXED = re.compile(r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)[dD]")
INTEGER = re.compile(r"0[xX][0-9A-Fa-f]+|0[0-7]*|[1-9][0-9]*")
ESCAPE = re.compile(
    r"\\(?:(?P<octal>[0-7]{1,3})|x(?P<hex>[0-9A-Fa-f]{1,2})|u(?P<unicode>[0-9A-Fa-f]{1,4})|(?P<letter>[ntvbrfa\\?'\"]))|\\(?P<wrong>.)"
)
LETTERS = {"n": "\n", "t": "\t", "v": "\v", "b": "\b", "r": "\r", "f": "\f", "a": "\a"}


class LiteralError(Exception):
    """Nothing is written like this; the first argument says what is wrong."""


def number(text: str) -> int | float | None:
    """The value of a number; None for one in fixed point; raises LiteralError where it is misspelt, or too large."""
    if len(text) > MAX_DIGITS:
        raise LiteralError("too long")
    if INTEGER.fullmatch(text):
        digits = text.lower()
        return int(digits, 16) if digits.startswith("0x") else int(digits, 8) if digits.startswith("0") else int(digits)
    if FLOATING.fullmatch(text):
        value = float(text)
        if not isfinite(value):
            raise LiteralError("too large for a `double`")
        return value
    if FIXED.fullmatch(text):
        return None
    raise LiteralError("not a number")


def unescape(text: str, *, wide: bool) -> str:
    r"""The characters of a string or character literal without its quotes.

    Raises
    ------
    LiteralError
        An escape means nothing, or is `\u` in a narrow literal, or stands for NUL.
    """

    def replaced(match: re.Match[str]) -> str:
        kind = match.lastgroup
        value = match[kind] if kind else ""
        match kind:
            case "octal" if int(value, 8) < 256:
                return chr(int(value, 8))
            case "hex":
                return chr(int(value, 16))
            case "unicode" if wide:
                return chr(int(value, 16))
            case "letter":
                return LETTERS.get(value, value)
            case _:
                raise LiteralError(f"`{match[0]}` means nothing here")

    return ESCAPE.sub(replaced, text)


KEYWORDS = frozenset(
    [
        "abstract",
        "any",
        "attribute",
        "boolean",
        "case",
        "char",
        "const",
        "context",
        "custom",
        "default",
        "double",
        "enum",
        "exception",
        "factory",
        "FALSE",
        "fixed",
        "float",
        "in",
        "inout",
        "interface",
        "local",
        "long",
        "module",
        "native",
        "Object",
        "octet",
        "oneway",
        "out",
        "private",
        "public",
        "raises",
        "readonly",
        "sequence",
        "short",
        "string",
        "struct",
        "supports",
        "switch",
        "TRUE",
        "truncatable",
        "typedef",
        "union",
        "unsigned",
        "ValueBase",
        "valuetype",
        "void",
        "wchar",
        "wstring",
    ]
)
"""Those of CORBA 2: no declaration has such a name, in whatever case. The later ones (`map`, `int8`) may be names, as they were before."""

FOLDED = {word.lower(): word for word in KEYWORDS}

SCALARS = frozenset(["boolean", "char", "double", "float", "octet", "short", "wchar"])
"""Types of one word; `long` and `unsigned` may go on."""

OPAQUE = frozenset(["bitmask", "bitset", "component", "connector", "eventtype", "home", "native", "porttype"])
"""Declarations that are skipped but for their names."""

SKIPPED = frozenset(["import", "typeid", "typeprefix"])
"""Statements that are skipped."""

SERVICES = frozenset(("msg", "srv", "action"))
"""The modules in which rosidl puts what it generates, within that of the package."""
