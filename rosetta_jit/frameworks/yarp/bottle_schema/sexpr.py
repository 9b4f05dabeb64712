r"""S-expressions: text into nested forms with their places.

    Node = Text | Vocab | Number | Word | Form
    Text = "..."     Vocab = :|set|     Number = 16, 0.5     Word = :int, +, geometry.width     Form = ( Node* )

`;` starts a comment. In a text, \" \\ \n \t stand for the character.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.yarp import bottle_diagnostics as catalogue
from rosetta_jit.frameworks.yarp.limits import MAX_DIGITS, MAX_FORMS, MAX_PROBLEMS
from rosetta_jit.parsing.lalr import Grammar, Token, UnexpectedCharacterError
from rosetta_jit.parsing.parsers import parser_of
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass

GRAMMAR = Path(__file__).with_name("bottle_schema.lark")

_ESCAPES = {"n": "\n", "t": "\t"}


@dataclass(frozen=True, slots=True)
class Text:
    """``"..."`` with its escapes resolved."""

    value: str
    span: Span


@dataclass(frozen=True, slots=True)
class Vocab:
    """``:|set|``"""

    value: str
    span: Span


@dataclass(frozen=True, slots=True)
class Number:
    """An integer or a decimal fraction."""

    value: int | float
    span: Span


@dataclass(frozen=True, slots=True)
class Word:
    """Everything else that stands alone."""

    name: str
    span: Span


@dataclass(frozen=True, slots=True)
class Form:
    """``( ... )``"""

    items: tuple[Node, ...]
    span: Span


Node = Text | Vocab | Number | Word | Form


def head(node: Node) -> str:
    """The word that a form starts with; nothing where it does not, or is none."""
    match node:
        case Form((Word(name), *_)):
            return name
        case _:
            return ""


def read_forms(source: Source) -> tuple[Node, ...]:
    """All forms of a text. A stack nests them, so that depth costs no recursion.

    Raises
    ------
    SchemaError
        Where parentheses or quotes do not close, or nest too deeply.
    """
    problems: list[Diagnostic] = []
    opened: list[Span] = []
    levels: list[list[Node]] = [[]]
    for token in _tokens(source, problems):
        span = Span(source, token.start_pos, token.end_pos)
        match token.type:
            case "LPAR":
                opened.append(span)
                levels.append([])
            case "RPAR" if opened:
                items = tuple(levels.pop())
                levels[-1].append(Form(items, opened.pop().to(span)))
            case "RPAR":
                problems.append(catalogue.stray_parenthesis(span))
            case _:
                levels[-1].append(_atom(token, span))
        if len(opened) > MAX_FORMS:
            raise SchemaError((catalogue.nesting_too_deep(span, MAX_FORMS),))
        if len(problems) >= MAX_PROBLEMS:
            break
    problems += [catalogue.unclosed_parenthesis(span) for span in opened[-1:] if not problems]
    if problems:
        raise SchemaError(tuple(problems))
    return tuple(levels[0])


def _tokens(source: Source, problems: list[Diagnostic]) -> Iterator[Token]:
    try:
        yield from _grammar().lex(source.text)
    except UnexpectedCharacterError as error:
        span = Span(source, error.at, error.at + 1)
        problems.append(catalogue.unclosed_text(span) if source.text[error.at] == '"' else catalogue.unreadable(span))


@cache
def _grammar() -> Grammar:
    return parser_of(GRAMMAR)


def _text(quoted: str) -> str:
    """What stands between quotes, without the backslashes before other characters."""
    return re.sub(r"\\(.)", _unescape, quoted, flags=re.DOTALL) if "\\" in quoted else quoted


def _atom(token: Token, span: Span) -> Node:
    match token.type:
        case "TEXT":
            return Text(_text(token[1:-1]), span)
        case "VOCAB":
            return Vocab(token[2:-1], span)
        case "NUMBER":
            return Number(_number(token), span)
        case _:
            return Word(str(token), span)


def _unescape(escape: re.Match[str]) -> str:
    return _ESCAPES.get(escape[1], escape[1])


def _number(digits: str) -> int | float:
    if any(mark in digits for mark in ".eE"):
        return float(digits)
    return int(digits[:MAX_DIGITS])
