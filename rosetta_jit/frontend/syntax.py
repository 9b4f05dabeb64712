"""Run an LALR parser over a text and go on after a mistake, so that one report names several.

A language says by `Recovery` where parsing can start again: at a token that begins a rule or a statement. Everything
that was open then is dropped, and so is the closing word of a block whose opening was lost.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, cast

from lark.exceptions import UnexpectedToken
from lark.lexer import Token
from lark.parsers.lalr_analysis import Shift

from rosetta_jit.dataclass import dataclass
from rosetta_jit.source import Span

if TYPE_CHECKING:
    from collections.abc import Mapping

    from lark import Lark, Tree

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.source import Source

MAX_ERRORS = 20
"""Later mistakes of a text are mostly consequences of earlier ones."""

END_OF_TEXT = "$END"


@dataclass(frozen=True, slots=True)
class Recovery:
    """Where to go on: token kind → a kind that is shifted only where such a token may begin something."""

    starts: Mapping[str, str]
    only_first_in_line: frozenset[str]
    opens: frozenset[str]
    closes: str


Describe = Callable[[Span, str, frozenset[str]], "Diagnostic"]
"""Reports a token that does not fit: where, its kind, and the kinds that would."""


def parse_tokens(
    grammar: Lark,
    source: Source,
    tokens: list[Token],
    recovery: Recovery,
    describe: Describe,
) -> Tree[Token] | list[Diagnostic]:
    """The tree of a text that has no syntax error, else what is wrong with it."""
    parser: Any = cast("Any", grammar).parse_interactive("")  # lark types it in part only
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
        elif token.type == recovery.closes and lost and token.type not in _accepted(parser):
            lost -= 1
            continue
        if not _feed(parser, token):
            start = token.start_pos or 0
            problems.append(describe(Span(source, start, start + len(token)), token.type, _accepted(parser)))
            skipping = True
            if len(problems) == MAX_ERRORS:
                return problems
    return _finish(parser, source, problems, describe, skipping=skipping)


def _finish(
    parser: Any,
    source: Source,
    problems: list[Diagnostic],
    describe: Describe,
    *,
    skipping: bool,
) -> Tree[Token] | list[Diagnostic]:
    if skipping:
        return problems
    try:
        tree: Tree[Token] = parser.feed_eof()
    except UnexpectedToken:
        end = len(source.text.rstrip())
        place = Span(source, max(0, end - 1), end)
        return [*problems, describe(place, END_OF_TEXT, _accepted(parser))]
    return problems or tree


def _feed(parser: Any, token: Token) -> bool:
    try:
        parser.feed_token(token)
    except UnexpectedToken:
        return False
    return True


def _accepted(parser: Any) -> frozenset[str]:
    return frozenset(parser.accepts())


def _starts(tokens: list[Token], position: int, recovery: Recovery, source: Source) -> bool:
    token = tokens[position]
    if token.type not in recovery.only_first_in_line or position == 0:
        return token.type in recovery.starts
    between = source.text[tokens[position - 1].end_pos : token.start_pos]
    return "\n" in between


def _rewind(parser: Any, kind: str, opens: frozenset[str]) -> int | None:
    """Drop what is open until a token of this kind fits; how many blocks were dropped, or None if it never would."""
    state = parser.parser_state
    table: dict[int, dict[str, tuple[object, int]]] = state.parse_conf.parse_table.states
    depths = range(len(state.state_stack), 0, -1)
    # A state may also accept a token in order to reduce, with look-aheads merged from elsewhere: only a shift is sure.
    kept = next((n for n in depths if table[state.state_stack[n - 1]].get(kind, (None, 0))[0] is Shift), None)
    if kept is None:
        return None
    dropped: list[object] = state.value_stack[kept - 1 :]
    del state.state_stack[kept:], state.value_stack[kept - 1 :]
    return sum(isinstance(value, Token) and value.type in opens for value in dropped)
