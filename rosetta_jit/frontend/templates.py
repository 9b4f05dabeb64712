"""Values in the text of a rejection: `"frame {.name} has {.count} joints"`; `{{` and `}}` stand for braces.

What stands in braces is parsed by the grammar of the mapping language, on its own.
"""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from lark import Lark, Token, Tree

from rosetta_jit.catalogue import mapping as words
from rosetta_jit.frontend.syntax import Recovery, parse_tokens
from rosetta_jit.model.expr import Literal
from rosetta_jit.source import Span

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.model.expr import Expr

PIECES = re.compile(r"\{\{|\}\}|\{[^{}]*\}|[{}]")
MAX_PIECES = 20
"""Values and the texts between them."""

MAX_TOKENS = 64
"""Of a value: that bounds how deep it nests."""

NOWHERE = Recovery({}, frozenset(), opens=frozenset(), closes="")


def pieces_of(text: str, place: Span, problems: list[Diagnostic], read: Callable[[Tree[Token]], Expr]) -> tuple[Expr, ...]:
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
    for match in PIECES.finditer(text):
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


def _value(text: str, place: Span, problems: list[Diagnostic]) -> Tree[Token] | None:
    """The tree of what stands in braces; mistakes at its end are reported for all of it."""
    tokens: list[Token] = list(cast("Any", _grammar()).lex(text))  # lark types it in part only
    if len(tokens) > MAX_TOKENS:
        problems.append(words.nesting(place, MAX_TOKENS))
        return None
    for token in tokens:
        token.start_pos, token.end_pos = (place.start + 1 + (end or 0) for end in (token.start_pos, token.end_pos))
    tree = parse_tokens(_grammar(), place.source, tokens, NOWHERE, words.unexpected)
    if isinstance(tree, Tree):
        (value,) = (child for child in tree.children if isinstance(child, Tree))
        return value
    problems.extend(problem if _is_in(problem, place) else replace(problem, span=place) for problem in tree)
    return None


def _is_in(problem: Diagnostic, place: Span) -> bool:
    return problem.span is not None and place.start <= problem.span.start and problem.span.end <= place.end


@cache
def _grammar() -> Lark:
    text = Path(__file__).with_name("mapping.lark").read_text(encoding="utf-8")
    return Lark(text, parser="lalr", lexer="basic", start="value", propagate_positions=True, maybe_placeholders=False)
