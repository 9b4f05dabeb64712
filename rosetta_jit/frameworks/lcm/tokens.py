r"""Text to words, cut where lcm-gen cuts it.

A name ends at white space, at an operator, and at any of ``( ) ; " , : ' [ ]``; braces and slashes do not end it. So ``struct t{`` is the
beginning of a struct named ``t{`` to lcm-gen, and ``a//text`` a field. Here such words are cut, and the missing space is a problem.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.lcm import diagnostics as say
from rosetta_jit.frameworks.lcm.limits import MAX_PROBLEMS
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.source import Source

_SPACE = r" \t\n\v\f\r"
_ENDS = r"();\",:'\[\]!~<>=&|^%*+"

_WORDS = re.compile(
    rf"""
      (?P<space> [{_SPACE}]+)
    | (?P<comment> //[^\n]* | /\*.*?\*/)
    | (?P<unclosed> /\*.*)
    | (?P<text> "[^"\n]*"? | '[^'\n]*'?)
    | (?P<operator> [!~<>=&|^%*+]+)
    | (?P<mark> [();,:\[\]])
    | (?P<brace> [{{}}])
    | (?P<name> / | [^{_SPACE}{_ENDS}{{}}/]+)
    """,
    re.VERBOSE | re.DOTALL,
)

_NOT_CUT = frozenset(("name", "brace"))
"""What lcm-gen reads on from, if no space stands behind it."""


@dataclass(frozen=True, slots=True)
class Token:
    """A word and where it stands. ``behind`` is where the one before it ends: comments lie between."""

    text: str
    start: int
    end: int
    behind: int


def tokens(source: Source, problems: list[Diagnostic]) -> list[Token]:
    """The words of a text, without its comments."""
    return list(_tokens(source, problems))


def _tokens(source: Source, problems: list[Diagnostic]) -> Iterator[Token]:
    before, behind = "", 0
    for match in _WORDS.finditer(source.text):
        kind = match.lastgroup or ""
        start, end = match.span()
        if before in _NOT_CUT and kind in {"name", "brace", "comment", "unclosed"} and len(problems) < MAX_PROBLEMS:
            problems.append(say.no_space(Span(source, start, min(end, start + 2 if kind == "comment" else end))))
        if kind == "unclosed":
            problems.append(say.unclosed_comment(Span(source, start, start + 2)))
        if kind not in {"space", "comment", "unclosed"}:
            yield Token(match.group(), start, end, behind)
            behind = end
        before = kind


def comment_before(source: Source, token: Token) -> str:
    """The comments between a word and the one before it, save what stands on the line of that one; markers are left out."""
    between = source.text[token.behind : token.start]
    own = between if token.behind == 0 else between.partition("\n")[2]
    found = [_bare(match.group()) for match in _WORDS.finditer(own) if match.lastgroup == "comment"]
    return "\n".join(found).strip()


def _bare(comment: str) -> str:
    if comment.startswith("//"):
        return comment.lstrip("/").strip()
    return "\n".join(line.strip().lstrip("*").strip() for line in comment[2:-2].split("\n")).strip()
