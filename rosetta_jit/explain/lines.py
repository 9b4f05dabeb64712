"""The rules of one direction as lines of text, each with where it came from, what it links, and what it does to values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import PurePath

from rosetta_jit.explain.notes import Note, notes
from rosetta_jit.explain.walk import Key, by_span, names_of, places, span_of
from rosetta_jit.language import typed
from rosetta_jit.language.places import shown_fields
from rosetta_jit.language.typed import Place, Rule
from rosetta_jit.language.uses import Use
from rosetta_jit.model.expr import Expr, Index, Literal, Member, Path, Side
from rosetta_jit.model.mapping import (
    Arranged,
    Assign,
    Assignment,
    Default,
    For,
    Ignore,
    Mapping,
    Reject,
    SameNames,
    SetLength,
    SetState,
    Via,
    Way,
    When,
)
from rosetta_jit.model.mapping import Rule as Untyped
from rosetta_jit.model.printer import show_expr
from rosetta_jit.model.walk import every_rule
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace

Names = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Line:
    """A rule, or the head of a block of rules.

    ``block`` is where it is written: ``rules`` has been turned into this direction; ``file`` is the mapping where that is another one.
    ``sets`` and ``reads`` are fields, without indices.
    """

    text: str
    depth: int
    line: int | None
    block: str
    sets: tuple[Names, ...]
    reads: tuple[Names, ...]
    notes: tuple[Note, ...]
    file: str = ""


@dataclass(frozen=True, slots=True)
class Lines:
    """Makes lines of one direction; ``written`` is the mapping as its text says, before anything was derived.

    ``uses`` are those of other mappings, whose rules stand below the rule that uses them. Within one, ``inside`` is what it is used
    for, and ``around`` are the files of the mappings around: a mapping is not opened again within itself.
    """

    written: Mapping
    direction: str
    target: Side
    typed: dict[Key, list[Rule]]
    uses: dict[Key, list[Use]]
    inside: Use | None = None
    around: tuple[str, ...] = ()

    @classmethod
    def of(cls, written: Mapping, direction: str, rules: tuple[Rule, ...], uses: tuple[Use, ...] = ()) -> Lines:
        target: Side = "holder" if direction == "unpack" else "wire"
        used: dict[Key, list[Use]] = {}
        for use in uses:
            if use.place.side == target:
                used.setdefault(span_of(use.span), []).append(use)
        return cls(written, direction, target, by_span(rules), used, around=(written.source.name,))

    def lines(self, rules: tuple[Untyped, ...], depth: int = 0) -> Iterator[Line]:
        several = Counter(span_of(rule.span) for rule in rules)
        for rule in rules:
            yield from self.rule(rule, depth, is_whole=several[span_of(rule.span)] == 1)

    def of_used(self, rule: Untyped, depth: int) -> Iterator[Line]:
        """The rules of the mapping by which a rule is made, below it."""
        for use in self.used(rule)[:1]:
            yield from self.opened(use, depth)

    def used(self, rule: Untyped) -> list[Use]:
        """The uses that a rule makes here, one for each place."""
        found = [use for use in self.uses.get(span_of(rule.span), ()) if self.is_inside(use.place)]
        return list({names_of(use.place): use for use in reversed(found)}.values())[::-1]

    def opened(self, use: Use, depth: int) -> Iterator[Line]:
        name = use.mapping.source.name
        if name in self.around:
            return
        unpacks = use.side == "holder"
        inner = replace(self, written=use.mapping, direction="unpack" if unpacks else "pack", inside=use, around=(*self.around, name))
        yield from inner.lines((use.mapping.unpack_rules if unpacks else use.mapping.pack_rules) or (), depth + 1)

    def is_inside(self, place: Place) -> bool:
        """Whether a place is within that which the mapping is used for."""
        outer = () if self.inside is None else names_of(self.inside.place)
        return names_of(place)[: len(outer)] == outer

    def rule(self, rule: Untyped, depth: int, *, is_whole: bool = True) -> Iterator[Line]:
        """The lines of a rule, which ``is_whole`` unless it is one of several that a rule of the text becomes."""
        written = self.text(rule.span) if is_whole else ""
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
                used = self.used(rule)
                found = [each for each in self.typed.get(span_of(rule.span), ()) if not isinstance(each, typed.SetLength)]
                unused = [each for each in found if not any(_sets(each, use) for use in used)]
                yield from (self.line(rule, _same_name(each), depth, _leaves(each)) for each in unused)
                for use in used:
                    yield self.line(rule, _by_type(use), depth, [], use)
                    yield from self.opened(use, depth)
            case Assign(place, value, by=way):
                text = f"{show_expr(place)} = {_expr(value)}{_by(way)}"
                yield self.line(rule, written or text, depth)
                yield from self.of_used(rule, depth)
            case SetLength(place, value):
                yield self.line(rule, written or f"len({show_expr(place)}) = {_expr(value)}", depth)
            case SetState(variable, value):
                yield self.line(rule, self.text(rule.span) or f"state {variable} = {_expr(value)}", depth)
            case Ignore(place) | Default(place):
                yield self.line(rule, f"{'ignore' if isinstance(rule, Ignore) else 'default'} {show_expr(place)}", depth)
            case Reject(text):
                yield self.line(rule, self.text(rule.span) or f'reject "{text}"', depth)
            case Arranged(place, flag, ((key, value), *_)):
                text = f"{show_expr(place)} by {show_expr(flag)} = {{ {_expr(key)} = {_expr(value)} }}"
                yield self.line(rule, self.text(rule.span) or text, depth)
            case _:
                yield self.line(rule, self.text(rule.span), depth)

    def line(self, rule: Untyped, text: str, depth: int, found: list[Rule] | None = None, use: Use | None = None) -> Line:
        rules = _own(rule, [each for each in self.typed.get(span_of(rule.span), []) if self.is_here(each)]) if found is None else found
        heads = tuple(_head(each) for each in rules)
        origin: Side = "wire" if self.target == "holder" else "holder"
        number = None if rule.span is None else rule.span.source.line_column(rule.span.start)[0]
        sets, reads = _names(heads, self.target), _names(heads, origin)
        for each in [use] if use is not None else self.used(rule)[:1]:  # the rules of another mapping stand for it, which are below
            sets, reads = (names_of(each.place),), (names_of(each.origin),)
        file = "" if self.inside is None else PurePath(self.written.source.name).name
        return Line(text, depth, number, self.block(rule.span), sets, reads, notes(rules), file)

    def is_here(self, rule: Rule) -> bool:
        """Whether a typed rule was made for this use of its mapping."""
        if self.inside is None:
            return True
        found = places(rule, self.target)
        return any(map(self.is_inside, found)) if found else True

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
    text = show_expr(value)
    return text[1:-1] if text.startswith("(") and _closes_last(text) else text


def _by(way: Way | None) -> str:
    """By which mapping a value becomes another."""
    match way:
        case Via(name, depth):
            return f' via "{name}"' + ("" if depth is None else f" to depth {depth}")
        case _:
            return ""


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


def _own(rule: Untyped, found: list[Rule]) -> list[Rule]:
    """Of the typed rules that one text became, those that a rule made of it stands for: a relation may set several fields."""
    match rule:
        case Assign(Path(steps=steps)) | SetLength(Path(steps=steps)):
            wanted = tuple(step.name for step in steps if isinstance(step, Member))
            own = [each for each in found if _is_filter(each) or any(names_of(place)[-len(wanted) :] == wanted for place in _set_by(each))]
            own = [each for each in own if _is_item(rule, each)] or own
        case Reject():
            own = [each for each in found if not _set_by(each)]
        case _:
            own = found
    return own or found


def _is_item(rule: Assignment | SetLength[Path, Expr], found: Rule) -> bool:
    """Whether a typed rule sets the length, or the very element, that a rule does."""
    if isinstance(rule, SetLength) or not isinstance(found, typed.Assign):
        return isinstance(rule, SetLength) and isinstance(found, typed.SetLength)
    numbers = [step.index.value for step in rule.place.steps if isinstance(step, Index) and isinstance(step.index, Literal)]
    indices = [step.index for step in found.place.steps if isinstance(step, typed.IndexStep)]
    return numbers == [each.value for each in indices if isinstance(each, typed.Const)]


def _is_filter(rule: Rule) -> bool:
    """Whether a rule is a loop of which some rounds are kept: the rules in it may be those of another mapping."""
    return isinstance(rule, typed.For) and rule.kept is not None


def _set_by(rule: Rule) -> list[Place]:
    """The places that a rule sets, those of its blocks included."""
    return [each.place for each in every_rule((rule,)) if isinstance(each, typed.Assign | typed.SetLength)]


def _head(rule: Rule) -> object:
    """The part of a rule that is not in its blocks, unless that is all there is to it."""
    match rule:
        case typed.For(_, start, stop, kept=kept) if kept is None:
            return (start, stop)
        case typed.When(condition) if not all(span_of(each.span) == span_of(rule.span) for each in (*rule.then, *rule.otherwise)):
            return condition
        case _:
            return rule


def _names(roots: tuple[object, ...], side: Side) -> tuple[Names, ...]:
    return tuple(dict.fromkeys(names_of(place) for place in places(roots, side)))


def _sets(rule: Rule, use: Use) -> bool:
    """Whether a typed rule is one of those that a mapping is used for."""
    place = names_of(use.place)
    return any(names[: len(place)] == place for names in _names((rule,), use.place.side))


def _by_type(use: Use) -> str:
    """A field that `same names` maps by another mapping."""
    target, origin = (shown_fields(each.steps[-1:]) for each in (use.place, use.origin))
    return f"{target} = {origin}"


def _leaves(rule: Rule) -> list[Rule]:
    """The rules that set values, without loops around them."""
    return [leaf for each in rule.body for leaf in _leaves(each)] if isinstance(rule, typed.For) else [rule]


def _same_name(rule: Rule) -> str:
    found = next(iter(places((rule,), "holder")), None)
    path = "" if found is None else shown_fields(found.steps)
    return f"{path} = {path}"
