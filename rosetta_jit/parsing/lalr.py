"""An LALR(1) parser that is driven by tables: text → tokens → tree.

    Node = Token | Tree(rule, Node…)

The tables are made from a grammar by lark, in `parsing.tables`; lark itself is not needed to use them. Trees are lark's: a rule's tokens
without a name of their own are left out, rules whose names start with `_` are dissolved into the one around them, and those that are marked
by `?` stand for their only part.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Self

from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.dataclass import dataclass

END = "$END"
"""The kind of what follows the last token."""

NOWHERE = -1
"""The place of a tree that no token is in."""


class Token(str):
    """A word or sign of a text: its kind, and where it stands, as indices of characters."""

    __slots__ = ("end_pos", "start_pos", "type")

    type: str
    start_pos: int
    end_pos: int

    def __new__(cls, type_: str, text: str, start_pos: int, end_pos: int) -> Self:
        token = super().__new__(cls, text)
        token.type, token.start_pos, token.end_pos = type_, start_pos, end_pos
        return token

    def of_kind(self, type_: str) -> Token:
        """The same, as another kind of token."""
        return Token(type_, self, self.start_pos, self.end_pos)

    def at(self, start_pos: int, end_pos: int) -> Token:
        """The same, elsewhere."""
        return Token(self.type, self, start_pos, end_pos)


class Tree:
    """What a rule matched. ``places`` are its start and end, then those of what it stands for: brackets around it may be left out."""

    __slots__ = ("children", "data", "places")

    def __init__(self, data: str, children: list[Tree | Token]) -> None:
        self.data, self.children = data, children
        self.places: tuple[int, int, int, int] = (NOWHERE, NOWHERE, NOWHERE, NOWHERE)

    @property
    def start_pos(self) -> int:
        return self.places[0]

    @property
    def end_pos(self) -> int:
        return self.places[1]


class UnexpectedCharacterError(ValueError):
    """No token starts at an index of the text."""

    def __init__(self, at: int) -> None:
        super().__init__(at)
        self.at = at


class UnexpectedTokenError(ValueError):
    """A token that cannot follow those before it; the parser is as it was before, but for what was complete and is a tree now."""

    def __init__(self, token: Token) -> None:
        super().__init__(str(token))
        self.token = token


@dataclass(frozen=True, slots=True)
class Rule:
    """How a rule's parts become a tree.

    Attributes
    ----------
    name, data
        What the parser looks up when it is complete, and what the tree is called.
    size
        The number of its parts.
    kept
        The parts that the tree has, and whether each is dissolved in it; None for all as they are.
    is_thin
        Whether it stands for its part where it has but one.
    """

    name: str
    data: str
    size: int
    kept: Sequence[tuple[int, bool]] | None
    is_thin: bool

    @property
    def is_its_part(self) -> bool:
        """Whether it is never more than its only part, as most that are complete behind a word of an expression."""
        return self.size == 1 and self.is_thin and self.kept is None

    def built(self, parts: list[Any]) -> Tree | Token:
        """The tree of its parts."""
        children = parts if self.kept is None else _kept(parts, self.kept)
        if not (self.is_thin and len(children) == 1):
            return _placed(Tree(self.data, children), parts)
        built = children[0]
        return built if len(parts) == 1 or type(built) is Token else _placed(built, parts)


def _kept(parts: list[Any], kept: Sequence[tuple[int, bool]]) -> list[Any]:
    children: list[Any] = []
    for number, is_dissolved in kept:
        if not is_dissolved:
            children.append(parts[number])
        elif children:
            children += parts[number].children
        else:
            children = parts[number].children  # a list grows by one rule an element: to copy it each time would be quadratic
    return children


def _placed(tree: Tree, parts: list[Any]) -> Tree:
    """The tree with its places: its own are the first that it gets; as a thin rule's only part it stands for all of that text."""
    start, end, before, behind = tree.places
    for part in parts:
        found = part.places[2] if type(part) is Tree else part.start_pos
        if found != NOWHERE:
            before = found
            break
    for part in reversed(parts):
        found = part.places[3] if type(part) is Tree else part.end_pos
        if found != NOWHERE:
            behind = found
            break
    tree.places = (before if start == NOWHERE else start, behind if end == NOWHERE else end, before, behind)
    return tree


class Grammar:
    """Tables as they stand in a file: see `parsing.tables`. Of the states only those are looked at that a text leads to."""

    def __init__(self, tables: Mapping[str, str]) -> None:
        self.tables = tables
        self.start, self.end = int(tables["start"]), int(tables["end"])
        """The first state, and the one behind the whole text."""

    def lex(self, text: str) -> Iterator[Token]:
        """The tokens of a text, one by one; raises UnexpectedCharacterError where none starts."""
        match, ignored, words = self._pattern.match, self._ignored, self._words
        at = 0
        while at < len(text):
            found = match(text, at)
            if found is None:
                raise UnexpectedCharacterError(at)
            start, at, kind = at, found.end(), found.lastgroup or ""
            if kind not in ignored:
                word = found[0]
                yield Token(words[kind].get(word, kind) if kind in words else kind, word, start, at)

    def parser(self) -> Parser:
        """A parser before its first token."""
        return Parser(self, [self.start], [])

    def parse(self, tokens: Iterator[Token]) -> Tree:
        """The tree of a whole text."""
        parser = self.parser()
        for token in tokens:
            parser.feed(token)
        return parser.finish()

    def actions(self, state: int) -> Mapping[str, int]:
        """What to do in a state at a kind of token or behind a rule: the next state, or the complement of a complete rule's number."""
        found = self._looked_at.get(state)
        if found is None:
            found = self._looked_at[state] = _row(self._states[state], self._symbols)
        return found

    def step(self, below: int, state: int, kind: str) -> tuple[int, int | None]:
        """What to do before a kind of token in a state above another one: the state once rules that are no more than their only part are
        complete, and its action; None if the token does not fit.
        """
        asked, action = (below, state, kind), self.actions(state).get(kind)
        while below != NOWHERE and action is not None and action < 0 and self.rules[~action].is_its_part:
            state = self.actions(below)[self.rules[~action].name]
            action = self.actions(state).get(kind)
        found = self.steps[asked] = state, action
        return found

    @cached_property
    def rules(self) -> tuple[Rule, ...]:
        """By the complements of the actions that say they are complete."""
        return tuple(map(_rule, self.tables["rules"].split("\n")))

    @cached_property
    def steps(self) -> dict[tuple[int, int, str], tuple[int, int | None]]:
        """What `step` has been asked."""
        return {}

    @cached_property
    def _pattern(self) -> re.Pattern[str]:
        return re.compile(self.tables["pattern"])

    @cached_property
    def _ignored(self) -> frozenset[str]:
        return frozenset(self.tables["ignored"].split())

    @cached_property
    def _words(self) -> dict[str, dict[str, str]]:
        """The kinds of texts that the pattern finds as another kind."""
        words: dict[str, dict[str, str]] = {}
        for line in self.tables["words"].split("\n"):
            found, text, kind = line.split()
            words.setdefault(found, {})[text] = kind
        return words

    @cached_property
    def _symbols(self) -> Sequence[str]:
        return self.tables["symbols"].split()

    @cached_property
    def _states(self) -> Sequence[str]:
        return self.tables["states"].split("\n")

    @cached_property
    def _looked_at(self) -> dict[int, Mapping[str, int]]:
        return {}


def _rule(line: str) -> Rule:
    """A rule, from `name data size shape parts`."""
    name, data, size, shape, parts = line.split()
    kept = None if parts == "all" else [(int(part.rstrip("*")), part.endswith("*")) for part in parts.split(",") if part != "none"]
    return Rule(name, data, int(size), kept, shape == "thin")


def _row(text: str, symbols: Sequence[str]) -> dict[str, int]:
    """A state's actions, from `action:symbol,symbol action:symbol`."""
    groups = (group.split(":") for group in text.split())
    return {symbols[int(symbol)]: int(action) for action, listed in groups for symbol in listed.split(",")}


@dataclass(frozen=True, slots=True)
class Parser:
    """The stacks of a parse: states, and between two of them what was read. Whoever goes on after a mistake takes from both."""

    grammar: Grammar
    states: list[int]
    values: list[Tree | Token]

    def feed(self, token: Token) -> None:
        """Take the next token; UnexpectedTokenError if it does not fit."""
        action = self._reduce(token)
        self.states.append(action)
        self.values.append(token)

    def finish(self) -> Tree:
        """The tree, if the text may end here, else UnexpectedTokenError."""
        self._reduce(Token(END, "", NOWHERE, NOWHERE))
        (tree,) = self.values
        assert isinstance(tree, Tree)
        return tree

    def accepted(self) -> frozenset[str]:
        """The kinds of tokens that fit here, `END` included."""
        return frozenset(kind for kind in self.grammar.actions(self.states[-1]) if kind.isupper() and self._fits(kind))

    def shifts(self, height: int, kind: str) -> bool:
        """Whether a token would follow at once if only so many states were there: a rule may be complete at one that does not fit."""
        return self.grammar.actions(self.states[height - 1]).get(kind, NOWHERE) >= 0

    def _reduce(self, token: Token) -> int:
        """Make trees of what is complete before a token; the state behind the token then, or the last one at the end."""
        grammar, states, values = self.grammar, self.states, self.values
        rules, steps, last, kind = grammar.rules, grammar.steps, grammar.end, token.type
        while True:
            below = states[-2] if len(states) > 1 else NOWHERE
            states[-1], action = steps.get((below, states[-1], kind)) or grammar.step(below, states[-1], kind)
            if action is None:
                raise UnexpectedTokenError(token)
            if action >= 0:
                return action
            rule = rules[~action]
            first = len(values) - rule.size
            built = rule.built(values[first:])
            del values[first:], states[first + 1 :]
            values.append(built)
            states.append(grammar.actions(states[-1])[rule.name])
            if states[-1] == last and kind == END:
                return last

    def _fits(self, kind: str) -> bool:
        states = self.states.copy()
        while True:
            action = self.grammar.actions(states[-1]).get(kind)
            if action is None or action >= 0:
                return action is not None
            rule = self.grammar.rules[~action]
            del states[len(states) - rule.size :]
            states.append(self.grammar.actions(states[-1])[rule.name])
            if states[-1] == self.grammar.end and kind == END:
                return True
