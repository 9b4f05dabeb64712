"""Run an LALR parser over a text and go on after a mistake, so that one report names several.

A language says by `Recovery` where parsing can start again: at a token that begins a rule or a statement. Everything
that was open then is dropped, and so is the closing word of a block whose opening was lost.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.parsing.lalr import END, Grammar, Parser, Token, Tree, UnexpectedTokenError
from rosetta_jit.parsing.limits import MAX_ERRORS
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic


@dataclass(frozen=True, slots=True)
class Recovery:
    """Where to go on: token kind → a kind that is shifted only where such a token may begin something.

    Blocks begin with a token of ``opens``; with one of ``mistaken``, first in its line, by mistake.
    """

    starts: Mapping[str, str]
    only_first_in_line: frozenset[str]
    opens: frozenset[str]
    closes: str
    mistaken: frozenset[str] = frozenset()


Describe = Callable[[Span, str, frozenset[str]], "Diagnostic"]
"""Reports a token that does not fit: where, its kind, and the kinds that would."""


def parse_tokens(
    grammar: Grammar,
    source: Source,
    tokens: list[Token],
    recovery: Recovery,
    describe: Describe,
) -> Tree | list[Diagnostic]:
    """The tree of a text that has no syntax error, else what is wrong with it."""
    parser = grammar.parser()
    problems: list[Diagnostic] = []
    lost = 0  # blocks whose opening was dropped and whose closing word is still to come
    skipping = False
    for position, token in enumerate(tokens):
        if skipping:
            if not _starts(tokens, position, recovery, source):
                continue
            if token.type == recovery.closes and lost:
                lost -= 1
                continue
            dropped = _rewind(parser, recovery.starts[token.type], recovery.opens)
            if dropped is None:
                continue
            lost += dropped
            skipping = False
        elif token.type == recovery.closes and lost and token.type not in parser.accepted():
            lost -= 1
            continue
        if not _feed(parser, token):
            start = token.start_pos
            problems.append(describe(Span(source, start, start + len(token)), token.type, parser.accepted()))
            skipping = True
            lost += token.type in recovery.mistaken and _is_first(token, source)
            if len(problems) == MAX_ERRORS:
                return problems
    return _finish(parser, source, problems, describe, skipping=skipping)


def _finish(
    parser: Parser,
    source: Source,
    problems: list[Diagnostic],
    describe: Describe,
    *,
    skipping: bool,
) -> Tree | list[Diagnostic]:
    if skipping:
        return problems
    try:
        tree = parser.finish()
    except UnexpectedTokenError:
        end = len(source.text.rstrip())
        place = Span(source, max(0, end - 1), end)
        return [*problems, describe(place, END, parser.accepted())]
    return problems or tree


def _feed(parser: Parser, token: Token) -> bool:
    try:
        parser.feed(token)
    except UnexpectedTokenError:
        return False
    return True


def _starts(tokens: list[Token], position: int, recovery: Recovery, source: Source) -> bool:
    token = tokens[position]
    if token.type not in recovery.only_first_in_line or position == 0:
        return token.type in recovery.starts
    return _is_first(token, source)


def _is_first(token: Token, source: Source) -> bool:
    """Whether nothing but blanks stands before a token in its line."""
    line = source.text.rfind("\n", 0, token.start_pos) + 1
    return not source.text[line : token.start_pos].strip()


def _rewind(parser: Parser, kind: str, opens: frozenset[str]) -> int | None:
    """Drop what is open until a token of this kind fits; how many blocks were dropped, or None if it never would."""
    kept = next((height for height in range(len(parser.states), 0, -1) if parser.shifts(height, kind)), None)
    if kept is None:
        return None
    dropped = parser.values[kept - 1 :]
    del parser.states[kept:], parser.values[kept - 1 :]
    return sum(isinstance(value, Token) and value.type in opens for value in dropped)
