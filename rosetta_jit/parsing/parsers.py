"""Parsers from lark's grammars, with tables that were made beforehand: to make them takes a hundred times as long as to read them.

Beside a grammar `x.lark` lies `x.tables`: what `parsing.tables` makes of it as JSON, under the digest of what it was made from. Where the
digest is another one, because the grammar was changed, tables are made anew: that is slow, never wrong.

Lark makes the tables and `parsing.lalr` runs them. Lark could do both, but to import it and to read all of its tables takes 45 ms, a
fifth of what a first compile took; the driver looks at the states that a text leads to, and at no others.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

from rosetta_jit.parsing.lalr import Grammar
from rosetta_jit.startup.sha import sha256

if TYPE_CHECKING:
    from pathlib import Path

SUFFIX = ".tables"

LAYOUT = "2"
"""Of the tables; part of their digest."""


def parser_of(grammar: Path, *, start: str = "start", mistake_tokens: Sequence[str] = ()) -> Grammar:
    """The parser of a grammar.

    Parameters
    ----------
    grammar
        A `.lark` file.
    start
        The rule of a whole text.
    mistake_tokens
        Tokens that no rule has, and that are tokens all the same: they stand for mistakes.
    """
    text = grammar.read_text("utf-8")
    plain = _read(grammar.with_suffix(SUFFIX))
    return Grammar(plain if plain.get("digest") == digest(text, start, mistake_tokens) else _made(text, start, mistake_tokens))


def tables_of(grammar: Path, *, start: str = "start", mistake_tokens: Sequence[str] = ()) -> str:
    """The text of a grammar's `.tables`; parameters as of `parser_of`."""
    parts = _made(grammar.read_text("utf-8"), start, mistake_tokens).items()
    return "{" + ",\n".join(f"{json.dumps(name)}: {_lines(part)}" for name, part in parts) + "}\n"


def _lines(part: object) -> str:
    """JSON of which each element of a list has a line."""
    if isinstance(part, list):
        return "[\n" + ",\n".join(json.dumps(each) for each in cast("list[object]", part)) + "\n]"
    return json.dumps(part)


def digest(text: str, start: str, mistake_tokens: Sequence[str]) -> str:
    """What tables depend on."""
    return sha256("\0".join((LAYOUT, start, *mistake_tokens, text)).encode()).hexdigest()


def _made(text: str, start: str, mistake_tokens: Sequence[str]) -> dict[str, Any]:
    from rosetta_jit.parsing.tables import tables_of as make

    return {"digest": digest(text, start, mistake_tokens), **make(text, start=start, mistake_tokens=mistake_tokens)}


def _read(tables: Path) -> dict[str, Any]:
    try:
        return json.loads(tables.read_text("utf-8"))
    except FileNotFoundError:
        return {}
