"""From a grammar in lark's language to the tables that drive our parser, each a text. Only here lark is imported.

pattern     what tokens match
ignored     which kinds of them are left out
words       which texts of a kind are another kind: `kind text other` in a line
symbols     kinds of tokens, and names of rules
rules       the fields of each `lalr.Rule`: `name data size thin|whole parts` in a line; the parts that are kept, dissolved ones with a `*`
states      for each its actions in a line: `state:symbol,symbol` where one follows, `~rule:symbol` where a rule is complete
start, end  the first state, and the one behind the whole text
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any, cast

from lark import Lark
from lark.lark import PostLex
from lark.lexer import PatternStr
from lark.parsers.lalr_analysis import Shift

if TYPE_CHECKING:
    from lark import Token
    from lark.grammar import Rule, Symbol, Terminal


def tables_of(text: str, *, start: str, mistake_tokens: Sequence[str]) -> dict[str, str]:
    """The tables of a grammar.

    Parameters
    ----------
    text
        The grammar, as lark reads it.
    start
        The rule of a whole text.
    mistake_tokens
        Tokens that no rule has, and that are tokens all the same: they stand for mistakes.
    """
    made: Any = lark_of(text, start=start, mistake_tokens=mistake_tokens)  # lark types it in part only
    table = made.parser.parser._parse_table  # noqa: SLF001 - what lark writes into its own files, too
    rules: list[Rule] = sorted(made.rules, key=lambda rule: (rule.origin.name, rule.order))
    order = _reached(table.states, table.start_states[start])
    symbols = sorted({symbol for actions in table.states.values() for symbol in actions})
    return {
        **_lexer(made.parser.lexer.lexer),
        "symbols": "\n".join(symbols),
        "rules": "\n".join(map(_rule, rules)),
        "states": "\n".join(_row(table.states[state], order, rules, symbols) for state in order),
        "start": str(order[table.start_states[start]]),
        "end": str(order[table.end_states[start]]),
    }


def lark_of(text: str, *, start: str, mistake_tokens: Sequence[str]) -> Lark:
    """Lark's own parser of the same language."""
    postlex = _KeptTokens(mistake_tokens)
    return Lark(text, start=start, parser="lalr", lexer="basic", postlex=postlex, propagate_positions=True, maybe_placeholders=False)


class _KeptTokens(PostLex):
    """Makes lark keep tokens that no rule has."""

    def __init__(self, always_accept: Sequence[str]) -> None:
        self.always_accept = always_accept

    def process(self, stream: Iterator[Token]) -> Iterator[Token]:
        return stream


def _lexer(lexer: Any) -> dict[str, str]:
    """One pattern of all tokens, in the order in which they are tried; words that are kinds of their own are told apart behind it."""
    scanner: Any = lexer.scanner  # lark has no other way to ask
    words: list[tuple[str, str, str]] = []
    for kind, unless in lexer.callback.items():
        words += sorted((kind, each.pattern.value, each.name) for each in unless.scanner.terminals)
    groups: list[str] = []
    for is_literal, run in groupby(scanner.terminals, _is_literal):
        terminals = list(run)
        if is_literal and len(terminals) > 1:
            kind = f"__LITERAL_{len(groups)}"
            words += [(kind, each.pattern.value, each.name) for each in terminals]
            groups.append(f"(?P<{kind}>{_alternatives([each.pattern.value for each in terminals])})")
        else:
            groups += [f"(?P<{each.name}>{each.pattern.to_regexp()})" for each in terminals]
    return {
        "pattern": _printable("|".join(groups)),
        "ignored": "\n".join(sorted(lexer.ignore_types)),
        "words": "\n".join(map(" ".join, words)),
    }


def _printable(pattern: str) -> str:
    """The same pattern in one line: spaces other than a blank are written as escapes."""
    return re.sub(r"\\?([\t\n\v\f\r])|\\.", lambda found: repr(found[1])[1:-1] if found[1] else found[0], pattern)


def _alternatives(texts: Sequence[str]) -> str:
    """A pattern of several texts, in their order; the signs at the end as one set."""
    first = next((at for at in range(len(texts)) if all(len(each) == 1 for each in texts[at:])), len(texts))
    signs = "".join(map(re.escape, texts[first:]))
    return "|".join([*map(re.escape, texts[:first]), *([f"[{signs}]"] if signs else [])])


def _is_literal(terminal: Any) -> bool:
    """Whether a terminal is a text, as signs and words are: a group for each of them would take most of the time to compile the pattern."""
    return isinstance(terminal.pattern, PatternStr) and not terminal.pattern.flags


def _reached(states: Mapping[Any, Mapping[str, tuple[Any, Any]]], start: Any) -> dict[Any, int]:
    """The numbers of all states, in the order in which they are reached: the same for each grammar, while lark's are not."""
    order = {start: 0}
    pending = [start]
    for state in pending:
        for _, (action, argument) in sorted(states[state].items()):
            if action is Shift and argument not in order:
                order[argument] = len(order)
                pending.append(argument)
    return order


def _rule(rule: Rule) -> str:
    expansion = rule.expansion
    kept = [
        f"{number}{'*' if _is_dissolved(part) else ''}"
        for number, part in enumerate(expansion)
        if rule.options.keep_all_tokens or not _is_left_out(part)
    ]
    is_plain = kept == [str(number) for number in range(len(expansion))]
    shape = "thin" if rule.options.expand1 and rule.alias is None else "whole"
    data = rule.alias or rule.options.template_source or rule.origin.name
    return f"{rule.origin.name} {data} {len(expansion)} {shape} {'all' if is_plain else ','.join(kept) or 'none'}"


def _is_left_out(part: Symbol) -> bool:
    return part.is_term and cast("Terminal", part).filter_out


def _is_dissolved(part: Symbol) -> bool:
    return not part.is_term and part.name.startswith("_")


def _row(actions: Mapping[str, tuple[Any, Any]], order: Mapping[Any, int], rules: Sequence[Rule], symbols: Sequence[str]) -> str:
    numbers = {symbol: number for number, symbol in enumerate(symbols)}
    grouped: dict[int, list[str]] = {}
    for symbol, (action, argument) in sorted(actions.items()):
        grouped.setdefault(order[argument] if action is Shift else ~rules.index(argument), []).append(str(numbers[symbol]))
    return " ".join(f"{action}:{','.join(listed)}" for action, listed in sorted(grouped.items()))
