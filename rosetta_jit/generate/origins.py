"""Which line of a mapping a statement comes from: the rule that sets, or reads, the field of the holder that the statement does."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass

from rosetta_jit.kernel.ir import Site
from rosetta_jit.kernel.nodes import Binary, Const, Copy, Expr, Fill, Get, IsText, Nearest, Place, SetField, Stmt
from rosetta_jit.kernel.walk import expressions_of, subexpressions
from rosetta_jit.language import typed
from rosetta_jit.model import rules as rule_nodes
from rosetta_jit.model.layout import WIDTH, Layout, Number, Row, Slot, Span, Variant
from rosetta_jit.source import Span as Stretch
from rosetta_jit.startup.dataclass import dataclass

NODES = frozenset({typed.__name__, rule_nodes.__name__})
"""The modules of the nodes of typed mappings."""

MAX_DEPTH = 50
"""Expressions of rules nest no deeper in practice; what does is not looked into."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Bytes of a lane's rows that a rule names: of all rows, or of the one that stands at ``index`` of its array."""

    lane: int
    offset: int
    size: int
    index: int | None
    line: str


def origins_of(rules: Sequence[typed.Rule], layout: Layout) -> tuple[Origin, ...]:
    """Those of all rules of a mapping, in order."""
    found = (origin for rule in rules for origin in _of_rule(rule, layout))
    return tuple(dict.fromkeys(found))


def origin_of(stmt: Stmt, origins: Sequence[Origin]) -> str | None:
    """The line of the one rule that a statement comes from; None where several, or none, may have made it."""
    for place in _places(stmt):
        there = [each for each in origins if each.lane == place.lane and each.offset <= place.offset < each.offset + each.size]
        exact = [each for each in there if each.index == _index(place.row)]
        lines = {each.line for each in exact or [each for each in there if each.index is None]}
        if len(lines) == 1:
            return lines.pop()
    return None


def _places(stmt: Stmt) -> Iterator[Place]:
    """The places of the holder that a statement sets, then those that it reads."""
    match stmt:
        case SetField(place):
            yield place
        case Copy(Place() as target, _, _) | Fill(Place() as target, _, _):
            yield target
        case Copy(_, Place() as source, _):
            yield source
        case _:
            pass
    for expr in expressions_of(stmt):
        for part in subexpressions(expr):
            match part:
                case Get(_, place) | IsText(Place() as place, _) | Nearest(Place() as place, _, _):
                    yield place
                case _:
                    pass


def _index(row: Expr) -> int:
    """Of a row behind the first of its array."""
    match row:
        case Const(_, value):
            return int(value)
        case Binary("add", _, Const(_, value)):
            return int(value)
        case _:
            return 0


def _of_rule(rule: typed.Rule, layout: Layout) -> Iterator[Origin]:
    line = "" if rule.span is None else _line(rule.span)
    match rule:
        case typed.For(body=body):
            for each in body:
                yield from _of_rule(each, layout)
        case typed.When(then=then, otherwise=otherwise):
            for each in (*then, *otherwise):
                yield from _of_rule(each, layout)
        case typed.Assign() | typed.SetLength() if line:
            for place in _named(rule, 0):
                yield from _of_place(place, layout, line)
        case _:
            return


def _line(span: Stretch) -> str:
    """``torso_state.mapping:11: .angles[0] <-> float32(radians(.yaw))``"""
    number = span.source.line_column(span.start)[0]
    return f"{span.source.name.replace(chr(92), '/').rsplit('/', 1)[-1]}:{number}: {span.source.text.splitlines()[number - 1].strip()}"


def _named(node: object, depth: int) -> Iterator[typed.Place]:
    """The places of the holder that a rule or an expression names."""
    if isinstance(node, typed.Place):
        if node.side == "holder":
            yield node
    elif isinstance(node, tuple):
        for each in node:  # pyright: ignore[reportUnknownVariableType] - whatever fields of typed nodes hold
            yield from _named(each, depth + 1)  # pyright: ignore[reportUnknownArgumentType]
    elif is_dataclass(node) and not isinstance(node, type) and type(node).__module__ in NODES and depth < MAX_DEPTH:
        for each in fields(node):
            yield from _named(getattr(node, each.name), depth + 1)


def _of_place(place: typed.Place, layout: Layout, line: str) -> Iterator[Origin]:
    lane, slot, index = 0, layout.root, None
    for step in place.steps:
        if isinstance(slot, Span):
            lane, slot, index = slot.lane, layout.lanes[slot.lane].element, None
        match step:
            case typed.IndexStep(number):
                index = int(number.value) if isinstance(number, typed.Const) else None
            case typed.FieldStep(field):
                slot = _member(slot, field.name)
        if slot is None:
            return
    yield Origin(lane, slot.offset, _size(slot, layout.lanes[lane].stride), index, line)
    if isinstance(slot, Span):
        yield Origin(slot.lane, 0, layout.lanes[slot.lane].stride, None, line)


def _member(slot: Slot, name: str) -> Slot | None:
    match slot:
        case Row(members=members) | Variant(members=members):
            return members.named[name].slot if name in members.named else None
        case _:
            return None


def _size(slot: Slot, stride: int) -> int:
    match slot:
        case Number(_, scalar):
            return WIDTH[scalar]
        case Span():
            return 16
        case _:
            return stride - slot.offset


def described(site: Site) -> str:
    """What a site says, for a comment."""
    path = f" {site.path}" if site.path else ""
    line = f" ({site.line})" if site.line else ""
    return f"{site.kind}{path}: {site.detail}{line}"
