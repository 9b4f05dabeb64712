"""Reading tokens one after the other; what cannot stand where it stands ends the statement around it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.omg import diagnostics as say

if TYPE_CHECKING:
    from rosetta_jit.frameworks.omg.lexer import Token
    from rosetta_jit.source import Span


class SyntaxProblem(Exception):  # noqa: N818  it is caught by the statement around it, and is no error of ours
    """A statement cannot be read on; ``problem`` says why."""

    def __init__(self, problem: Diagnostic) -> None:
        super().__init__(problem.message)
        self.problem = problem


class Cursor:
    """A place in a list of tokens, the last of which is `end`."""

    __slots__ = ("_index", "_tokens")

    def __init__(self, tokens: list[Token]) -> None:
        self._tokens = tokens
        self._index = 0

    @property
    def token(self) -> Token:
        """The one that is read next."""
        return self._tokens[self._index]

    @property
    def following(self) -> Token:
        """The one after that."""
        return self._tokens[min(self._index + 1, len(self._tokens) - 1)]

    @property
    def index(self) -> int:
        return self._index

    def take(self) -> Token:
        """Go past a token; the last one stays."""
        token = self.token
        if token.kind != "end":
            self._index += 1
        return token

    def sees(self, *texts: str) -> bool:
        """Whether the next token is one of some words or symbols."""
        return self.token.kind in ("word", "symbol") and self.token.text in texts

    def accept(self, text: str) -> Token | None:
        """Take a word or symbol if it is next."""
        return self.take() if self.sees(text) else None

    def expect(self, text: str) -> Token:
        """Take a word or symbol that must be next."""
        return self.take() if self.sees(text) else self.fail(f"`{text}`")

    def fail(self, wanted: str) -> Token:
        """Say that the next token cannot stand here."""
        raise SyntaxProblem(problem_with(self.token, wanted))

    def since(self, first: Token) -> Span:
        """The place of everything from a token to the last one taken."""
        last = self._tokens[max(self._index - 1, 0)].span
        same = last.source is first.span.source and last.end >= first.span.end
        return first.span.to(last) if same else first.span


def problem_with(token: Token, wanted: str) -> Diagnostic:
    """Why a token cannot stand where something else is wanted."""
    match token.kind, token.text[:1]:
        case "end", "\n":
            return say.end_of_line(token.span, wanted)
        case "end", _:
            return say.unfinished(token.span, wanted)
        case "wrong", "/":
            return say.unclosed_comment(token.span)
        case "wrong", '"' | "'":
            return say.unclosed_string(token.span)
        case "wrong", _:
            return say.stray(token.span, token.text)
        case _:
            return say.unexpected(token.span, token.text, wanted)
