"""Parsers from lark's grammars, with tables that were made beforehand: to make them takes a hundred times as long as to read them.

Beside a grammar `x.lark` lies `x.tables`: what `parsing.tables` makes of it, under the digest of what it was made from. Where the digest
is another one, because the grammar was changed, tables are made anew: that is slow, never wrong.

Lark makes the tables and `parsing.lalr` runs them. Lark could do both, but to import it and to read all of its tables takes 45 ms, a
fifth of what a first compile took; the driver looks at the states that a text leads to, and at no others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.parsing.lalr import Grammar
from rosetta_jit.startup.sha import sha256

if TYPE_CHECKING:
    from pathlib import Path

SUFFIX = ".tables"

LAYOUT = "3"
"""Of the tables; part of their digest."""

_TITLE = "%"
"""How the line begins that names a table, in a file of them."""


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
    tables = _read(grammar.with_suffix(SUFFIX))
    return Grammar(tables if tables.get("digest") == digest(text, start, mistake_tokens) else _made(text, start, mistake_tokens))


def tables_of(grammar: Path, *, start: str = "start", mistake_tokens: Sequence[str] = ()) -> str:
    """The text of a grammar's `.tables`; parameters as of `parser_of`."""
    tables = _made(grammar.read_text("utf-8"), start, mistake_tokens)
    return "".join(f"{_TITLE}{name}\n{table}\n" for name, table in tables.items())


def digest(text: str, start: str, mistake_tokens: Sequence[str]) -> str:
    """What tables depend on."""
    return sha256("\0".join((LAYOUT, start, *mistake_tokens, text)).encode()).hexdigest()


def _made(text: str, start: str, mistake_tokens: Sequence[str]) -> dict[str, str]:
    from rosetta_jit.parsing.tables import tables_of as make

    return {"digest": digest(text, start, mistake_tokens), **make(text, start=start, mistake_tokens=mistake_tokens)}


def _read(file: Path) -> Mapping[str, str]:
    try:
        text = file.read_text("utf-8")
    except FileNotFoundError:
        return {}
    parts = (table.partition("\n") for table in text.removeprefix(_TITLE).removesuffix("\n").split(f"\n{_TITLE}"))
    return {name: table for name, _, table in parts}
