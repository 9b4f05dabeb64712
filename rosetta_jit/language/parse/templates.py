"""Values in the text of a rejection: `"frame {.name} has {.count} joints"`; `{{` and `}}` stand for braces.

What stands in braces is parsed as the condition of a rejection, the only rule of a block.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

from rosetta_jit.catalogue import mapping as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.limits import MAX_PIECES, MAX_TOKENS, MAX_VALUE_TOKENS
from rosetta_jit.model.expr import Expr, Literal
from rosetta_jit.parsing.lalr import Grammar, Token, Tree
from rosetta_jit.parsing.parsers import parser_of
from rosetta_jit.parsing.syntax import Recovery, parse_tokens
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import replace

GRAMMAR = Path(__file__).with_name("mapping.lark")
MISTAKES = ("UNCLOSED", "STRANGE")
"""Tokens that stand for mistakes."""

PIECES = r"\{\{|\}\}|\{[^{}]*\}|[{}]"


BEFORE = (("UNPACK_RULES", "unpack-rules"), ("COLON", ":"), ("REJECT", "reject"), ("STRING", '""'), ("GUARD", "when"))
"""The tokens before a condition."""

NOWHERE = Recovery({}, frozenset(), opens=frozenset(), closes="")


def pieces_of(text: str, place: Span, problems: list[Diagnostic], read: Callable[[Tree], Expr]) -> tuple[Expr, ...]:
    """The texts and values that a template consists of; none where it has no braces.

    Parameters
    ----------
    text
        What the quoted text at ``place`` stands for.
    read
        Makes an expression of its tree.
    """
    found: list[Expr] = []
    at = 0
    for match in re.finditer(PIECES, text):
        found.append(Literal(text[at : match.start()], place))
        at = match.end()
        here = Span(place.source, *(min(place.start + 1 + end, place.end) for end in match.span()))
        if match[0] in {"{{", "}}"}:
            found.append(Literal(match[0][0], place))
        elif match[0] in {"{", "}"}:
            problems.append(words.lone_brace(here))
        else:
            value = _value(match[0][1:-1], here, problems)
            found += [] if value is None else [read(value)]
    found.append(Literal(text[at:], place))
    pieces = tuple(piece for piece in found if not (isinstance(piece, Literal) and piece.value == ""))
    if len(pieces) > MAX_PIECES:
        problems.append(words.many_pieces(place, MAX_PIECES))
        return ()
    return pieces if at else ()


def _value(text: str, place: Span, problems: list[Diagnostic]) -> Tree | None:
    """The tree of what stands in braces; mistakes at its end are reported for all of it."""
    inside = Span(place.source, place.start + 1, place.end)
    found: list[Diagnostic] = []
    tree = expression_tree(text, inside, found, most=MAX_VALUE_TOKENS)
    problems.extend(problem if problem.span != inside and _is_in(problem, place) else replace(problem, span=place) for problem in found)
    return tree


def expression_tree(text: str, place: Span, problems: list[Diagnostic], *, most: int = MAX_TOKENS) -> Tree | None:
    """The tree of an expression that begins at a place and has at most so many tokens."""
    tokens = [token.at(place.start + token.start_pos, place.start + token.end_pos) for token in grammar().lex(text)]
    if len(tokens) > most:
        problems.append(words.nesting(place, most))
        return None
    before = [Token(kind, text, place.start, place.start) for kind, text in BEFORE]
    tree = tree_of([*before, *tokens], place.source, NOWHERE)
    if not isinstance(tree, Tree):
        problems.extend(tree)
        return None
    statements = [rules for rules in tree.children if isinstance(rules, Tree)]
    found = [rule for rules in statements for rule in rules.children if isinstance(rule, Tree)]
    if len(found) > 1 or len(statements) > 1:
        problems.append(words.no_value(place))
        return None
    return next(value for value in found[0].children if isinstance(value, Tree))


def tree_of(tokens: list[Token], source: Source, recovery: Recovery) -> Tree | list[Diagnostic]:
    """The tree of tokens of the mapping language, else what is wrong with them."""

    def unexpected(place: Span, kind: str, expected: frozenset[str]) -> Diagnostic:
        return words.unexpected(place, kind, expected)

    return parse_tokens(grammar(), source, tokens, recovery, unexpected)


def _is_in(problem: Diagnostic, place: Span) -> bool:
    return problem.span is not None and place.start <= problem.span.start and problem.span.end <= place.end


@cache
def grammar() -> Grammar:
    """The parser of mappings."""
    return parser_of(GRAMMAR, mistake_tokens=MISTAKES)
