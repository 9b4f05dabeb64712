"""The rules of one direction as lines of text, each with where it came from, what it links, and what it does to values."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.dataclass import dataclass
from rosetta_jit.explain.nodes import by_span, names_of, places, span_of
from rosetta_jit.explain.notes import Note, notes
from rosetta_jit.lowering import typed
from rosetta_jit.lowering.inverse_texts import as_written
from rosetta_jit.model.expr import Member, Path
from rosetta_jit.model.mapping import Assign, Default, For, Ignore, Reject, SameNames, SetLength, When
from rosetta_jit.model.printer import show_expr

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.explain.nodes import Key
    from rosetta_jit.lowering.typed import Rule
    from rosetta_jit.model.expr import Expr, Side
    from rosetta_jit.model.mapping import Mapping
    from rosetta_jit.model.mapping import Rule as Untyped
    from rosetta_jit.source import Span

Names = tuple[str, ...]

MAX_LINES = 2_000
"""Rules that are shown."""


@dataclass(frozen=True, slots=True)
class Line:
    """A rule, or the head of a block of rules.

    ``block`` is where it is written: ``rules`` has been turned into this direction. ``sets`` and ``reads`` are fields, without indices.
    """

    text: str
    depth: int
    line: int | None
    block: str
    sets: tuple[Names, ...]
    reads: tuple[Names, ...]
    notes: tuple[Note, ...]


@dataclass(frozen=True, slots=True)
class Lines:
    """Makes lines of one direction; ``written`` is the mapping as its text says, before anything was derived."""

    written: Mapping
    direction: str
    target: Side
    typed: dict[Key, list[Rule]]

    @classmethod
    def of(cls, written: Mapping, direction: str, rules: tuple[Rule, ...]) -> Lines:
        return cls(written, direction, "holder" if direction == "unpack" else "wire", by_span(rules))

    def lines(self, rules: tuple[Untyped, ...], depth: int = 0) -> Iterator[Line]:
        for rule in rules:
            yield from self.rule(rule, depth)

    def rule(self, rule: Untyped, depth: int) -> Iterator[Line]:
        match rule:
            case For(variable, start, stop, body):
                yield self.line(rule, f"for {variable} from {self.expr(start)} to {self.expr(stop)}", depth)
                yield from self.lines(body, depth + 1)
            case When(condition, (Reject(text),), ()):
                yield self.line(rule, self.text(rule.span) or f'reject "{text}" when {_expr(condition)}', depth)
            case When(condition, then, otherwise):
                yield self.line(rule, f"when {self.expr(condition)}", depth)
                yield from self.lines(then, depth + 1)
                if otherwise:
                    yield Line("else", depth, None, self.block(rule.span), (), (), ())
                    yield from self.lines(otherwise, depth + 1)
            case SameNames():
                yield from (self.line(rule, _same_name(each), depth, [each]) for each in self.typed.get(span_of(rule.span), ()))
            case Assign(place, value, via=via):
                by = "" if via is None else f' via "{via.mapping}"'
                yield self.line(rule, self.text(rule.span) or f"{show_expr(place)} = {_expr(value)}{by}", depth)
            case SetLength(place, value):
                yield self.line(rule, self.text(rule.span) or f"len({show_expr(place)}) = {_expr(value)}", depth)
            case Ignore(place) | Default(place):
                yield self.line(rule, f"{'ignore' if isinstance(rule, Ignore) else 'default'} {show_expr(place)}", depth)
            case Reject(text):
                yield self.line(rule, self.text(rule.span) or f'reject "{text}"', depth)
            case _:
                yield self.line(rule, self.text(rule.span), depth)

    def line(self, rule: Untyped, text: str, depth: int, found: list[Rule] | None = None) -> Line:
        rules = self.typed.get(span_of(rule.span), []) if found is None else found
        heads = tuple(_head(each) for each in rules)
        origin: Side = "wire" if self.target == "holder" else "holder"
        number = None if rule.span is None else rule.span.source.line_column(rule.span.start)[0]
        sets, reads = _names(heads, self.target), _names(heads, origin)
        if not rules and isinstance(rule, Assign):  # the rules of another mapping stand for it, which are written there
            sets, reads = _members(rule.place), _members(rule.value)
        return Line(text, depth, number, self.block(rule.span), sets, reads, notes(rules))

    def block(self, span: Span | None) -> str:
        return "rules" if _within(span, self.written.rules) else f"{self.direction}-rules"

    def text(self, span: Span | None) -> str:
        """What the mapping says there; nothing where it says it of both directions."""
        text = "" if span is None else " ".join(span.source.text[span.start : span.end].split())
        return "" if "<->" in text and _within(span, self.written.rules) else text

    def expr(self, value: Expr) -> str:
        """An expression as it is written, or as it was derived."""
        return _expr(value) if value.span is None or _within(value.span, self.written.rules) else self.text(value.span)


def _expr(value: Expr) -> str:
    """An expression without brackets around the whole."""
    text = show_expr(as_written(value))
    return text[1:-1] if text.startswith("(") and _closes_last(text) else text


def _closes_last(text: str) -> bool:
    """Whether the first bracket is closed by the last character."""
    depth = 0
    for number, char in enumerate(text):
        depth += (char == "(") - (char == ")")
        if depth == 0:
            return number == len(text) - 1
    return False


def _within(span: Span | None, rules: tuple[Untyped, ...] | None) -> bool:
    if span is None or not rules or rules[0].span is None or rules[-1].span is None:
        return False
    return rules[0].span.start <= span.start < rules[-1].span.end


def _head(rule: Rule) -> object:
    """The part of a rule that is not in its blocks, unless that is all there is to it."""
    match rule:
        case typed.For(_, start, stop):
            return (start, stop)
        case typed.When(condition) if not all(span_of(each.span) == span_of(rule.span) for each in (*rule.then, *rule.otherwise)):
            return condition
        case _:
            return rule


def _names(roots: tuple[object, ...], side: Side) -> tuple[Names, ...]:
    return tuple(dict.fromkeys(names_of(place) for place in places(roots, side)))


def _members(path: Expr) -> tuple[Names, ...]:
    """The fields that a path names."""
    return (tuple(step.name for step in path.steps if isinstance(step, Member)),) if isinstance(path, Path) else ()


def _same_name(rule: Rule) -> str:
    found = next(iter(_names((rule,), "holder")), ())
    path = "".join(f".{name}" for name in found)
    return f"{path} = {path}"
