"""Parsers from lark's grammars, with tables that were made beforehand: to make them takes ten times as long as to read them.

Beside a grammar `x.lark` lies `x.tables`: lark's own description of the parser as JSON, under the digest of what it was made from. Where
the digest is another one, because the grammar was changed or lark is of another version, tables are made anew: that is slow, never wrong.
"""

from __future__ import annotations

import json
from operator import itemgetter
from typing import TYPE_CHECKING, Any, cast

import lark
from lark import Lark
from lark.grammar import Rule
from lark.lexer import TerminalDef

from rosetta_jit.sha import sha256

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from lark.lark import PostLex

SUFFIX = ".tables"


def parser_of(grammar: Path, *, start: str = "start", postlex: PostLex | None = None, positions: bool = False) -> Lark:
    """The LALR parser of a grammar, with a lexer that knows no context.

    Parameters
    ----------
    grammar
        A `.lark` file.
    start
        The rule of a whole text.
    postlex
        What the tokens pass through; its ``always_accept`` names tokens that no rule has.
    positions
        Whether trees know where they stand in the text.
    """
    text = grammar.read_text("utf-8")
    made = _read(grammar.with_suffix(SUFFIX), digest(text, start, positions=positions), postlex)
    return _quick(made or _make(text, start, postlex, positions=positions))


def _quick(parser: Lark) -> Lark:
    """The parser, without work for rules that stand for their one part alone: each level of precedence is one for most expressions.

    Lark would look for positions, and find those that the part has.
    """
    callbacks: dict[Rule | str, Callable[[list[Any]], Any]] = cast("Any", parser).parser.parser.parser.callbacks
    for rule in callbacks:
        # Terminals are callbacks' names too.
        if isinstance(rule, Rule) and rule.options.expand1 and rule.alias is None and len(rule.expansion) == 1:
            (part,) = rule.expansion
            if not part.is_term and not part.name.startswith("_"):
                callbacks[rule] = itemgetter(0)
    return parser


def tables_of(grammar: Path, *, start: str = "start", postlex: PostLex | None = None, positions: bool = False) -> str:
    """The text of a grammar's `.tables`; parameters as of `parser_of`."""
    text = grammar.read_text("utf-8")
    lark_types = cast("Any", _make(text, start, postlex, positions=positions))
    data, memo = lark_types.memo_serialize([TerminalDef, Rule])
    data["options"]["postlex"] = None  # an object of the process
    plain = {"digest": digest(text, start, positions=positions), "data": data, "memo": memo}
    return json.dumps(plain, separators=(",", ":")) + "\n"


def digest(text: str, start: str, *, positions: bool) -> str:
    """What tables depend on."""
    return sha256("\0".join((lark.__version__, start, str(positions), text)).encode()).hexdigest()


def _make(text: str, start: str, postlex: PostLex | None, *, positions: bool) -> Lark:
    return Lark(text, start=start, parser="lalr", lexer="basic", postlex=postlex, propagate_positions=positions, maybe_placeholders=False)


def _read(tables: Path, wanted: str, postlex: PostLex | None) -> Lark | None:
    """The parser that a file describes, if it is there and was made from what is wanted."""
    try:
        plain: dict[str, Any] = json.loads(tables.read_text("utf-8"))
    except FileNotFoundError:
        return None
    if plain["digest"] != wanted:
        return None
    data, memo = plain["data"], {int(number): each for number, each in plain["memo"].items()}
    table = data["parser"]["parser"]
    table["tokens"] = {int(number): each for number, each in table["tokens"].items()}
    table["states"] = {int(state): {int(token): each for token, each in actions.items()} for state, actions in table["states"].items()}
    data["options"]["postlex"] = postlex
    return cast("Any", Lark).load({"data": data, "memo": memo})  # besides files it takes what it would read from them
