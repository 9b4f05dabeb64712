"""Text to tree, with every syntax error of the file.

After an error the parser goes back to where the statement began, skips it, and goes on: the next one is read as if the
wrong one were not there.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import file_diagnostics as of_file
from rosetta_jit.frameworks.protobuf.limits import MAX_NESTING, MAX_SYNTAX_ERRORS
from rosetta_jit.parsing.lalr import END, Grammar, Parser, Token, Tree, UnexpectedTokenError
from rosetta_jit.parsing.parsers import parser_of
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass

GRAMMAR = Path(__file__).with_name("proto.lark")
START = "file"
MISTAKES = ("UNCLOSED_STRING", "UNCLOSED_COMMENT", "UNKNOWN")
"""Tokens that stand for mistakes."""

OPENING = frozenset(("LBRACE", "LSQB", "LESSTHAN"))
CLOSING = frozenset(("RBRACE", "RSQB", "MORETHAN"))
VISIBILITIES = frozenset(("export", "local"))


@dataclass(frozen=True, slots=True)
class _Statement:
    """A statement while it is read: its first token, the height of the parser's stack below it, brackets open in it."""

    start: int
    base: int | None = None
    nested: int = 0


def parse(source: Source, problems: list[Diagnostic]) -> Tree | None:
    """The tree of a file; what could be read of it where problems were found, None where nothing could."""
    tokens = _with_visibility(list(_tokens(source)))
    deep = _too_deep(tokens)
    if deep is not None:
        problems.append(of_file.nesting(span_of(source, deep), MAX_NESTING))
        return None
    return _feed(source, tokens, problems)


def span_of(source: Source, token: Token) -> Span:
    """The place of a token."""
    start = token.start_pos
    return Span(source, start, start + len(token))


@cache
def grammar() -> Grammar:
    """The parser; made once a process, at the first file."""
    return parser_of(GRAMMAR, start=START, mistake_tokens=MISTAKES)


def _tokens(source: Source) -> Iterator[Token]:
    text = source.text
    # A byte order mark may stand before everything else; blanks keep the offsets right.
    return grammar().lex(" " + text[1:] if text.startswith("\ufeff") else text)


def _with_visibility(tokens: list[Token]) -> list[Token]:
    """The same tokens; `export` and `local` are a kind of their own where a declaration follows: no parser looks that far ahead."""
    return [
        token.of_kind("VISIBILITY") if token in VISIBILITIES and _declares(tokens[index + 1 : index + 3]) else token
        for index, token in enumerate(tokens)
    ]


def _declares(tokens: list[Token]) -> bool:
    """Whether `message Name` follows, not the name of a field: `message =`."""
    return len(tokens) == 2 and tokens[0].type in ("MESSAGE", "ENUM") and tokens[1].type != "EQUAL"


def _too_deep(tokens: list[Token]) -> Token | None:
    depth = 0
    for token in tokens:
        if token.type in OPENING:
            depth += 1
        elif token.type in CLOSING:
            depth -= 1
        if depth > MAX_NESTING:
            return token
    return None


def _feed(source: Source, tokens: list[Token], problems: list[Diagnostic]) -> Tree | None:
    parser = grammar().parser()
    statement = _Statement(0)
    index = 0
    for _ in range(MAX_SYNTAX_ERRORS):
        try:
            while index < len(tokens):
                parser.feed(tokens[index])
                index += 1
                statement = _advance(statement, parser, tokens, index)
            return parser.finish()
        except UnexpectedTokenError as error:
            wrong = error.token
            problems.append(_unexpected(source, wrong, parser.accepted()))
            if wrong.type == END:
                break
            _drop(statement, parser)
            index = _after(statement, tokens, index)
            statement = _Statement(index)
    return None


def _advance(statement: _Statement, parser: Parser, tokens: list[Token], index: int) -> _Statement:
    """The statement that the parser is in, once it took the token before ``index``."""
    token = tokens[index - 1]
    nested = _nested(statement.nested, token, tokens[index - 2])
    if not nested and token.type in ("SEMICOLON", "LBRACE", "RBRACE") and statement.nested == 0:
        return _Statement(index)
    base = len(parser.states) - 1 if statement.base is None else statement.base
    return _Statement(statement.start, base, nested)


def _nested(depth: int, token: Token, before: Token) -> int:
    """How deep in an option's value the parser is: its braces and semicolons end no statement."""
    if depth or token.type == "LSQB" or (token.type == "LBRACE" and before.type == "EQUAL"):
        return depth + (token.type in OPENING) - (token.type in CLOSING)
    return 0


def _drop(statement: _Statement, parser: Parser) -> None:
    """Take what was read of a statement off the parser's stacks."""
    if statement.base is not None:
        del parser.states[statement.base :]
        del parser.values[statement.base - 1 :]


def _after(statement: _Statement, tokens: list[Token], wrong: int) -> int:
    """Index of the token behind a statement that went wrong at ``wrong``."""
    depth = 0
    for index in range(statement.start, len(tokens)):
        kind = tokens[index].type
        depth += (kind == "LBRACE") - (kind == "RBRACE")
        if depth < 0:
            return max(index, statement.start + 1)
        if depth == 0 and kind in ("SEMICOLON", "RBRACE") and index >= wrong:
            return index + 1
    return len(tokens)


def _unexpected(source: Source, token: Token, expected: frozenset[str]) -> Diagnostic:
    start = token.start_pos
    match token.type:
        case "$END":
            end = len(source.text)
            return of_file.unfinished(Span(source, end, end), expected)
        case "UNCLOSED_STRING":
            return of_file.unclosed_string(span_of(source, token))
        case "UNCLOSED_COMMENT":
            return of_file.unclosed_comment(Span(source, start, start + 2))
        case _:
            return of_file.unexpected(span_of(source, token), str(token), expected)
